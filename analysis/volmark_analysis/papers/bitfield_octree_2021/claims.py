"""The paper's claims one by one: held, not held or not decidable, each with what was measured and what was published."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable

import numpy as np

from ...columns import number_text
from ...points import PointResult
from ...search.best import best_of
from ...search.candidates import contests_of
from ..claims import Case, Claim
from ..evidence import HELD, NOT_HELD, UNDECIDED, Quantity, above, at_least, at_most, most_of, quotient, time_ratio, within
from ..measurements import Measurements
from . import published
from .cells import TECHNIQUES, done, generation_of
from .work import work_of, work_ratio

_SUPPORTS = {published.BITFIELD: "cells", published.BITFIELD_VOXELS: "voxels"}
SAME_WITHIN = 1.02
"""Bitfield and min-max octree: 2 %."""


@dataclass
class Sources:
    table1: Measurements
    search: Measurements
    fig4: Measurements
    fig6: Measurements


def claims_of(sources: Sources) -> list[Claim]:
    table = sources.table1
    return [distance_map_is_fastest(table), *distance_map_generates_slower(table),
            *[claim for bitfield in _SUPPORTS for claim in _about_bitfield(table, bitfield)],
            minmax_loses_to_none(table), *[bitfield_loses_to_none(table, bitfield) for bitfield in _SUPPORTS],
            best_leaf(sources.fig4), best_leaf_of_search(sources.search), best_level(sources.fig6),
            best_level_of_search(sources.search), slowest_percentile(table)]


def _about_bitfield(table: Measurements, bitfield: str) -> list[Claim]:
    return [boolean_is_no_slower(table, bitfield), bitfield_is_no_slower_than_minmax(table, bitfield),
            bitfield_gains(table, bitfield, "lungs", "early exit"), bitfield_gains(table, bitfield, "head MRI", "marching only")]


# Ratios of two methods ----------------------------------------------------------------------------------------


def ratio_case(table: Measurements, dataset: str, configuration: str, a: str, b: str, judge: Callable[[Quantity], str]) -> Case:
    """Time of `a` over time of `b`."""
    paper = published.time_ratio(dataset, configuration, published.column_of(a), published.column_of(b))
    case = Case(f"{dataset}, {published.TITLES[configuration]}: {a} / {b}", number_text(paper))
    result_a, result_b = done(table, dataset, configuration, a), done(table, dataset, configuration, b)
    if result_a is None or result_b is None:
        return case
    ratio = time_ratio(result_a, result_b)
    case.measured, case.verdict = f"{ratio.text}{'' if ratio.low is not None else ', without bounds'}", judge(ratio)
    work = work_ratio(result_a, result_b)
    if work is not None:
        case.other, case.other_verdict = number_text(work, 4), judge(Quantity(work, work, work))
    return case


def _everywhere(table: Measurements, a: str, b: str, judge) -> list[Case]:
    return [ratio_case(table, d, c, a, b, judge) for d in published.DATASETS for c in published.CONFIGURATIONS]


def distance_map_is_fastest(table: Measurements) -> Claim:
    methods = [*published.OCTREES, published.BITFIELD_VOXELS]
    cases = [ratio_case(table, d, c, "distance map", m, lambda q: at_most(q, 1.0))
             for d in published.DATASETS for c in published.CONFIGURATIONS for m in methods]
    return Claim("The distance map draws fastest, in all configurations.", "4.4", cases)


def boolean_is_no_slower(table: Measurements, bitfield: str) -> Claim:
    return Claim(f"The Boolean octree is no slower than the bitfield octree ({_SUPPORTS[bitfield]}).", "4.4",
                 _everywhere(table, "boolean octree", bitfield, lambda q: at_most(q, 1.0)))


def bitfield_is_no_slower_than_minmax(table: Measurements, bitfield: str) -> Claim:
    return Claim(f"The bitfield octree ({_SUPPORTS[bitfield]}) is within 2 % of the min-max octree, or faster.", "4.4",
                 _everywhere(table, bitfield, "min-max octree", lambda q: at_most(q, SAME_WITHIN)))


def bitfield_gains(table: Measurements, bitfield: str, dataset: str, configuration: str) -> Claim:
    gain = published.time_ratio(dataset, configuration, "min-max octree", published.BITFIELD)
    case = ratio_case(table, dataset, configuration, "min-max octree", bitfield, lambda q: at_least(q, gain))
    return Claim(f"The bitfield octree ({_SUPPORTS[bitfield]}) is {gain:.2f} times as fast as the min-max octree on {dataset} "
                 f"({published.TITLES[configuration]}).", "4.4", [case],
                 note="Held: at least the published gain. A smaller gain is not held, though it may be one.")


def minmax_loses_to_none(table: Measurements) -> Claim:
    cells = [(d, c) for d in ("lungs", "head MRI") for c in published.CONFIGURATIONS
             if published.time_ratio(d, c, "min-max octree", "none") > 1]
    return Claim("The min-max octree is slower than no skipping on lungs and head MRI.", "table 1",
                 [ratio_case(table, d, c, "min-max octree", "none", lambda q: above(q, 1.0)) for d, c in cells],
                 note="The cells in which the published min-max octree is slower than None.")


def bitfield_loses_to_none(table: Measurements, bitfield: str) -> Claim:
    def judge(d, c):
        loses = published.time_ratio(d, c, published.BITFIELD, "none") > 1
        return (lambda q: above(q, 1.0)) if loses else (lambda q: at_most(q, 1.0))

    return Claim(f"The bitfield octree ({_SUPPORTS[bitfield]}) is slower than no skipping only on head MRI (Marching Only).", "table 1",
                 [ratio_case(table, d, c, bitfield, "none", judge(d, c)) for d in published.DATASETS for c in published.CONFIGURATIONS])


# Generation ---------------------------------------------------------------------------------------------------


def distance_map_generates_slower(table: Measurements) -> list[Claim]:
    low, high = published.GENERATION_RATIOS
    return [Claim(f"Generating the distance map takes {low:g} to {high:g} times as long as the {octree}.", "4.4",
                  [_generation_case(table, d, octree) for d in published.DATASETS], in_other=False) for octree in published.OCTREES]


def _generation_case(table: Measurements, dataset: str, octree: str) -> Case:
    known = published.TABLE1[dataset].generation_ms
    case = Case(f"{dataset}: generation of distance map / {octree}", number_text(known["distance map"] / known[octree]))
    a, b = generation_of(table, dataset, "distance map"), generation_of(table, dataset, octree)
    if a is None or b is None:
        return case
    ratio = quotient(a, b, "lowest over highest build, and the reverse")
    case.measured, case.verdict = ratio.text, within(ratio, *published.GENERATION_RATIOS)
    return case


# Best parameters ----------------------------------------------------------------------------------------------

# Section 4.3 names these two volumes.
_FIG4_LEAVES = {"aneurysm": "2", "kingsnake": "4"}


def best_leaf(fig4: Measurements) -> Claim:
    results = [r for r in fig4.results if r.labels.get("initial_level") == "0"]
    return Claim("Leaves of 4³ are best on large volumes, of 2³ on light ones (from the root, best of all widths).", "4.3, figure 4",
                 [_best_case(results, d, "leaf", [leaf], f"leaf {leaf}") for d, leaf in _FIG4_LEAVES.items()])


def best_leaf_of_search(search: Measurements) -> Claim:
    results = _of_bitfield(search)
    leaves = {d: str(published.TABLE1[d].parameters[published.BITFIELD]["leaf"]) for d in published.DATASETS}
    return Claim("The best leaf of the bitfield octree is the published one (best of all widths and levels).", "table 1",
                 [_best_case(results, d, "leaf", [leaf], f"leaf {leaf}") for d, leaf in leaves.items()],
                 note="The stand-ins and previews are smaller than the paper's volumes.")


def best_level(fig6: Measurements) -> Claim:
    results = [r for r in fig6.results if r.labels.get("traversal") == "bidirectional"]
    return Claim("Ignoring two or three levels below the root is best on most volumes (bidirectional).", "4.3, figure 6",
                 [_best_case(results, d, "initial_level", ["2", "3"], "level 2 or 3") for d in published.DATASETS], most_of)


def best_level_of_search(search: Measurements) -> Claim:
    levels = {d: published.TABLE1[d].parameters[published.BITFIELD]["initial_level"] for d in published.DATASETS}
    return Claim("Ignoring two or three levels below the root is best on most volumes (best of all leaves and widths).",
                 "4.3, table 1", [_best_case(_of_bitfield(search), d, "initial_level", ["2", "3"], f"level {level}")
                                  for d, level in levels.items()], most_of)


def _of_bitfield(search: Measurements) -> list[PointResult]:
    return [r for r in search.results if TECHNIQUES.get(r.technique) == published.BITFIELD]


def _best_case(results: list[PointResult], dataset: str, axis: str, wanted: list[str], paper: str) -> Case:
    """Held if the fastest point and all that can't be told from it have a wanted value; not held if none has."""
    case = Case(f"{dataset}: best {axis.replace('_', ' ')}", paper)
    mine = [r for r in results if r.labels.get("dataset") == dataset]
    best = best_of(contests_of(mine, [], "mean_ms", [])[0]) if any(r.completed for r in mine) else None
    if best is None:
        return case
    found = list(dict.fromkeys(r.labels[axis] for r in [best.point, *best.ties]))
    case.measured = f"{found[0]}" + (f" (can't be told from {', '.join(found[1:])})" if found[1:] else "")
    case.verdict = _choice_verdict(found, wanted)
    bounds = best.contest.times[id(best.point)]
    if bounds.low == bounds.high and len(best.contest.points) > 1:  # one orbit: ties can't be seen
        case.verdict, case.measured = UNDECIDED, f"{case.measured}, without bounds"
    least = _least_work(mine, axis)
    if least:
        case.other, case.other_verdict = ", ".join(least), _choice_verdict(least, wanted)
    return case


def _choice_verdict(found: list[str], wanted: list[str]) -> str:
    among = [value in wanted for value in found]
    return HELD if all(among) else UNDECIDED if any(among) else NOT_HELD


def _least_work(results: list[PointResult], axis: str) -> list[str]:
    """Values of the points with the fewest samples plus node tests."""
    works = [(work_of(r), r.labels[axis]) for r in results if r.completed and work_of(r) is not None]
    least = min((work for work, _ in works), default=None)
    return list(dict.fromkeys(value for work, value in works if work == least))


# Slow frames --------------------------------------------------------------------------------------------------


def slowest_percentile(table: Measurements) -> Claim:
    paper = published.SLOWEST_PERCENTILE_LONGER
    case = Case("mean over the table's points of low1_avg_ms / mean_ms", f"{1 + paper:.2f}")
    points = [r for d in published.DATASETS for c in published.CONFIGURATIONS for m in published.METHODS if (r := done(table, d, c, m)) is not None]
    if points:
        ratios = [r.statistics["low1_avg_ms"] / r.statistics["mean_ms"] for r in points]
        low, high = np.percentile(ratios, (5, 95))
        case.measured = Quantity(float(np.mean(ratios)), float(low), float(high), "percentiles 5 to 95 over points").text
        short = any(r.insufficient_frames for r in points)
        case.verdict = UNDECIDED if short or len(points) < 2 else HELD if low <= 1 + paper <= high else NOT_HELD
        if short:
            case.measured += ", too few poses for a tail"
    return Claim("The slowest 1 % of frames takes about 27 % longer on average.", "table 1", [case], in_other=False,
                 note="Held: the published value lies within percentiles 5 to 95 over the points.")
