"""The points of the paper's scenarios by what they stand for."""

from __future__ import annotations

import numpy as np

from ...points import PointResult
from ..evidence import Quantity
from ..measurements import Measurements
from . import published

TECHNIQUES = {"dvr_raymarch": "none", "dvr_distance_map": "distance map", "dvr_boolean_octree": "boolean octree",
              "dvr_minmax_octree": "min-max octree", "dvr_bitfield_octree": published.BITFIELD}
BUILD_PASS = "build_structure"


def cell(measurements: Measurements, dataset: str, configuration: str, method: str) -> PointResult | None:
    """Of Table 1."""
    return measurements.find(dataset=dataset, configuration=configuration, method=method)


def done(measurements: Measurements, dataset: str, configuration: str, method: str) -> PointResult | None:
    """The same if it completed."""
    return measurements.done(dataset=dataset, configuration=configuration, method=method)


def parameter_of(result: PointResult, name: str):
    """Of the technique; None for a point without a run."""
    run = result.any_run
    technique = run.config.get("technique") if run is not None else None
    parameters = technique.get("parameters") if isinstance(technique, dict) else None
    return parameters.get(name) if isinstance(parameters, dict) else None


def generation_of(measurements: Measurements, dataset: str, method: str) -> Quantity | None:
    """How long a structure takes to build: median, lowest and highest. What does not depend on the transfer function is built
    once a run; for the others, of every breakdown frame of the block "generation"."""
    rebuilt = done(measurements, dataset, published.GENERATION, method)
    values = _pass_times(rebuilt) if rebuilt is not None else []
    if not values:
        own = [done(measurements, dataset, c, method) for c in published.CONFIGURATIONS]
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
