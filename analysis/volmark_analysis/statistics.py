"""Statistics of frame times, by the names of harness/README.md, section 6, and comparisons of paired orbits.

An interval resamples processes, then each process' orbits, with replacement; poses stay fixed. Means (of times,
or of logarithms for ratios) are linear in the resampling weights, so all resamples are one matrix product.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

POSES_FOR_LOW1 = 299
REPLICATES_FOR_INTERVAL = 5
RESAMPLES = 2000
CONFIDENCE = 0.95
POSE_BAND = (5.0, 95.0)
"""Percentiles over poses that are called the spread of a ratio."""


def statistics_of(ms: np.ndarray) -> dict[str, float]:
    """`ms`: frame times, at least one, all above 0."""
    times = np.asarray(ms, float)
    slowest_first = np.sort(times)[::-1]
    low1_count = -(-len(times) // 100)
    covered = np.cumsum(slowest_first)
    last = int(np.searchsorted(covered, 0.01 * times.sum()))
    median_ms, p99_ms = map(float, np.percentile(times, (50, 99)))
    return {
        "count": len(times),
        "mean_ms": float(times.mean()),
        "median_ms": median_ms,
        "p99_ms": p99_ms,
        "low1_avg_ms": float(slowest_first[:low1_count].mean()),
        "low1_integral_ms": float(slowest_first[min(last, len(times) - 1)]),
        "fps": float(1000.0 / times.mean()),
        "clock_mean_ms": float(1.0 / np.mean(1.0 / times)),
        "min_ms": float(times.min()),
        "max_ms": float(times.max()),
    }


def resampling_weights(orbits_of_processes: list[int], rng: np.random.Generator,
                       processes: np.ndarray | None = None) -> np.ndarray:
    """Weights of all orbits (columns, process by process) in each resample (rows); rows add up to 1.

    `processes`: resamples x processes, how often each process was drawn; drawn here if None."""
    count = len(orbits_of_processes)
    if processes is None:
        processes = draw_processes(count, rng)
    weights = []
    for process, orbits in enumerate(orbits_of_processes):
        times = processes[:, process]
        # A process drawn m times has its K orbits drawn m times K times.
        drawn = rng.multinomial(times * orbits, np.full(orbits, 1.0 / orbits))
        weights.append(drawn / (orbits * count))
    return np.concatenate(weights, axis=1)


def draw_processes(count: int, rng: np.random.Generator) -> np.ndarray:
    return rng.multinomial(count, np.full(count, 1.0 / count), size=RESAMPLES)


def interval_of(samples: np.ndarray) -> tuple[float, float]:
    tail = 50.0 * (1.0 - CONFIDENCE)
    low, high = np.percentile(samples, [tail, 100.0 - tail])
    return float(low), float(high)


def mean_interval(processes: list[list[np.ndarray]], seed: int = 1) -> tuple[float, float] | None:
    """Interval of the mean frame time. `processes`: per process, per orbit, its frame times. None under
    REPLICATES_FOR_INTERVAL processes."""
    if len(processes) < REPLICATES_FOR_INTERVAL:
        return None
    weights = resampling_weights([len(p) for p in processes], np.random.default_rng(seed))
    sums = np.array([orbit.sum() for process in processes for orbit in process])
    counts = np.array([len(orbit) for process in processes for orbit in process], float)
    return interval_of((weights @ sums) / (weights @ counts))


@dataclass
class Ratio:
    """Time of A over time of B. Below 1, A is faster."""

    median: float
    """Over poses, of exp(mean log time of A - mean log time of B); of the means if not paired."""
    pose_low: float | None
    pose_high: float | None
    interval: tuple[float, float] | None
    by_pose: np.ndarray | None
    processes: int
    paired: bool

    def inverse(self) -> "Ratio":
        def flip(value):
            return None if value is None else 1.0 / value
        interval = None if self.interval is None else (1.0 / self.interval[1], 1.0 / self.interval[0])
        return Ratio(1.0 / self.median, flip(self.pose_high), flip(self.pose_low), interval,
                     flip(self.by_pose), self.processes, self.paired)

    @property
    def clear(self) -> bool:
        """One side is faster beyond doubt: the interval (else the spread over poses) leaves out 1."""
        bounds = self.interval or (self.pose_low, self.pose_high)
        return None not in bounds and (bounds[1] < 1.0 or bounds[0] > 1.0)


def paired_ratio(a: list[np.ndarray], b: list[np.ndarray], same_processes: bool, seed: int = 1) -> Ratio:
    """Per-pose log-ratios. `a`, `b`: per process, orbits x poses, with equal poses. `same_processes`: process i
    of A ran interleaved with process i of B, so both are drawn together."""
    log_a, log_b = np.log(np.concatenate(a)), np.log(np.concatenate(b))
    by_pose = np.exp(_equal_weights(a) @ log_a - _equal_weights(b) @ log_b)
    low, high = np.percentile(by_pose, POSE_BAND)
    processes = min(len(a), len(b))
    interval = None
    if processes >= REPLICATES_FOR_INTERVAL:
        rng = np.random.default_rng(seed)
        drawn = draw_processes(len(a), rng) if same_processes else None
        logs = (resampling_weights([len(p) for p in a], rng, drawn) @ log_a
                - resampling_weights([len(p) for p in b], rng, drawn) @ log_b)
        interval = interval_of(np.exp(np.median(logs, axis=1)))
    return Ratio(float(np.median(by_pose)), float(low), float(high), interval, by_pose, processes, True)


def unpaired_ratio(mean_a: float, mean_b: float, processes: int) -> Ratio:
    """Of means, for orbits whose poses differ (timed pacing)."""
    return Ratio(mean_a / mean_b, None, None, None, None, processes, False)


def _equal_weights(processes: list[np.ndarray]) -> np.ndarray:
    return np.concatenate([np.full(len(p), 1.0 / (len(p) * len(processes))) for p in processes])
