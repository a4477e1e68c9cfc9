"""The columns that a result table can have: where a value comes from and how it is written."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, log10
from typing import Callable

from .points import PointResult, axes_of

DAGGER = "†"
ABSENT = "–"


@dataclass
class Column:
    name: str
    title: str
    value: Callable[[PointResult], object]
    """A number, text or None."""
    text: Callable[[PointResult, object], str]
    is_time: bool = False
    is_error: bool = False
    is_label: bool = False


def number_text(value: float, digits: int = 3) -> str:
    """Three significant digits, without exponent where a reader would not want one."""
    if value == 0:
        return "0"
    if not 1e-4 <= abs(value) < 1e7:
        return f"{value:.{digits - 1}e}"
    decimals = max(0, digits - 1 - floor(log10(abs(value))))
    return f"{value:.{decimals}f}"


def count_text(value: float) -> str:
    for limit, unit in ((1e9, " G"), (1e6, " M"), (1e4, " k")):
        if abs(value) >= limit:
            return number_text(value / (limit if unit != " k" else 1e3)) + unit
    return f"{value:.0f}" if value == int(value) else number_text(value)


def bytes_text(value: float) -> str:
    for limit, unit in ((1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB")):
        if value >= limit:
            return f"{number_text(value / limit)} {unit}"
    return f"{value:.0f} B"


def psnr_text(result: PointResult) -> str:
    errors = result.errors
    if "psnr_db" in errors:
        return f"{errors['psnr_db']:.1f}"
    return "identical" if errors.get("identical") else "not measured"


def error_text(result: PointResult) -> str:
    """The error that stands beside a time, with its unit."""
    text = psnr_text(result)
    return f"{text} dB" if "psnr_db" in result.errors else text


def _percent(share: float) -> str:
    return number_text(100 * share, 2)


def mean_text(result: PointResult) -> str:
    """The mean with its interval in square brackets, or else with the spread in round ones."""
    mean, bounds = result.statistics["mean_ms"], result.interval or result.spread
    if bounds is None:
        return number_text(mean)
    low, high = map(number_text, bounds)
    return f"{number_text(mean)} [{low}, {high}]" if result.interval else f"{number_text(mean)} ({low}{ABSENT}{high})"


def _number(_, value) -> str:
    return number_text(value)


def _statistic(name: str, title: str, is_time: bool = True) -> Column:
    return Column(name, title, lambda r: r.statistics.get(name), _number, is_time=is_time)


def _low1(name: str) -> Column:
    title = {"low1_avg_ms": "1 % low (avg), ms", "low1_integral_ms": "1 % low (integral), ms", "p99_ms": "p99, ms"}[name]
    return Column(name, title, lambda r: r.statistics.get(name),
                  lambda r, v: number_text(v) + (DAGGER if r.insufficient_frames else ""), is_time=True)


def _error(name: str, title: str, text=_number) -> Column:
    return Column(name, title, lambda r: r.errors.get(name), text, is_error=True)


def _missed_spurious(result: PointResult):
    missed, spurious = result.errors.get("missed_share"), result.errors.get("spurious_share")
    return None if missed is None or spurious is None else f"{_percent(missed)} / {_percent(spurious)}"


def _psnr_value(result: PointResult):
    if not result.completed:
        return None
    if result.errors.get("identical"):
        return float("inf")
    return result.errors.get("psnr_db", psnr_text(result))


def all_columns(results: list[PointResult]) -> dict[str, Column]:
    """Every column that can be asked for, in the order of the full CSV."""
    columns = [
        Column("status", "status", lambda r: r.status, lambda r, v: v.replace("_", " ")),
        Column("reason", "reason", lambda r: None if r.completed else r.reason, lambda r, v: v),
        Column("mean_ms", "frame time, ms", lambda r: r.statistics.get("mean_ms"), lambda r, v: mean_text(r), is_time=True),
        Column("psnr_db", "PSNR, dB", _psnr_value, lambda r, v: psnr_text(r), is_error=True),
        Column("mean_low_ms", "mean from, ms", lambda r: (r.interval or r.spread or (None,))[0], _number, is_time=True),
        Column("mean_high_ms", "mean to, ms", lambda r: (r.interval or r.spread or (None,))[-1], _number, is_time=True),
        Column("mean_bounds", "bounds are", bounds_kind, lambda r, v: v),
        _statistic("median_ms", "median, ms"), _low1("p99_ms"), _low1("low1_avg_ms"), _low1("low1_integral_ms"),
        Column("fps", "fps", lambda r: r.statistics.get("fps"), _number, is_time=True),
        _statistic("clock_mean_ms", "clock mean, ms"), _statistic("min_ms", "min, ms"), _statistic("max_ms", "max, ms"),
        _statistic("host_median_ms", "host median, ms"), _statistic("cpu_median_ms", "CPU median, ms"),
        _statistic("gpu_median_ms", "GPU median, ms"),
        _error("ssim", "SSIM"), _error("flip", "FLIP"), _error("mse", "MSE"),
        _error("depth_mean_voxels", "depth mean, voxels"),
        _error("depth_p995_voxels", "depth p99.5, voxels"), _error("depth_max_voxels", "depth max, voxels"),
        _error("missed_share", "missed, %", lambda r, v: _percent(v)),
        _error("spurious_share", "spurious, %", lambda r, v: _percent(v)),
        Column("missed_spurious", "missed / spurious, %", _missed_spurious, lambda r, v: v, is_error=True),
        Column("generation_ms", "generation, ms", lambda r: r.generation_ms, _number),
        Column("prepare_ms", "prepare, ms", lambda r: r.prepare_ms, _number),
        Column("memory_bytes", "memory", lambda r: r.memory_bytes, lambda r, v: bytes_text(v)),
        Column("stamps_ratio", "stamps ratio", lambda r: r.stamps_ratio, lambda r, v: f"{v:.3f}"),
        Column("frames", "frames", lambda r: r.statistics.get("count"), lambda r, v: str(v)),
        Column("poses", "poses", lambda r: r.poses or None, lambda r, v: str(v)),
        Column("replicates", "replicates", lambda r: len(r.completed) or None, lambda r, v: str(v)),
        Column("disturbed_frames", "disturbed", lambda r: r.disturbed_frames if r.completed else None, lambda r, v: str(v)),
        Column("insufficient_frames", "insufficient frames",
               lambda r: int(r.insufficient_frames) if r.completed else None, lambda r, v: "yes" if v else "no"),
    ]
    for prefix, title, part in (("counter.", "", "counters"), ("pass.", "pass {}, ms", "pass_ms")):
        for name in dict.fromkeys(n for r in results for n in getattr(r, part)):
            columns.append(Column(prefix + name, title.format(name) or name.replace("_", " "),
                                  lambda r, n=name, p=part: getattr(r, p).get(n),
                                  _number if part == "pass_ms" else lambda r, v: count_text(v), is_time=part == "pass_ms"))
    fixed = {column.name: column for column in columns}
    return {column.name: column for column in label_columns(results, fixed)} | fixed


def label_columns(results: list[PointResult], fixed=()) -> list[Column]:
    """One column per axis, named after it; "label.<axis>" where a fixed column has that name."""
    return [Column(f"label.{a}" if a in fixed else a, a, lambda r, a=a: r.labels.get(a), lambda r, v: v, is_label=True)
            for a in axes_of(results)]


def bounds_kind(result: PointResult):
    if result.interval:
        return "interval"
    if result.spread is None:
        return None
    return "spread of processes" if len(result.processes) > 1 else "spread of orbits"
