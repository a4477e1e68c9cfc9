"""The points of the paper's scenarios by what they stand for."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from ...errors import InputError
from ...load import Experiment, load_experiment
from ...points import PointResult, point_results
from ...search.candidates import latest
from . import published
from .evidence import Quantity

TECHNIQUES = {"dvr_raymarch": "none", "dvr_distance_map": "distance map", "dvr_boolean_octree": "boolean octree",
              "dvr_minmax_octree": "min-max octree", "dvr_bitfield_octree": published.BITFIELD}
BUILD_PASS = "build_structure"


@dataclass
class Measurements:
    """An experiment of one of the paper's scenarios; empty if its folder was not given."""

    experiment: Experiment | None = None
    results: list[PointResult] = field(default_factory=list)

    @cached_property
    def cells(self) -> dict[tuple[str, str, str], PointResult]:
        """Table 1: by dataset, configuration and method."""
        return {tuple(r.labels.get(k, "") for k in ("dataset", "configuration", "method")): r for r in self.results}

    def done(self, dataset: str, configuration: str, method: str) -> PointResult | None:
        result = self.cells.get((dataset, configuration, method))
        return result if result is not None and result.completed else None


def load_measurements(folder: Path | None, axes: tuple[str, ...]) -> Measurements:
    """`axes`: labels that the scenario's points have. Raises InputError."""
    if folder is None:
        return Measurements()
    experiment = load_experiment(folder)
    missing = [axis for axis in axes if axis not in experiment.axes]
    if missing:
        raise InputError(f"{folder}: points have no label {missing[0]!r} (found: {', '.join(experiment.axes)}); expected an "
                         f"experiment of configs/papers/bitfield_octree_2021")
    return Measurements(experiment, latest(point_results(experiment)))


def parameter_of(result: PointResult, name: str):
    """Of the technique; None for a point without a run."""
    run = result.any_run
    technique = run.config.get("technique") if run is not None else None
    parameters = technique.get("parameters") if isinstance(technique, dict) else None
    return parameters.get(name) if isinstance(parameters, dict) else None


def generation_of(measurements: Measurements, dataset: str, method: str) -> Quantity | None:
    """How long a structure takes to build: median, lowest and highest. What does not depend on the transfer function is built
    once a run; for the others, of every breakdown frame of the block "generation"."""
    rebuilt = measurements.done(dataset, published.GENERATION, method)
    values = _pass_times(rebuilt) if rebuilt is not None else []
    if not values:
        own = [measurements.done(dataset, c, method) for c in published.CONFIGURATIONS]
        values = [time for r in own if r is not None for run in r.completed for time in _once(run)]
    if not values:
        return None
    several = len(values) > 1
    return Quantity(float(np.median(values)), min(values) if several else None, max(values) if several else None,
                    "lowest and highest build")


def _pass_times(result: PointResult) -> list[float]:
    times = []
    for run in result.completed:
        column = run.columns.get(f"pass.{BUILD_PASS}")
        if column is not None:
            of_breakdown = column[run.columns["orbit_kind"] == "breakdown"]
            times += [float(t) for t in of_breakdown[~np.isnan(of_breakdown)] if t > 0]
    return times


def _once(run) -> list[float]:
    entries = [g for g in run.generation if g.get("name") == BUILD_PASS]
    times = [g["gpu_ms"] if g.get("gpu_ms") is not None else g.get("host_ms") for g in entries]
    return [float(t) for t in times if t is not None]
