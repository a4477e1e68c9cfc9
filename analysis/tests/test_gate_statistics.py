import json
import math
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from volmark_analysis.gate.change_points import change_points, steps
from volmark_analysis.gate.rules import IMPROVED, INCONCLUSIVE, REGRESSED, SAME, Rules
from volmark_analysis.gate.signed_rank import SignedRank, holm
from volmark_analysis.gate.timing import join_clocks, judge_times, suspects

RNG = np.random.default_rng(5)
LOADED = json.loads((Path(__file__).parent / "data" / "gate_pairs_loaded.json").read_text())["pairs"]


def rank_sum(values):
    """Wilcoxon's statistic by its textbook definition."""
    order = np.argsort(np.abs(values))
    return sum(place + 1 for place, i in enumerate(order) if values[i] > 0)


@pytest.mark.parametrize("count", [1, 4, 7, 10])
def test_chances_are_those_of_all_signs(count):
    values = RNG.normal(0.4, 1, count)
    reached = sum(rank_sum(np.abs(values) * signs) >= rank_sum(values) for signs in product((-1, 1), repeat=count))
    assert SignedRank(values).p_above(0.0) == pytest.approx(reached / 2**count, rel=1e-12)


def test_shifting_and_mirroring():
    values = RNG.normal(0, 1, 11)
    ranked = SignedRank(values)
    assert SignedRank(values + 3).p_above(3.5) == pytest.approx(ranked.p_above(0.5))
    assert SignedRank(-values).p_below(-0.2) == ranked.p_above(0.2)
    low, high = ranked.interval(0.95)
    assert SignedRank(-values).interval(0.95) == pytest.approx((-high, -low))
    assert SignedRank(2 * values + 1).interval(0.95) == pytest.approx((2 * low + 1, 2 * high + 1))
    assert low < ranked.center < high


@pytest.mark.parametrize("count", [6, 9, 14, 40])
def test_interval_holds_what_the_test_does_not_reject(count):
    ranked = SignedRank(RNG.normal(0, 1, count))
    low, high = ranked.interval(0.95)
    assert ranked.p_above(low + 1e-9) > 0.025 >= ranked.p_above(low - 1e-9)
    assert ranked.p_below(high - 1e-9) > 0.025 >= ranked.p_below(high + 1e-9)


def test_values_at_the_bound_are_no_evidence():
    assert SignedRank(np.zeros(9)).p_above(0.0) == SignedRank(np.zeros(9)).p_below(0.0) == 1.0


def test_too_few_pairs_bound_nothing():
    assert SignedRank(RNG.normal(0, 1e-6, 5)).interval(0.95) == (-math.inf, math.inf)


@pytest.mark.parametrize("count", [8, 12, 20])
def test_interval_covers_on_a_loaded_machine(count):
    """Recorded pairs of one build; which is called candidate is up to a coin, so the truth is 0."""
    pools = [np.array(clock) for point in LOADED.values() for clock in point.values()]
    hits = []
    for pool in pools:
        for _ in range(150):
            low, high = SignedRank(RNG.choice(pool, count) * RNG.choice((-1, 1), count)).interval(0.95)
            hits.append(low <= 0 <= high)
    assert 0.93 < np.mean(hits) < 0.985


def test_interval_forgets_outliers():
    """A pair that went astray by any amount costs a little width, as a rank does."""
    values = RNG.normal(0, 0.01, 12)
    wild = values.copy()
    wild[3] = 5.0
    assert SignedRank(wild).interval(0.95)[1] < 0.03 and abs(SignedRank(wild).center) < 0.02
    wilder = wild.copy()
    wilder[3] = 5e6
    assert SignedRank(wilder).interval(0.95) == SignedRank(wild).interval(0.95)


def test_holm_step_by_step():
    assert holm({"a": 0.01, "b": 0.04, "c": 0.03}) == pytest.approx({"a": 0.03, "c": 0.06, "b": 0.06})
    chances = dict(enumerate(RNG.uniform(0, 0.2, 9)))
    adjusted = holm(chances)
    order = sorted(chances, key=chances.get)
    assert all(chances[k] <= adjusted[k] <= min(1, 9 * chances[k]) for k in chances)
    assert all(adjusted[a] <= adjusted[b] for a, b in zip(order, order[1:]))
    assert holm({}) == {}


def pairs(percent, count=12, spread=0.004):
    return math.log1p(percent / 100) + RNG.normal(0, spread, count)


def one(first, confirmation=None, rules=Rules()):
    key = ("point", "cpu")
    return judge_times({key: first}, {} if confirmation is None else {key: confirmation}, rules)[key]


def test_outcomes_by_the_margin():
    assert one(pairs(0)).outcome == SAME
    assert one(pairs(1)).outcome == SAME
    assert one(pairs(-6)).outcome == IMPROVED
    assert one(pairs(2, spread=0.02)).outcome == INCONCLUSIVE
    assert one(pairs(0, spread=0.2)).outcome == INCONCLUSIVE
    assert one(pairs(0, count=5, spread=1e-6)).outcome == INCONCLUSIVE
    assert one(pairs(0)[:0]).outcome == INCONCLUSIVE
    assert one(pairs(4), pairs(4), Rules(margin=0.06)).outcome == SAME


def test_red_takes_two_independent_looks():
    slow = one(pairs(6))
    assert slow.outcome == INCONCLUSIVE and slow.suspected and slow.p_confirmed is None
    confirmed = one(pairs(6), pairs(6))
    assert confirmed.outcome == REGRESSED and confirmed.ratio == pytest.approx(1.06, abs=0.01) and confirmed.pairs == 24
    cleared = one(pairs(6), pairs(0))
    assert cleared.outcome == INCONCLUSIVE and cleared.suspected
    # What was not suspected can't become red by other pairs.
    assert one(pairs(0), pairs(60)).outcome != REGRESSED


def test_swapping_builds_swaps_verdicts():
    first = {("p", "cpu"): pairs(7), ("p", "wall"): pairs(0)}
    there = judge_times(first, {k: v for k, v in first.items()}, Rules())
    back = judge_times({k: -v for k, v in first.items()}, {}, Rules())
    assert there["p", "cpu"].outcome == REGRESSED and back["p", "cpu"].outcome == IMPROVED
    assert back["p", "cpu"].ratio == pytest.approx(1 / there["p", "cpu"].ratio, rel=1e-3)


def test_many_points_need_stronger_evidence():
    # All but one of seven above the margin.
    marginal = np.log1p(0.02) + np.array([0.03, 0.04, 0.05, 0.06, 0.07, 0.08, -0.01])
    alone = {("0", "cpu"): marginal}
    assert suspects(alone, Rules())
    crowd = alone | {(str(i), "cpu"): pairs(0, 7) for i in range(1, 9)}
    assert not suspects(crowd, Rules())


def test_clocks_are_joined_by_the_gravest():
    assert join_clocks([SAME, SAME]) == SAME
    assert join_clocks([IMPROVED, SAME]) == IMPROVED
    assert join_clocks([IMPROVED, INCONCLUSIVE]) == INCONCLUSIVE
    assert join_clocks([IMPROVED, REGRESSED]) == join_clocks([REGRESSED, IMPROVED]) == REGRESSED
    assert join_clocks([]) == INCONCLUSIVE


def test_levels_are_found_where_they_change():
    series = np.concatenate([RNG.normal(10, 0.1, 20), RNG.normal(10.4, 0.1, 15), RNG.normal(9.9, 0.1, 12)])
    found = change_points(series)
    assert len(found) == 2 and abs(found[0] - 20) <= 2 and abs(found[1] - 35) <= 2
    assert change_points(-5 * series) == found
    mirrored = change_points(series[::-1])
    assert [len(series) - i for i in reversed(mirrored)] == pytest.approx(found, abs=1)


def test_noise_and_short_series_have_no_levels():
    assert sum(bool(change_points(RNG.normal(0, 1, 30), seed=i)) for i in range(12)) <= 1
    assert change_points(np.array([1.0, 1, 1, 9, 9, 9])) == []
    assert change_points(np.ones(30)) == []


def test_steps_of_exact_values():
    assert steps(np.array([100.0, 100.01, 101, 101, 90]), 5e-4) == [2, 4]
    assert steps(np.array([5.0]), 0.1) == []
