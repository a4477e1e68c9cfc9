"""What a gate on this machine can tell: how often it cries wolf, and which slowdown it finds.

Pairs are recorded with the real program: the same build under both names, and against a build that wastes a known share
of its time. Whole gates are then simulated from the recorded pairs with the very functions that judge: pairs drawn with
replacement, first and confirming ones, the two builds of an A/A pair swapped by a coin (they are the same).
"""

from __future__ import annotations

import json
from math import comb
from pathlib import Path

import numpy as np

from ..errors import InputError
from .evidence import VERSION, read_document
from .markdown import code
from .rules import IMPROVED, INCONCLUSIVE, REGRESSED, SAME, Rules
from .timing import join_clocks, judge_times
from .verdicts import Verdict, join

FORMAT = "volmark.calibration"
PAIR_NUMBERS = (8, 12, 16, 24, 40)
WANTED_RATE = 0.95
_SHARES = tuple(round(0.005 * i, 3) for i in range(1, 41)) + (0.25, 0.3, 0.4, 0.5, 0.75, 1.0)
"""Slowdowns among which the smallest one that is found is looked for."""

Recorded = dict[str, np.ndarray]
"""By point: clocks (in the order of the rules) x pairs, log ratios."""


def recorded_from(differences: dict[tuple[str, str], np.ndarray], rules: Rules) -> Recorded:
    points = dict.fromkeys(point for point, _ in differences)
    return {p: np.array([differences[p, clock] for clock in rules.clocks]) for p in points}


def draw(recorded: np.ndarray, count: int, swap: bool, rng: np.random.Generator) -> np.ndarray:
    """`count` pairs, all clocks of a pair together. `swap`: which build is called candidate is up to a coin."""
    chosen = recorded[:, rng.integers(recorded.shape[1], size=count)]
    return chosen * rng.choice((-1.0, 1.0), count) if swap else chosen


def simulate(recorded: Recorded, count: int, rules: Rules, rng: np.random.Generator, slow: str = "",
             share: float = 0.0, slow_pairs: np.ndarray | None = None) -> dict[str, str]:
    """Outcomes of one gate by point. The point `slow` has its times multiplied by 1 + share, or its pairs drawn from
    `slow_pairs` that were recorded against a slowed build."""
    stages = []
    for _ in range(2):
        differences = {}
        for point, pairs in recorded.items():
            if point == slow and slow_pairs is not None:
                drawn = draw(slow_pairs, count, False, rng)
            else:
                drawn = draw(pairs, count, True, rng) + (np.log1p(share) if point == slow else 0.0)
            differences |= {(point, clock): d for clock, d in zip(rules.clocks, drawn)}
        stages.append(differences)
    verdicts = judge_times(*stages, rules)
    return {point: join_clocks([verdicts[point, clock].outcome for clock in rules.clocks]) for point in recorded}


def outcome_counts(recorded: Recorded, count: int, rules: Rules, trials: int, rng: np.random.Generator, slow: str = "",
                   share: float = 0.0, slow_pairs: np.ndarray | None = None) -> dict[str, int]:
    """Of the slowed point, or of whole gates if none is."""
    counts = dict.fromkeys((REGRESSED, INCONCLUSIVE, SAME, IMPROVED), 0)
    for _ in range(trials):
        outcomes = simulate(recorded, count, rules, rng, slow, share, slow_pairs)
        counts[outcomes[slow] if slow else join(list(outcomes.values()))] += 1
    return counts


def smallest_share(recorded: Recorded, point: str, count: int, rules: Rules, trials: int,
                   rng: np.random.Generator) -> float | None:
    """The smallest slowdown of a point that simulated gates find at the wanted rate; None if even doubling isn't."""
    low, high = 0, len(_SHARES)
    while low < high:
        middle = (low + high) // 2
        found = outcome_counts(recorded, count, rules, trials, rng, point, _SHARES[middle])[REGRESSED]
        low, high = (low, middle) if found >= WANTED_RATE * trials else (middle + 1, high)
    return _SHARES[low] if low < len(_SHARES) else None


def at_most(count: int, trials: int) -> float:
    """Upper 95 % bound of Clopper and Pearson for a rate: where so few would come up in 5 % of all cases."""
    low, high = count / trials, 1.0
    for _ in range(50):
        rate = 0.5 * (low + high)
        chance = sum(comb(trials, i) * rate**i * (1.0 - rate) ** (trials - i) for i in range(count + 1))
        low, high = (rate, high) if chance > 0.05 else (low, rate)
    return high


def calibrate(recorded: Recorded, injected: dict[float, Recorded], rules: Rules, trials: int, seed: int = 1) -> dict:
    """`injected`: by share of wasted time, recorded like the A/A pairs. The result is a part of calibration.json."""
    rng = np.random.default_rng(seed)
    by_pairs = {}
    fewest = min(pairs.shape[1] for pairs in recorded.values())
    for count in (n for n in PAIR_NUMBERS if n <= fewest):  # what was never seen can't be drawn
        power_trials = max(40, trials // 5)
        by_pairs[str(count)] = {
            "aa": outcome_counts(recorded, count, rules, trials, rng), "trials": trials,
            "smallest_slowdown": {p: smallest_share(recorded, p, count, rules, power_trials, rng) for p in recorded},
            "injected": [{"share": share, "point": p, "trials": power_trials,
                          "outcomes": outcome_counts(recorded, count, rules, power_trials, rng, p, slow_pairs=pairs[p])}
                         for share, pairs in injected.items() for p in pairs if p in recorded]}
    return {"by_pairs": by_pairs, "recorded_pairs": {p: d.shape[1] for p, d in recorded.items()},
            "spread": {p: {clock: _spread(row) for clock, row in zip(rules.clocks, d)} for p, d in recorded.items()},
            "injected_median": {str(share): {p: {clock: float(np.expm1(np.median(row)))
                                                 for clock, row in zip(rules.clocks, d)} for p, d in pairs.items()}
                                for share, pairs in injected.items()}}


def _spread(differences: np.ndarray) -> float:
    """Of a pair's log ratio, robust: what a standard deviation would be."""
    return float(1.4826 * np.median(np.abs(differences - np.median(differences))))


def read_calibration(path: Path) -> dict | None:
    """None if there is none. Raises InputError."""
    if not path.exists():
        return None
    document = read_document(path, FORMAT)
    try:
        for entry in document["by_pairs"].values():
            entry["aa"][REGRESSED], entry["trials"], entry["smallest_slowdown"].items()
        document["device"], document["rules"]["margin"], document["created"][:10], document["conditions"]
    except (KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{path}: damaged ({type(error).__name__}: {error})") from None
    return document


def calibration_document(parts: dict, device: str, rules: Rules, created: str, instructions: list[dict],
                         conditions: str) -> dict:
    return {"format": FORMAT, "version": VERSION, "created": created, "device": device, "conditions": conditions,
            "rules": rules.to_json(), "instructions": instructions, **parts}


def calibration_text(calibration: dict | None, verdict: Verdict) -> str:
    """One or two sentences beside a verdict. Empty if no time was judged."""
    pairs = [c.pairs for p in verdict.points for c in p.clocks.values()]
    if not pairs:
        return ""
    if calibration is None:
        return "*Not calibrated*: how often this gate is wrong on this machine is unknown (`gate calibrate` measures it)."
    entry = _entry_for(calibration, min(pairs))
    if calibration["device"] != verdict.device or entry is None or _timing_rules(
            calibration["rules"]) != _timing_rules(verdict.rules.to_json()):
        return "*Not calibrated for this*: the stored calibration is of another device, other rules or more pairs."
    count, found = entry
    wrong, trials = found["aa"][REGRESSED], found["trials"]
    smallest = {p.key: found["smallest_slowdown"][p.key] for p in verdict.points if p.key in found["smallest_slowdown"]}
    if not smallest:
        limit = "no slowdown of these points was tried"
    elif None in smallest.values():
        limit = "of some point not even a doubled time is found reliably"
    else:
        limit = f"a slowdown of {100 * max(smallest.values()):g} % is found in {100 * WANTED_RATE:g} % of them"
    return (f"Calibrated {code(calibration['created'][:10])} ({code(calibration['conditions'])}): {wrong} false alarms in {trials} "
            f"simulated gates of {count} pairs (at most {100 * at_most(wrong, trials):.2g} %); {limit}.")


def _timing_rules(rules: dict) -> list:
    return [rules.get("margin"), rules.get("level"), rules.get("confidence"), list(rules.get("clocks", ()))]


def _entry_for(calibration: dict, pairs: int) -> tuple[int, dict] | None:
    """Of the largest calibrated number of pairs that is not above what was used."""
    known = [int(n) for n in calibration["by_pairs"] if int(n) <= pairs]
    return (max(known), calibration["by_pairs"][str(max(known))]) if known else None


def save(path: Path, document: dict) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
