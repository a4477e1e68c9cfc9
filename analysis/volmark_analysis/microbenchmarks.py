"""Google Benchmark JSON (volmark_bench --benchmark_out=F --benchmark_out_format=json): one file as a table, or a second
one beside the first with the ratio of their times."""

from __future__ import annotations

import json
import math
import statistics
from dataclasses import dataclass
from pathlib import Path

from .columns import number_text
from .errors import InputError

_MS_PER_UNIT = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}


@dataclass(frozen=True)
class Microbenchmark:
    """Repetitions of one benchmark: times of an iteration in ms, and rates per second (bytes, rays, megapixels...)."""

    name: str
    times_ms: tuple[float, ...]
    rates: dict[str, float]
    error: str = ""  # why it was skipped

    @property
    def median_ms(self) -> float:
        return statistics.median(self.times_ms)


def read_benchmarks(path: Path) -> dict[str, Microbenchmark]:
    """By name, in file order. Raises InputError."""
    try:
        entries = json.loads(path.read_text(encoding="utf-8"))["benchmarks"]
        names = dict.fromkeys(str(e.get("run_name", e["name"])) for e in entries)
        return {name: _benchmark(name, [e for e in entries if e.get("run_name", e["name"]) == name]) for name in names}
    except OSError as error:
        raise InputError(f"{path}: can't be read ({error.strerror})") from None
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{path}: not the JSON of Google Benchmark ({type(error).__name__}: {error})") from None


def _benchmark(name: str, entries: list[dict]) -> Microbenchmark:
    failed = [str(e.get("error_message", "failed")) for e in entries if e.get("error_occurred")]
    if failed:
        return Microbenchmark(name, (), {}, failed[0])
    measured = [e for e in entries if e.get("run_type", "iteration") == "iteration"]
    # Benchmarks that ask for it are judged by wall-clock time, and say so in their name.
    key = "real_time" if "/real_time" in name else "cpu_time"
    times = tuple(float(e[key]) * _MS_PER_UNIT[e["time_unit"]] for e in measured)
    if not times or not all(math.isfinite(t) and t >= 0 for t in times):
        raise ValueError(f"{name} has no times")
    rates = {}
    for rate in [k for k in measured[0] if k.endswith("_per_second")]:
        rates[rate.removesuffix("_per_second")] = statistics.median(float(e[rate]) for e in measured)
    return Microbenchmark(name, times, rates)


def _rate_text(rates: dict[str, float]) -> str:
    return ", ".join(f"{number_text(v / 1e9)} GB/s" if k == "bytes" else f"{number_text(v)} {k}/s"
                     for k, v in rates.items())


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


def to_markdown(new: dict[str, Microbenchmark], old: dict[str, Microbenchmark] | None = None) -> str:
    """Median time with the smallest and largest repetition; with `old`, the ratio of the medians, new / old."""
    titles = ["benchmark", "ms", "smallest to largest", "rate"] + (["new / old"] if old is not None else [])
    lines = [f"| {' | '.join(titles)} |", f"|{'|'.join(['---'] + ['---:'] * (len(titles) - 1))}|"]
    for name, b in new.items():
        if b.error:
            cells = [name, "skipped", "", b.error]
        else:
            span = f"{number_text(min(b.times_ms))} to {number_text(max(b.times_ms))}" if len(b.times_ms) > 1 else ""
            cells = [name, number_text(b.median_ms), span, _rate_text(b.rates)]
        if old is not None:
            before = old.get(name)
            comparable = before and not before.error and not b.error and before.median_ms > 0
            cells.append(f"{b.median_ms / before.median_ms:.3f}" if comparable else "")
        lines.append(f"| {' | '.join(map(_cell, cells))} |")
    return "\n".join(lines) + "\n"
