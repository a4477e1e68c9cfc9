"""The experiments of the paper's scenarios, by figure, each in draw times and in frame times."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from ...errors import InputError
from ...load import load_experiment
from ...points import PointResult
from ..evidence import Quantity, time_ratio
from ..measurements import Measurements, measurements_of
from ..times import between_phases, by_draw_time
from . import published

SCENARIOS = "configs/papers/direct_rasterization"
STILL, ORBIT = "still", "orbit"
VIEWS = (STILL, ORBIT)
_BY_RESOLUTION = ("resolution", "method")
_FIGURE6 = {"CT head": "fig6a", "vertebra": "fig6b", "chameleon": "fig6c"}
AXES = {"fig1": ("dataset", "method"), **{name + view: _BY_RESOLUTION for name in _FIGURE6.values() for view in ("", "_orbit")},
        "fig7a": _BY_RESOLUTION, "fig7b": ("method",), "fig8": ("dataset", "views", "method")}
"""By figure, which is also the name of the scenario's file."""
_PREFIX = "direct_rasterization_"


@dataclass
class Source:
    """An experiment; empty if its folder was not given."""

    draw: Measurements = field(default_factory=Measurements)
    """In draw times, as the paper measures."""
    frame: Measurements = field(default_factory=Measurements)
    """In update and draw times."""


Sources = dict[str, Source]


def load_sources(folders: list[Path]) -> Sources:
    """By figure, all of AXES. An experiment's name tells what it is of. Raises InputError."""
    sources: Sources = {}
    for folder in folders:
        experiment = load_experiment(folder)
        figure = experiment.name.removeprefix(_PREFIX)
        if figure not in AXES:
            raise InputError(f"{folder}: found an experiment {experiment.name!r}, allowed: {_PREFIX}*, of the scenarios in {SCENARIOS}")
        if figure in sources:
            raise InputError(f"{folder}: a second experiment {experiment.name!r}, allowed: one of each")
        frame = measurements_of(experiment, AXES[figure], SCENARIOS)
        sources[figure] = Source(Measurements(experiment, [by_draw_time(r) for r in frame.results]), frame)
    return {figure: sources.get(figure, Source()) for figure in AXES}


def figure6_of(sources: Sources, dataset: str, view: str) -> Source:
    return sources[_FIGURE6[dataset] + ("_orbit" if view == ORBIT else "")]


# Points -------------------------------------------------------------------------------------------------------


def size_of(result: PointResult) -> tuple[int, int]:
    """Of a point with a run. Limits of a profile are in it, so that it may be less than the label says."""
    size = result.any_run.config.get("resolution")
    if not isinstance(size, list) or len(size) != 2:
        raise InputError(f"{result.any_run.folder / 'run.json'}: /config/resolution: found {size!r}, expected two numbers")
    return int(size[0]), int(size[1])


def size_text(size: tuple[int, int]) -> str:
    return f"{size[0]} × {size[1]}"


def megapixels(size: tuple[int, int]) -> float:
    return size[0] * size[1] / 1e6


def sizes_of(measurements: Measurements) -> dict[str, tuple[int, int]]:
    """By label of the axis `resolution`, the smallest first; of points with a run."""
    sizes = {r.labels["resolution"]: size_of(r) for r in measurements.results if r.any_run is not None}
    return dict(sorted(sizes.items(), key=lambda item: megapixels(item[1])))


def is_software(measurements: Measurements) -> bool:
    """Whether the device of all runs is a CPU."""
    devices = [run.provenance.get("device") for r in measurements.results for run in r.completed]
    return bool(devices) and all(isinstance(device, dict) and device.get("type") == "cpu" for device in devices)


# Ratios -------------------------------------------------------------------------------------------------------


def ratio(measurements: Measurements, a: dict[str, str], b: dict[str, str]) -> Quantity | None:
    """Time of the point with labels `a` over that of `b`; None if one is missing."""
    result_a, result_b = measurements.done(**a), measurements.done(**b)
    return None if result_a is None or result_b is None else time_ratio(result_a, result_b)


def ratio_of_methods(measurements: Measurements, a: str, b: str, **labels: str) -> Quantity | None:
    """The same of two methods that share `labels`."""
    return ratio(measurements, labels | {"method": a}, labels | {"method": b})


# Isovalues ----------------------------------------------------------------------------------------------------

LEVEL_WITHIN = 0.05
"""How far from published.LEVEL_AT "around" reaches."""


def sweep_of(measurements: Measurements) -> tuple[float, float]:
    """First and last isovalue of Figure 7 (b), normalised; the published ones if nothing was measured. Raises InputError."""
    if not measurements.results:
        return published.SWEEP
    run = next(r.any_run for r in measurements.results if r.any_run is not None)
    try:
        sweep = run.config["timeline"]["isovalue_sweep"]
        return float(sweep["from"]["normalized"]), float(sweep["to"]["normalized"])
    except (KeyError, TypeError, ValueError):
        raise InputError(f"{run.folder / 'run.json'}: /config/timeline/isovalue_sweep: no normalised isovalues; expected an experiment "
                         f"of {SCENARIOS}/fig7b.json") from None


def isovalue_parts(sweep: tuple[float, float]) -> list[tuple[float, float]]:
    """Before, around and behind published.LEVEL_AT."""
    low, high = published.LEVEL_AT - LEVEL_WITHIN, published.LEVEL_AT + LEVEL_WITHIN
    return [(sweep[0], low), (low, high), (high, sweep[1])]


def part_text(part: tuple[float, float]) -> str:
    return f"{part[0]:g} to {part[1]:g}"


def in_part(measurements: Measurements, number: int) -> Measurements:
    """Frames of one of the isovalue_parts(), by number, if there are any. One on the border is around LEVEL_AT."""
    sweep = sweep_of(measurements)
    # Isovalues of equal steps are a little off.
    borders = [part[0] for part in isovalue_parts(sweep)] + [sweep[1]]
    borders = [value + shift for value, shift in zip(borders, (-1e-6, -1e-6, 1e-6, 1e-6))]
    low, high = ((value - sweep[0]) / (sweep[1] - sweep[0]) for value in borders[number:number + 2])
    seen = [between_phases(r, low, high) if r.completed else r for r in measurements.results]
    return Measurements(measurements.experiment, [r for r in seen if r is not None])
