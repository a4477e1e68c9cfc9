"""What a search compares: a time with its bounds, and the error of the pictures, which may have a limit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..columns import ABSENT, Column, number_text
from ..load import Run
from ..points import PointResult
from ..statistics import CONFIDENCE, REPLICATES_FOR_INTERVAL, interval_of, resampling_weights, statistics_of

# Times that can be searched for: column of frames.csv, and the statistic of a set of frames.
OBJECTIVES = {name: ("frame_ms", name) for name in ("median_ms", "mean_ms", "p99_ms", "low1_avg_ms")} | {
    "host_median_ms": ("host_ms", "median_ms"), "cpu_median_ms": ("cpu_ms", "median_ms"),
    "gpu_median_ms": ("gpu_ms", "median_ms")}
DEFAULT_OBJECTIVE = "median_ms"

HIGHER_IS_BETTER = {"psnr_db": True, "ssim": True, "flip": False, "depth_p995_voxels": False, "mse": False}
"""Errors of a point: each that of its worst captured picture."""


@dataclass(frozen=True)
class Measured:
    """A time of a point."""

    value: float
    low: float
    high: float
    is_interval: bool
    """Of confidence; else lowest and highest of the processes, or of the orbits of one."""

    def overlaps(self, other: "Measured") -> bool:
        return self.low <= other.high and other.low <= self.high

    @property
    def text(self) -> str:
        # An interval without width is one, too: of equal times, rounding alone decides whether it has any.
        if self.low == self.high and not self.is_interval:
            return number_text(self.value)
        low, high = number_text(self.low), number_text(self.high)
        return f"{number_text(self.value)} [{low}, {high}]" if self.is_interval else \
            f"{number_text(self.value)} ({low}{ABSENT}{high})"


def measured(result: PointResult, objective: str) -> Measured | None:
    """None if the point has no such time. The value is of all frames. An interval resamples processes and then their
    orbits, each with its own statistic, and is laid around the value in proportion."""
    column, statistic = OBJECTIVES[objective]
    value = result.statistics.get(objective)
    if value is None:
        return None
    processes = [_orbits_of(run, column) for run in result.completed]
    by_orbit = [[_statistic(times, statistic) for times in orbits] for orbits in processes]
    if len(processes) >= REPLICATES_FOR_INTERVAL:
        weights = resampling_weights([len(orbits) for orbits in by_orbit], np.random.default_rng(1))
        low, high = interval_of(weights @ np.concatenate(by_orbit))
        centre = np.mean([np.mean(orbits) for orbits in by_orbit])
        return Measured(value, float(value * low / centre), float(value * high / centre), True)
    units = by_orbit[0]
    if len(processes) > 1:
        units = [_statistic(np.concatenate(orbits), statistic) for orbits in processes]
    return Measured(value, min(units + [value]), max(units + [value]), False)


def _statistic(times: np.ndarray, name: str) -> float:
    # Of every orbit of a large grid: the usual one not at the cost of all.
    return float(np.median(times)) if name == "median_ms" else statistics_of(times)[name]


def _orbits_of(run: Run, column: str) -> list[np.ndarray]:
    orbits, values = run.headline_values("orbit"), run.headline_values(column)
    orbits, values = orbits[~np.isnan(values)], values[~np.isnan(values)]
    return [values[orbits == orbit] for orbit in np.unique(orbits)]


def time_columns(times: dict[int, Measured], objective: str) -> list[Column]:
    """`times`: by id of a result. The bounds are columns of their own, for CSV."""
    title = objective.removesuffix("_ms").replace("_", " ") + ", ms"
    return [Column(objective, title, lambda r: times[id(r)].value, lambda r, v: times[id(r)].text, is_time=True),
            Column("low_ms", "from, ms", lambda r: times[id(r)].low, lambda r, v: number_text(v), is_time=True),
            Column("high_ms", "to, ms", lambda r: times[id(r)].high, lambda r, v: number_text(v), is_time=True),
            Column("bounds", "bounds are", lambda r: "interval" if times[id(r)].is_interval else "spread", lambda r, v: v)]


def time_note(times: dict[int, Measured], objective: str) -> str:
    column, statistic = OBJECTIVES[objective]
    text = f"{objective}: {statistic.removesuffix('_ms')} of {column} over the headline frames of all processes"
    if any(t.is_interval for t in times.values()):
        text += f"; [ ] {100 * CONFIDENCE:.0f} % interval, processes and then orbits resampled"
    if any(not t.is_interval and t.low < t.high for t in times.values()):
        text += "; ( ) lowest and highest of the processes, or of the orbits of one process, not an interval"
    if any(t.low == t.high for t in times.values()):
        text += "; without brackets: measured in one orbit, so its uncertainty is unknown"
    return text + "."
