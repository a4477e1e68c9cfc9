"""Measured quantities with bounds, and what they say about a limit."""

from __future__ import annotations

from dataclasses import dataclass

from ..columns import ABSENT, number_text
from ..points import PointResult, ratio_of
from ..search.objective import measured

HELD, NOT_HELD, UNDECIDED, NOT_MEASURED = "held", "not held", "not decidable", "not measured"


@dataclass(frozen=True)
class Quantity:
    value: float
    low: float | None = None
    high: float | None = None
    """None: without bounds, nothing can be decided."""
    kind: str = ""
    """What the bounds are."""

    @property
    def text(self) -> str:
        if self.low is None or self.high is None:
            return number_text(self.value)
        low, high = number_text(self.low), number_text(self.high)
        if self.kind == INTERVAL:
            return f"{number_text(self.value)} [{low}, {high}]"
        return f"{number_text(self.value)} ({low}{ABSENT}{high})"


INTERVAL, POSES, MEANS = "95 % interval", "spread over poses", "bounds of the two means"
KINDS = {INTERVAL: "[ ] 95 % interval, processes and then orbits resampled",
         POSES: "( ) of a ratio of times: percentiles 5 to 95 over poses, with fewer than five processes; where poses could not be "
                "paired (timed pacing): from the bounds of the two means"}


def time_ratio(a: PointResult, b: PointResult) -> Quantity:
    """Time of `a` over time of `b`, both completed. Bounds: the interval; else the spread over poses; with timed pacing, whose
    poses can't be paired, what the bounds of the two means allow."""
    ratio = ratio_of(a, b)
    if ratio.interval:
        return Quantity(ratio.median, *ratio.interval, INTERVAL)
    if ratio.paired:
        return Quantity(ratio.median, ratio.pose_low, ratio.pose_high, POSES)
    mean_a, mean_b = measured(a, "mean_ms"), measured(b, "mean_ms")
    if mean_a.low == mean_a.high or mean_b.low == mean_b.high:  # one orbit: nothing is known of their noise
        return Quantity(ratio.median)
    return Quantity(ratio.median, mean_a.low / mean_b.high, mean_a.high / mean_b.low, MEANS)


def quotient(a: Quantity, b: Quantity, kind: str) -> Quantity:
    """`a` over `b`, whose bounds are those of two measurements: the widest that they allow."""
    if a.low is None or b.low is None or b.low <= 0:
        return Quantity(a.value / b.value)
    return Quantity(a.value / b.value, a.low / b.high, a.high / b.low, kind)


def at_most(quantity: Quantity, limit: float) -> str:
    """Whether the bounds lie at or below the limit, above it, or on both sides."""
    if quantity.low is None:
        return UNDECIDED
    if quantity.high <= limit:
        return HELD
    return NOT_HELD if quantity.low > limit else UNDECIDED


def at_least(quantity: Quantity, limit: float) -> str:
    if quantity.low is None:
        return UNDECIDED
    if quantity.low >= limit:
        return HELD
    return NOT_HELD if quantity.high < limit else UNDECIDED


def above(quantity: Quantity, limit: float) -> str:
    """Beyond doubt above the limit."""
    verdict = at_most(quantity, limit)
    return {HELD: NOT_HELD, NOT_HELD: HELD}.get(verdict, verdict)


def within(quantity: Quantity, low: float, high: float) -> str:
    verdicts = at_least(quantity, low), at_most(quantity, high)
    if NOT_HELD in verdicts:
        return NOT_HELD
    return HELD if verdicts == (HELD, HELD) else UNDECIDED


def all_of(verdicts: list[str]) -> str:
    """Of a claim about all of several cells. What was not measured can't hold, nor be refuted."""
    if not verdicts or set(verdicts) == {NOT_MEASURED}:
        return NOT_MEASURED
    if NOT_HELD in verdicts:
        return NOT_HELD
    return HELD if set(verdicts) == {HELD} else UNDECIDED


def most_of(verdicts: list[str]) -> str:
    """Of a claim about more than half of several cells."""
    if not verdicts or set(verdicts) == {NOT_MEASURED}:
        return NOT_MEASURED
    if 2 * verdicts.count(HELD) > len(verdicts):
        return HELD
    return NOT_HELD if 2 * verdicts.count(NOT_HELD) >= len(verdicts) else UNDECIDED
