"""One result per point, device and build: the replicates of a point taken together."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from .load import Experiment, Run
from .statistics import POSES_FOR_LOW1, Ratio, mean_interval, paired_ratio, statistics_of, unpaired_ratio

# Errors of a point are those of its worst captured picture.
_WORST = {"psnr_db": min, "ssim": min, "flip": max, "depth_mean_voxels": max,
          "depth_p995_voxels": max, "depth_max_voxels": max, "missed_share": max, "spurious_share": max, "mse": max}


@dataclass
class PointResult:
    labels: dict[str, str]
    """Of all axes, then of "device", "build" and "point" where they distinguish results."""
    point_index: int
    group: str
    completed: list[Run] = field(default_factory=list)
    others: list[Run] = field(default_factory=list)

    @property
    def any_run(self) -> Run | None:
        return (self.completed or self.others or [None])[0]

    @property
    def status(self) -> str:
        if self.completed:
            return "completed"
        return self.others[0].status if self.others else "not_run"

    @property
    def reason(self) -> str:
        """Why there is no result, in one line."""
        if not self.others:
            return "no finished run"
        reason = " ".join(self.others[0].reason.split())
        return reason or "no reason given"

    @property
    def technique(self) -> str:
        run = self.any_run
        if run is not None:
            name = run.technique.get("name") or _dig(run.config, "technique", "name")
            if name:
                return str(name)
        return self.labels.get("technique", "unknown")

    @property
    def scene(self) -> str:
        run = self.any_run
        name = _dig(run.config, "scene") if run is not None else None
        return str(name) if isinstance(name, str) else self.labels.get("scene", "")

    @cached_property
    def _orbits(self) -> list[list[tuple[np.ndarray, np.ndarray]]]:
        """Per completed replicate, per headline orbit, its frames' phases and times."""
        return [_by_orbit(run) for run in self.completed]

    @property
    def processes(self) -> list[list[np.ndarray]]:
        """Per completed replicate, per headline orbit, its frame times."""
        return [[times for _, times in orbits] for orbits in self._orbits]

    @cached_property
    def statistics(self) -> dict[str, float]:
        """Of the headline frames of all completed replicates."""
        if not self.completed:
            return {}
        statistics = statistics_of(np.concatenate([orbit for process in self.processes for orbit in process]))
        for column, name in (("host_ms", "host_median_ms"), ("cpu_ms", "cpu_median_ms"), ("gpu_ms", "gpu_median_ms")):
            values = np.concatenate([run.headline_values(column) for run in self.completed])
            values = values[~np.isnan(values)]
            if len(values):
                statistics[name] = float(np.median(values))
        return statistics

    @cached_property
    def interval(self) -> tuple[float, float] | None:
        """Of mean_ms; None with too few replicates."""
        return mean_interval(self.processes)

    @cached_property
    def spread(self) -> tuple[float, float] | None:
        """Lowest and highest mean_ms of the processes, or of the orbits of a single process."""
        if len(self.processes) > 1:
            means = [np.concatenate(process).mean() for process in self.processes]
        else:
            means = [orbit.mean() for process in self.processes for orbit in process]
        return (float(min(means)), float(max(means))) if len(means) > 1 else None

    @cached_property
    def poses(self) -> int:
        return max((len(np.unique(run.headline_values("phase"))) for run in self.completed), default=0)

    @property
    def frames_per_orbit(self) -> int:
        return max((len(orbit) for process in self.processes for orbit in process), default=0)

    @property
    def orbits(self) -> int:
        return max((len(process) for process in self.processes), default=0)

    @property
    def insufficient_frames(self) -> bool:
        return bool(self.completed) and self.poses < POSES_FOR_LOW1

    @property
    def disturbed_frames(self) -> int:
        return sum(cause not in ("", "0") for run in self.completed for cause in run.headline_values("disturbed"))

    @property
    def stamps_ratio(self) -> float | None:
        """Largest of the replicates."""
        return _extreme(max, (run.statistics.get("stamps_ratio") for run in self.completed))

    @cached_property
    def errors(self) -> dict[str, float | bool]:
        """Worst of all captured pictures of all replicates; `identical` if all are. Empty without a reference."""
        pictures = [p for run in self.completed for p in run.pictures if p.get("mse") is not None]
        if not pictures:
            return {}
        errors = {name: _extreme(worst, (p.get(name) for p in pictures)) for name, worst in _WORST.items()}
        errors = {name: value for name, value in errors.items() if value is not None}
        errors["identical"] = all(p.get("identical") for p in pictures)
        return errors

    @cached_property
    def counters(self) -> dict[str, float]:
        """Mean over counted frames, averaged over replicates."""
        names = dict.fromkeys(name for run in self.completed for name in run.counters)
        return {name: float(np.mean([r.counters[name] for r in self.completed if name in r.counters])) for name in names}

    @property
    def generation_ms(self) -> float | None:
        """Median over replicates of the sum of the generation passes, host time."""
        sums = [sum(g.get("host_ms") or 0.0 for g in run.generation) for run in self.completed if run.generation]
        return float(np.median(sums)) if sums else None

    @property
    def prepare_ms(self) -> float | None:
        values = [run.prepare_ms for run in self.completed if run.prepare_ms is not None]
        return float(np.median(values)) if values else None

    @property
    def memory_bytes(self) -> float | None:
        return _extreme(max, (run.memory.get("total_bytes") for run in self.completed))

    @cached_property
    def pass_ms(self) -> dict[str, float]:
        """Mean time of each pass, from the breakdown orbits."""
        times: dict[str, list[np.ndarray]] = {}
        for run in self.completed:
            breakdown = run.columns["orbit_kind"] == "breakdown"
            for column, values in run.columns.items() if breakdown.any() else ():
                if column.startswith("pass."):
                    times.setdefault(column[len("pass."):], []).append(values[breakdown])
        frames = max((sum(map(len, parts)) for parts in times.values()), default=0)
        # A pass that a frame does not have took no time in it.
        return {name: float(np.nansum(np.concatenate(parts)) / frames) for name, parts in times.items()
                if not all(np.isnan(part).all() for part in parts)}

    @property
    def failed_checks(self) -> list[dict]:
        checks = {}
        for run in self.completed + self.others:
            for check in run.checks:
                if check.get("passed") is False:
                    checks.setdefault(check.get("name", "unnamed"), check)
        return list(checks.values())

    @property
    def history(self) -> str:
        run = self.any_run
        return str(run.technique.get("history", "")) if run else ""

    @cached_property
    def orbit_matrices(self) -> list[np.ndarray] | None:
        """Per process: orbits x poses. None if poses differ between orbits (timed pacing)."""
        matrices = []
        for orbits in self._orbits:
            if not all(_same_poses(phases, self.phases) for phases, _ in orbits):
                return None
            matrices.append(np.array([times for _, times in orbits]))
        return matrices

    @property
    def phases(self) -> np.ndarray:
        """Of the first orbit's frames."""
        return self._orbits[0][0][0]


def _same_poses(a: np.ndarray, b: np.ndarray) -> bool:
    return len(a) == len(b) and float(np.abs(a - b).max()) <= 1e-6


def _by_orbit(run: Run) -> list[tuple[np.ndarray, np.ndarray]]:
    """Phases and times of each headline orbit's frames, in order."""
    orbits, frames, phases, times = map(run.headline_values, ("orbit", "frame", "phase", "frame_ms"))
    order = np.lexsort((frames, orbits))
    starts = np.flatnonzero(np.diff(orbits[order])) + 1
    return list(zip(np.split(phases[order], starts), np.split(times[order], starts)))


def ratio_of(a: PointResult, b: PointResult) -> Ratio:
    """Time of `a` over time of `b`; both must have completed. Paired by pose where both have the same poses."""
    times_a, times_b = a.orbit_matrices, b.orbit_matrices
    if times_a and times_b and _same_poses(a.phases, b.phases):
        same = [r.replicate for r in a.completed] == [r.replicate for r in b.completed]
        return paired_ratio(times_a, times_b, same_processes=same)
    return unpaired_ratio(a.statistics["mean_ms"], b.statistics["mean_ms"], min(len(a.completed), len(b.completed)))


def device_of(run: Run) -> tuple[str, str]:
    """Name of the device and of its driver, with version; empty where unknown."""
    device = run.provenance.get("device")
    device = device if isinstance(device, dict) else {}
    if device.get("identity") == "host" or (not device and run.technique.get("needs_gpu") is False):
        return f"host CPU{_in_brackets(_dig(run.provenance, 'host', 'cpu'))}", ""
    driver = " ".join(str(device[k]) for k in ("driver_name", "driver_info") if device.get(k))
    return str(device.get("name") or device.get("identity") or ""), driver


def build_of(run: Run) -> str:
    """What tells two builds apart: the digests of program and technique module, shortened."""
    digests = _dig(run.provenance, "program", "digest"), run.technique.get("module_digest")
    return "+".join(d[:6] for d in digests if isinstance(d, str) and d)


def point_results(experiment: Experiment) -> list[PointResult]:
    """In the order of the scenario's points; points without a run come as `not_run`."""
    groups: dict[tuple, list[Run]] = {}
    # Runs that ended before they knew their device or build come last and join their point's other runs.
    for run in sorted(experiment.current_runs, key=lambda r: not r.completed):
        key = (run.point_index, run.point, device_of(run), build_of(run))
        if not run.completed and key not in groups and (key[2] == ("", "") or not key[3]):
            key = next((k for k in groups if k[:2] == key[:2]), key)
        groups.setdefault(key, []).append(run)
    results = []
    for (index, *_), runs in sorted(groups.items(), key=lambda item: item[0][0]):
        results.append(PointResult(dict(runs[0].labels), index, runs[0].group,
                                   [r for r in runs if r.completed], [r for r in runs if not r.completed]))
    seen = {result.point_index for result in results}
    results += [PointResult(dict(p.labels), p.index, p.group) for p in experiment.points if p.index not in seen]
    results.sort(key=lambda r: r.point_index)
    _add_distinguishing_labels(results)
    return results


def _add_distinguishing_labels(results: list[PointResult]) -> None:
    """Rows of several devices, builds or configurations of one point get a label that tells them apart."""
    def distinguish(name, value_of):
        with_runs = [r for r in results if r.any_run is not None]
        by_label: dict[tuple, set[str]] = {}
        for r in with_runs:
            by_label.setdefault(tuple(r.labels.items()), set()).add(value_of(r.any_run))
        if any(len(values) > 1 for values in by_label.values()):
            for r in with_runs:
                r.labels[name] = value_of(r.any_run)

    distinguish("device", lambda run: device_of(run)[0] or "unknown")
    distinguish("driver", lambda run: device_of(run)[1] or "unknown")
    distinguish("build", lambda run: build_of(run) or "unknown")
    distinguish("point", lambda run: run.point[:8])


def axes_of(results: list[PointResult]) -> list[str]:
    """Names of all labels, in order."""
    return list(dict.fromkeys(axis for result in results for axis in result.labels))


def varying_axes(results: list[PointResult]) -> list[str]:
    """Axes on which these results differ."""
    return [axis for axis in axes_of(results) if len({r.labels.get(axis, "") for r in results}) > 1]


def groups_of(results: list[PointResult]) -> list[list[PointResult]]:
    """Results that may be compared: they differ only in technique, on one device and build."""
    groups: dict[tuple, list[PointResult]] = {}
    for r in results:
        key = (r.group, *(r.labels.get(k, "") for k in ("device", "driver", "build")))
        groups.setdefault(key, []).append(r)
    return list(groups.values())


def label_text(result: PointResult, axes: list[str]) -> str:
    """Short name of a result: its technique, then the given axes."""
    parts = [result.technique]
    parts += [f"{axis} {result.labels[axis]}" for axis in axes if axis != "technique" and result.labels.get(axis)]
    return ", ".join(parts)


def common_text(results: list[PointResult], axes: list[str]) -> str:
    """What these results share that is worth a title: their scene and those of the axes on which they agree."""
    parts = [results[0].scene] if len({r.scene for r in results}) == 1 and results[0].scene else []
    for axis in axes:
        values = {r.labels.get(axis, "") for r in results}
        if axis not in ("technique", "scene") and len(values) == 1 and results[0].labels.get(axis):
            parts.append(f"{axis} {results[0].labels[axis]}")
    return ", ".join(parts)


def _dig(value, *keys):
    for key in keys:
        if not isinstance(value, dict):
            return None
        value = value.get(key)
    return value


def _in_brackets(text) -> str:
    return f" ({text})" if text else ""


def _extreme(pick, values):
    values = [v for v in values if v is not None]
    return pick(values) if values else None
