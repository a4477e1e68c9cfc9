"""The best point of each contest, and those that can't be told from it."""

from __future__ import annotations

from dataclasses import dataclass

from ..columns import Column, all_columns, label_columns
from ..load import Experiment
from ..points import PointResult, varying_axes
from ..tables import Table, caption_of
from .candidates import Contest, Limit
from .objective import Measured, time_columns, time_note


@dataclass
class Best:
    contest: Contest
    point: PointResult
    ties: list[PointResult]
    """Whose bounds overlap with the best's, fastest first."""


def best_of(contest: Contest) -> Best | None:
    """None if no point competes."""
    if not contest.points:
        return None
    ranked = sorted(contest.points, key=lambda r: contest.times[id(r)].value)
    first = contest.times[id(ranked[0])]
    return Best(contest, ranked[0], [r for r in ranked[1:] if contest.times[id(r)].overlaps(first)])


def best_table(experiment: Experiment, results: list[PointResult], contests: list[Contest], objective: str,
               limits: list[Limit], full: bool) -> Table:
    """A row for each best point, and below it a row for each tie. `full`: with the bounds in columns of their own."""
    found = [best for best in map(best_of, contests) if best is not None]
    ranks = {id(r): rank for best in found for rank, rs in (("best", [best.point]), ("tie", best.ties)) for r in rs}
    rows = [r for best in found for r in [best.point, *best.ties]]
    times = {key: time for contest in contests for key, time in contest.times.items()}
    caption = f"Best points by {objective}" + (f", {' and '.join(map(str, limits))}" if limits else "")
    return Table("best", search_columns(results, rows, contests, times, objective, ("rank", ranks), full), rows,
                 f"{caption}. {caption_of(experiment, rows)}", _notes(contests, rows, times, objective, limits))


def search_columns(results: list[PointResult], rows: list[PointResult], contests: list[Contest], times: dict[int, Measured],
                   objective: str, rank: tuple[str, dict[int, str]], full: bool) -> list[Column]:
    """What the contests are about, what tells the points apart, their rank, time and errors."""
    known = all_columns(results)
    axes = varying_axes(results)
    labels = [column for column in label_columns(results) if column.name in axes]
    where_of = {id(r): contest.where for contest in contests for r in contest.points}
    where = [Column(name, name, lambda r, n=name: where_of[id(r)].get(n), lambda r, v: v, is_label=True)
             for name in dict.fromkeys(name for r in rows for name in where_of[id(r)]) if name not in axes]
    name, ranks = rank
    errors = [known[e] for e in ("psnr_db", "ssim", "flip", "depth_p995_voxels")
              if e == "psnr_db" or any(known[e].value(r) is not None for r in rows)]
    time, *bounds = time_columns(times, objective)
    return (where + labels + [Column(name, name, lambda r: ranks[id(r)], lambda r, v: v), time] + (bounds if full else [])
            + errors + [known["replicates"]])


def _notes(contests: list[Contest], rows: list[PointResult], times: dict[int, Measured], objective: str,
           limits: list[Limit]) -> list[str]:
    shown = {id(r): times[id(r)] for r in rows}
    notes = [time_note(shown, objective)] if rows else []
    if len(rows) > len([contest for contest in contests if contest.points]):
        notes.append("tie: its bounds overlap with those of the best, so these measurements don't tell which is faster.")
    if not limits:
        notes.append("No error was limited: the fastest point may have the worst picture.")
    return notes + left_out_notes(contests)


def left_out_notes(contests: list[Contest]) -> list[str]:
    return [counts_of(contest) for contest in contests if contest.left_out]


def counts_of(contest: Contest) -> str:
    counts = [f"{count} {reason}" for reason, count in contest.left_out.items()]
    total = len(contest.points) + sum(contest.left_out.values())
    return f"{contest.title}: {len(contest.points)} of {total} points compete ({', '.join(counts)})."
