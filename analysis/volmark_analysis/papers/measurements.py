"""An experiment of one of a paper's scenarios, and its points by their labels."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from ..columns import error_text
from ..errors import InputError
from ..load import Experiment, load_experiment
from ..points import PointResult, point_results
from ..search.candidates import latest
from ..search.objective import measured
from ..tables import failure_text
from .evidence import NOT_MEASURED


@dataclass
class Measurements:
    """Empty if its folder was not given."""

    experiment: Experiment | None = None
    results: list[PointResult] = field(default_factory=list)

    def find(self, **labels: str) -> PointResult | None:
        return next((r for r in self.results if _has(r, labels)), None)

    def done(self, **labels: str) -> PointResult | None:
        result = self.find(**labels)
        return result if result is not None and result.completed else None

    def all_done(self, **labels: str) -> list[PointResult]:
        return [r for r in self.results if r.completed and _has(r, labels)]


def _has(result: PointResult, labels: dict[str, str]) -> bool:
    return all(result.labels.get(axis) == value for axis, value in labels.items())


def measurements_of(experiment: Experiment, axes: tuple[str, ...], scenarios: str) -> Measurements:
    """`axes`: labels that the scenario's points have; `scenarios`: the folder with such scenarios. Raises InputError."""
    missing = [axis for axis in axes if axis not in experiment.axes]
    if missing:
        raise InputError(f"{experiment.folder}: points have no label {missing[0]!r} (found: {', '.join(experiment.axes)}); expected an "
                         f"experiment of {scenarios}")
    return Measurements(experiment, latest(point_results(experiment)))


def load_measurements(folder: Path | None, axes: tuple[str, ...], scenarios: str) -> Measurements:
    """Empty without a folder. Raises InputError."""
    return Measurements() if folder is None else measurements_of(load_experiment(folder), axes, scenarios)


def why_absent(result: PointResult | None) -> str:
    """Empty for a point that completed."""
    if result is None or result.any_run is None:
        return NOT_MEASURED
    return "" if result.completed else failure_text(result)


def time_text(result: PointResult) -> str:
    """Mean time and error of the picture, of a point that completed."""
    return f"{measured(result, 'mean_ms').text}, {error_text(result)}"
