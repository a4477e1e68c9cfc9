"""Points seen otherwise than by their frame times: by draw times, or in a part of the timeline. What is returned is a
PointResult again, so that its statistics, intervals and ratios are those of all other points."""

from __future__ import annotations

from dataclasses import replace
from typing import Callable

import numpy as np

from ..errors import InputError
from ..load import Run
from ..points import PointResult

Columns = dict[str, np.ndarray]


def by_draw_time(result: PointResult) -> PointResult:
    """draw_ms in place of frame_ms. Raises InputError if a frame has none."""
    return _seen(result, _with_draw_time)


def _with_draw_time(run: Run) -> Columns:
    draw = run.columns["draw_ms"]
    if not (draw[run.columns["orbit_kind"] == "headline"] > 0).all():
        raise InputError(f"{run.folder / 'frames.csv'}: column draw_ms: a headline frame has no time above 0")
    return run.columns | {"frame_ms": draw}


def between_phases(result: PointResult, low: float, high: float) -> PointResult | None:
    """Frames from phase `low` on and before `high`. None if a process has none."""
    seen = _seen(result, lambda run: _part(run.columns, low, high))
    return seen if all(len(run.headline_values("phase")) for run in seen.completed) else None


def _part(columns: Columns, low: float, high: float) -> Columns:
    kept = (columns["phase"] >= low) & (columns["phase"] < high)
    return {name: values[kept] for name, values in columns.items()}


def _seen(result: PointResult, columns_of: Callable[[Run], Columns]) -> PointResult:
    return replace(result, completed=[_with_columns(run, columns_of(run)) for run in result.completed])


def _with_columns(run: Run, columns: Columns) -> Run:
    copy = replace(run)
    copy.columns = columns  # in place of those that would be read from frames.csv
    return copy
