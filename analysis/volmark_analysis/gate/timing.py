"""Time: differences of pairs of processes, and what they say about both builds.

The unit is the pair: replicate i of base and replicate i of candidate, alive together, taking turns orbit by orbit.
Frames and orbits of a process share its memory layout and its luck; they say little about the next process.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import InputError
from ..load import Run
from .rules import CLOCKS, IMPROVED, INCONCLUSIVE, REGRESSED, SAME, Rules
from .signed_rank import SignedRank, holm

Key = tuple[str, str]
"""Name of a point and of a clock."""


@dataclass(frozen=True)
class ClockVerdict:
    outcome: str
    ratio: float | None
    """Time of candidate over time of base, over all pairs; None without any."""
    low: float | None
    high: float | None
    """None: too few pairs."""
    pairs: int
    p_slower: float | None
    """Holm-adjusted, of the first pairs alone, for "not slower than the margin"."""
    p_confirmed: float | None
    """The same of the confirming pairs; None if there was nothing to confirm or nobody did."""
    suspected: bool
    """Looked slower by more than the margin in the first pairs."""


def pair_differences(base: list[Run], candidate: list[Run], clock: str) -> np.ndarray:
    """Log ratios candidate / base, one for each replicate that both completed: the median over poses and orbits, each
    frame against the frame of the same orbit and pose."""
    others = {run.replicate: run for run in candidate}
    pairs = [(run, others[run.replicate]) for run in base if run.replicate in others]
    return np.array([_difference(a, b, clock) for a, b in pairs])


def _difference(base: Run, candidate: Run, clock: str) -> float:
    column = CLOCKS[clock]
    tables = []
    for run in (base, candidate):
        rows = run.headline.sort_values(["orbit", "frame"])
        times = rows[column].to_numpy()
        if not (times > 0).all():
            raise InputError(f"{run.folder / 'frames.csv'}: column {column}: a headline frame has no time above 0")
        tables.append((rows[["orbit", "frame"]].to_numpy(), rows.phase.to_numpy(), times))
    (places_a, phases_a, times_a), (places_b, phases_b, times_b) = tables
    if places_a.shape != places_b.shape or (places_a != places_b).any() or not np.allclose(phases_a, phases_b, atol=1e-6):
        raise InputError(f"{candidate.folder / 'frames.csv'}: other poses than in {base.folder.name}: only scenarios "
                         f"with pacing of mode frames can be paired")
    return float(np.median(np.log(times_b / times_a)))


def suspects(first: dict[Key, np.ndarray], rules: Rules) -> dict[Key, float]:
    """Adjusted chances of those that look slower by more than the margin: to be confirmed with fresh processes."""
    return _below_level(_slower(_ranked(first), rules), rules)


def _ranked(differences: dict[Key, np.ndarray]) -> dict[Key, SignedRank]:
    return {key: SignedRank(d) for key, d in differences.items() if len(d)}


def _slower(ranked: dict[Key, SignedRank], rules: Rules) -> dict[Key, float]:
    return holm({key: r.p_above(np.log1p(rules.margin)) for key, r in ranked.items()})


def _below_level(chances: dict[Key, float], rules: Rules) -> dict[Key, float]:
    return {key: p for key, p in chances.items() if p <= rules.level}


def judge_times(first: dict[Key, np.ndarray], confirmation: dict[Key, np.ndarray],
                rules: Rules) -> dict[Key, ClockVerdict]:
    """`regressed`: suspected by the first pairs and confirmed by fresh ones. All other outcomes are about all pairs."""
    slower = _slower(_ranked(first), rules)
    suspected = _below_level(slower, rules)
    confirmed = _slower(_ranked({key: confirmation[key] for key in suspected if key in confirmation}), rules)
    pairs = {key: np.concatenate([d, confirmation.get(key, d[:0])]) for key, d in first.items()}
    ranked = _ranked(pairs)
    bound = np.log1p(rules.margin)
    faster = holm({key: r.p_below(-bound) for key, r in ranked.items()})
    verdicts = {}
    for key, d in pairs.items():
        low, high = ranked[key].interval(rules.confidence) if key in ranked else (-np.inf, np.inf)
        if confirmed.get(key, 1.0) <= rules.level:
            outcome = REGRESSED
        elif faster.get(key, 1.0) <= rules.level:
            outcome = IMPROVED
        else:
            outcome = SAME if -bound < low and high < bound else INCONCLUSIVE
        ratio = float(np.exp(ranked[key].center)) if key in ranked else None
        verdicts[key] = ClockVerdict(outcome, ratio, _ratio(low), _ratio(high), len(d), slower.get(key),
                                     confirmed.get(key), key in suspected)
    return verdicts


def _ratio(logarithm: float) -> float | None:
    return float(np.exp(logarithm)) if np.isfinite(logarithm) else None


def join_clocks(outcomes: list[str]) -> str:
    """One slower clock is a regression; "same" takes all of them, "improved" one without another in doubt."""
    if REGRESSED in outcomes:
        return REGRESSED
    if INCONCLUSIVE in outcomes or not outcomes:
        return INCONCLUSIVE
    return IMPROVED if IMPROVED in outcomes else SAME
