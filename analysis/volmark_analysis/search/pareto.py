"""Fronts of error against time: points that no other beats in both, and those of which these measurements can't tell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..columns import Column, all_columns
from ..load import Experiment
from ..points import PointResult, varying_axes
from ..tables import Table, caption_of
from .best import left_out_notes, search_columns
from .candidates import Contest, contests_of, error_of
from .objective import DEFAULT_OBJECTIVE, HIGHER_IS_BETTER, time_note

FRONT, UNDECIDED, DOMINATED = "front", "undecided", "dominated"
_LEAST_POINTS = 5
"""Of a scene, for a front in the report: fewer are compared in the table at a glance."""


@dataclass
class Front:
    contest: Contest
    error: str
    places: dict[int, str]
    """By id of a result: FRONT, UNDECIDED or DOMINATED."""

    def members(self, place: str) -> list[PointResult]:
        """Fastest first."""
        return sorted((r for r in self.contest.points if self.places[id(r)] == place),
                      key=lambda r: self.contest.times[id(r)].value)


def front_of(contest: Contest, error: str) -> Front:
    """The front is that of the values: time, and the worst captured picture. Any other point is dominated if one is faster
    beyond both bounds and no worse in any captured picture, over all processes; else it is undecided."""
    points = sorted(contest.points, key=lambda r: (contest.times[id(r)].value, -_goodness(r, error)))
    places, best = {}, -np.inf
    for r in points:
        if not places or _goodness(r, error) > best:
            best = _goodness(r, error)
            places[id(r)] = FRONT
    low = np.array([contest.times[id(r)].low for r in points])
    high = np.array([contest.times[id(r)].high for r in points])
    worst, best_pictures = _pictures(points, error)
    for i, r in enumerate(points):
        beaten = (high < low[i]) & (worst >= best_pictures[i]).all(axis=1)
        places.setdefault(id(r), DOMINATED if beaten.any() else UNDECIDED)
    return Front(contest, error, places)


def parameter_fronts(results: list[PointResult]) -> list[Front]:
    """What a report shows of a grid: the fronts of PSNR of each scene that has enough points; none where points differ in
    no parameter."""
    if not set(varying_axes(results)) - {"technique", "scene", "device", "driver", "build", "point"}:
        return []
    contests = contests_of(results, ["scene"], DEFAULT_OBJECTIVE, [], "psnr_db")
    return [front_of(contest, "psnr_db") for contest in contests if len(contest.points) >= _LEAST_POINTS]


def _goodness(r: PointResult, error: str) -> float:
    """More is better."""
    value = error_of(r, error)
    return value if HIGHER_IS_BETTER[error] else -value


def pictures_of(r: PointResult, error: str) -> dict[tuple[int, int], tuple[float, float]]:
    """By frame and view: worst and best over the processes, more is better."""
    found: dict[tuple[int, int], list[float]] = {}
    for run in r.completed:
        for picture in run.pictures:
            value = float("inf") if error == "psnr_db" and picture.get("identical") else picture.get(error)
            if value is not None:
                found.setdefault((picture["frame"], picture["view"]), []).append(value if HIGHER_IS_BETTER[error] else -value)
    return {key: (min(values), max(values)) for key, values in found.items()}


def _pictures(points: list[PointResult], error: str) -> tuple[np.ndarray, np.ndarray]:
    """Worst and best by point and picture; where points captured different frames, their worst ones alone."""
    pictures = [pictures_of(r, error) for r in points]
    if len({frozenset(p) for p in pictures}) > 1:
        worst = np.array([[_goodness(r, error)] for r in points])
        return worst, worst
    keys = list(pictures[0]) if pictures else []
    shape = len(points), len(keys)
    return (np.array([[p[k][0] for k in keys] for p in pictures]).reshape(shape),
            np.array([[p[k][1] for k in keys] for p in pictures]).reshape(shape))


def front_table(experiment: Experiment, results: list[PointResult], fronts: list[Front], objective: str,
                full: bool) -> Table:
    """The front and what may belong to it, fastest first; `full`: every point, with the bounds in columns of their own."""
    shown = (FRONT, UNDECIDED, DOMINATED) if full else (FRONT, UNDECIDED)
    rows = [r for front in fronts for r in sorted((r for place in shown for r in front.members(place)),
                                                  key=lambda r, f=front: f.contest.times[id(r)].value)]
    places = {key: place for front in fronts for key, place in front.places.items()}
    times = {key: time for front in fronts for key, time in front.contest.times.items()}
    contests = [front.contest for front in fronts]
    error = fronts[0].error if fronts else ""
    columns = search_columns(results, rows, contests, times, objective, ("place", places), full)
    if error not in [c.name for c in columns]:
        columns.insert(-1, all_columns(results)[error])
    return Table("pareto", columns, rows, f"Pareto front of {error} against {objective}. {caption_of(experiment, rows)}",
                 _notes(fronts, rows, times, objective))


def _notes(fronts: list[Front], rows: list[PointResult], times: dict, objective: str) -> list[str]:
    notes = [time_note({id(r): times[id(r)] for r in rows}, objective)] if rows else []
    notes.append("front: no point is both faster and better in its worst captured picture.")
    if any(UNDECIDED in front.places.values() for front in fronts):
        notes.append("undecided: neither on the front nor dominated by these measurements.")
    dominated = sum(len(front.members(DOMINATED)) for front in fronts)
    notes.append(f"{dominated} of {sum(len(front.contest.points) for front in fronts)} points are dominated: one is faster "
                 f"beyond the bounds of both and as good in every picture.")
    return notes + left_out_notes([front.contest for front in fronts])
