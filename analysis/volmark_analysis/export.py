"""Results in the formats of other tools. Names are those of google_benchmark.json: <experiment>/<axis>:<label>/..."""

from __future__ import annotations

import csv
import io
import json
from typing import Callable

from .columns import error_text, number_text
from .errors import InputError
from .load import Experiment, Run
from .points import PointResult, device_of


def latest_results(experiment: Experiment, results: list[PointResult]) -> dict[str, PointResult]:
    """Completed results by name; of a point measured on several builds or devices the one that was measured last, so
    that names do not depend on what else lies in the folder. Raises InputError if there is none."""
    latest: dict[str, PointResult] = {}
    for r in results:
        if not r.completed:
            continue
        axes = [a for a in experiment.axes if a in r.labels]
        name = "/".join([experiment.name] + [f"{axis}:{r.labels[axis]}" for axis in axes])
        if name not in latest or _started(r) > _started(latest[name]):
            latest[name] = r
    if not latest:
        raise InputError(f"{experiment.folder}: no run completed, nothing to export")
    return latest


def _started(r: PointResult) -> str:
    return max(str(run.provenance.get("started", "")) for run in r.completed)


def to_github_action_benchmark(experiment: Experiment, results: list[PointResult]) -> str:
    """`customSmallerIsBetter` of github-action-benchmark: per point mean_ms, and mse and flip where measured, so that a
    picture that got worse raises an alert as a slower one does."""
    entries = []
    for name, r in latest_results(experiment, results).items():
        device = ", driver ".join(part for part in device_of(r.completed[0]) if part)
        extra = f"{error_text(r)}\n{len(r.completed)} processes, {r.statistics['count']} frames\n{device}".rstrip()
        entry = {"name": f"{name} mean_ms", "unit": "ms", "value": r.statistics["mean_ms"], "extra": extra}
        bounds = r.interval or r.spread
        if bounds is not None:
            entry["range"] = f"± {number_text(0.5 * (bounds[1] - bounds[0]))}"
        entries.append(entry)
        entries += [{"name": f"{name} {error}", "unit": unit, "value": r.errors[error]}
                    for error, unit in (("mse", "MSE"), ("flip", "FLIP")) if error in r.errors]
    return _json_text(entries)


def to_bencher(experiment: Experiment, results: list[PointResult]) -> str:
    """Bencher Metric Format: the built-in measure `latency` is the mean frame time in nanoseconds with its interval (or
    spread); the others carry volmark's names and units."""
    document = {}
    for name, r in latest_results(experiment, results).items():
        latency = {"value": 1e6 * r.statistics["mean_ms"]}
        bounds = r.interval or r.spread
        if bounds is not None:
            latency |= {"lower_value": 1e6 * bounds[0], "upper_value": 1e6 * bounds[1]}
        measures = {"latency": latency, "low1-avg-ms": {"value": r.statistics["low1_avg_ms"]}}
        for error in ("mse", "psnr_db", "ssim", "flip"):
            if error in r.errors:
                measures[error.replace("_", "-")] = {"value": r.errors[error]}
        if r.memory_bytes is not None:
            measures["memory-bytes"] = {"value": r.memory_bytes}
        document[name] = measures
    return _json_text(document)


def to_presentmon(experiment: Experiment, results: list[PointResult]) -> str:
    """Headline frames with the column names of PresentMon 1 that mean something without a window. A frame without an
    interval (the first of an orbit) has no row, as PresentMon starts with the second present. The format has no place
    for an error: read it in the report."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    columns = ["Application", "TimeInSeconds", "msBetweenPresents", "msGPUActive"]
    latest = latest_results(experiment, results)
    if all(run.headline.gpu_ms.isna().all() for r in latest.values() for run in r.completed):
        columns.pop()
    writer.writerow(columns)
    for name, r in latest.items():
        for run in r.completed:
            application = name if len(r.completed) == 1 else f"{name} process {run.replicate}"
            writer.writerows(row[:len(columns)] for row in _present_rows(application, run))
    return out.getvalue()


def _present_rows(application: str, run: Run):
    frames = run.headline
    # Orbits follow each other without the time in which other techniques had their turn.
    seconds = (frames.interval_ms.fillna(frames.host_ms).cumsum() / 1000).to_numpy()
    for second, interval, gpu in zip(seconds, frames.interval_ms, frames.gpu_ms):
        if interval == interval:
            yield application, f"{second:.9f}", f"{interval:.6f}", "NA" if gpu != gpu else f"{gpu:.6f}"


def _json_text(value) -> str:
    return json.dumps(value, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


WRITERS: dict[str, Callable[[Experiment, list[PointResult]], str]] = {
    "github-action-benchmark": to_github_action_benchmark, "bencher": to_bencher, "presentmon": to_presentmon}
