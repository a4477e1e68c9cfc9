"""Which results are compared with which, and in what words."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from itertools import combinations

from .columns import ABSENT, error_text, number_text
from .errors import InputError
from .points import PointResult, axes_of, common_text, groups_of, label_text, ratio_of, varying_axes
from .statistics import CONFIDENCE, POSE_BAND, REPLICATES_FOR_INTERVAL, Ratio


@dataclass
class Comparison:
    """`ratio` is the time of `a` over the time of `b`."""

    a: PointResult
    b: PointResult
    ratio: Ratio
    where: str
    """What both sides share."""


def technique_comparisons(results: list[PointResult]) -> list[Comparison]:
    """Pairs of different techniques within a group that agree on every axis which both have."""
    axes = varying_axes(results)
    found = []
    for group in groups_of(results):
        done = [r for r in group if r.completed]
        for a, b in combinations(done, 2):
            if a.technique != b.technique and _agree(a, b, set(axes) - {"technique"}):
                found.append(Comparison(a, b, ratio_of(a, b), common_text([a, b], axes)))
    return found


def _agree(a: PointResult, b: PointResult, axes: set[str]) -> bool:
    return all(a.labels[x] == b.labels[x] for x in axes if x in a.labels and x in b.labels)


def parse_selection(texts: list[str], results: list[PointResult], option: str) -> dict[str, str]:
    """"label=value" texts, several of which may be joined by commas. Raises InputError."""
    known = axes_of(results)
    selection = {}
    for text in (part for joined in texts for part in joined.split(",")):
        name, equals, value = text.partition("=")
        if not equals:
            raise InputError(f"{option}: found {text!r}, allowed: label=value with a label of {', '.join(known)}")
        if name not in known:
            near = get_close_matches(name, known, n=1)
            raise InputError(f"{option}: no label {name!r}{f'; did you mean {near[0]}?' if near else ''} "
                             f"(allowed: {', '.join(known)})")
        values = list(dict.fromkeys(r.labels[name] for r in results if name in r.labels))
        if value not in values:
            raise InputError(f"{option}: label {name} has no value {value!r} (allowed: {', '.join(values)})")
        selection[name] = value
    return selection


def selection_comparisons(results: list[PointResult], a: dict[str, str], b: dict[str, str]) -> list[Comparison]:
    """Pairs of a result of selection `a` and one of `b` that agree on every other label. Raises InputError."""
    axes = varying_axes(results)
    chosen = {name: [r for r in results if r.completed and all(r.labels.get(k) == v for k, v in selection.items())]
              for name, selection in (("--a", a), ("--b", b))}
    for name, members in chosen.items():
        if not members:
            raise InputError(f"{name}: no completed run has these labels")
    free = set(axes) - set(a) - set(b)
    if "technique" not in a and "technique" not in b:
        free.add("technique")
    pairs = [(x, y) for x in chosen["--a"] for y in chosen["--b"] if x is not y and _agree(x, y, free)]
    if not pairs:
        raise InputError("--a, --b: no two different results agree on the other labels "
                         f"({', '.join(sorted(free)) or 'there are none'})")
    return [Comparison(x, y, ratio_of(x, y), common_text([x, y], axes)) for x, y in pairs]


def ratio_text(ratio: Ratio) -> str:
    """"1.87 (1.75–1.95 over poses) [1.84, 1.90]"."""
    text = number_text(ratio.median)
    if not ratio.paired:
        return f"{text} (of means, poses not paired)"
    text += f" ({number_text(ratio.pose_low)}{ABSENT}{number_text(ratio.pose_high)} over poses)"
    if ratio.interval:
        text += f" [{number_text(ratio.interval[0])}, {number_text(ratio.interval[1])}]"
    return text


def verdict(comparison: Comparison) -> str:
    """One plain sentence."""
    ratio, axes = comparison.ratio, _naming_axes(comparison)
    fast, slow = (comparison.a, comparison.b) if ratio.median <= 1 else (comparison.b, comparison.a)
    speedup = ratio.inverse() if ratio.median <= 1 else ratio
    names = f"{label_text(fast, axes)} ({error_text(fast)})", f"{label_text(slow, axes)} ({error_text(slow)})"
    if ratio.paired and not ratio.clear:
        doubt = ("the interval includes 1" if ratio.interval
                 else "which is faster depends on the pose")
        return f"No clear difference between {names[0]} and {names[1]}: {ratio_text(speedup)}, {doubt}"
    return f"{names[0]} was {ratio_text(speedup)} times as fast as {names[1]}"


def _naming_axes(comparison: Comparison) -> list[str]:
    """Axes that tell both sides apart."""
    return [x for x in varying_axes([comparison.a, comparison.b]) if x != "technique"]


def to_markdown(comparisons: list[Comparison]) -> str:
    lines = ["| where | A | B | A, ms | A, error | B, ms | B, error | A/B | over poses | interval |",
             "| --- | --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"]
    for c in comparisons:
        ratio, axes = c.ratio, _naming_axes(c)
        poses = (f"{number_text(ratio.pose_low)}{ABSENT}{number_text(ratio.pose_high)}" if ratio.paired else "not paired")
        interval = (f"[{number_text(ratio.interval[0])}, {number_text(ratio.interval[1])}]" if ratio.interval else ABSENT)
        cells = [c.where or "all", label_text(c.a, axes), label_text(c.b, axes), number_text(c.a.statistics["mean_ms"]),
                 error_text(c.a), number_text(c.b.statistics["mean_ms"]), error_text(c.b), number_text(ratio.median),
                 poses, interval]
        lines.append("| " + " | ".join(x.replace("|", "\\|") for x in cells) + " |")
    return "\n".join(lines + ["", f"- {explanation()}"]) + "\n"


def explanation() -> str:
    return (f"A/B: median over poses of the ratio of frame times (geometric means over orbits and processes); below 1, A "
            f"is faster. Over poses: percentiles {POSE_BAND[0]:g} to {POSE_BAND[1]:g}. Interval: {100 * CONFIDENCE:.0f} %, "
            f"processes and then orbits resampled, poses fixed; needs {REPLICATES_FOR_INTERVAL} processes.")
