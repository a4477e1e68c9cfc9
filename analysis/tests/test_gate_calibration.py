import json
from math import comb
from pathlib import Path

import numpy as np
import pytest
from gate_folders import make_side, write_gate
from volmark_analysis.errors import InputError
from volmark_analysis.gate.calibration import (at_most, calibrate, calibration_document, calibration_text, draw, outcome_counts,
                                               read_calibration, save, smallest_share)
from volmark_analysis.gate.evidence import read_evidence
from volmark_analysis.gate.rules import IMPROVED, REGRESSED, SAME, Rules
from volmark_analysis.gate.verdicts import judge

DATA = json.loads((Path(__file__).parent / "data" / "gate_pairs_loaded.json").read_text())["pairs"]
LOADED = {point: np.array([clocks["cpu"], clocks["wall"]]) for point, clocks in DATA.items()}
RNG = np.random.default_rng(9)


def quiet(spread=0.01, pairs=60):
    return {name: RNG.normal(0, spread, (2, pairs)) for name in ("a", "b", "c")}


@pytest.mark.parametrize("recorded", [LOADED, quiet()], ids=["loaded", "quiet"])
@pytest.mark.parametrize("pairs", [8, 16])
def test_false_alarms_are_rare(recorded, pairs):
    counts = outcome_counts(recorded, pairs, Rules(), 120, RNG)
    assert sum(counts.values()) == 120
    assert counts[REGRESSED] <= 1 and counts[IMPROVED] <= 3


def test_five_percent_is_found_or_said_to_be_unknown():
    for recorded in (LOADED, quiet()):
        counts = outcome_counts(recorded, 12, Rules(), 80, RNG, next(iter(recorded)), 0.05)
        assert counts[SAME] == counts[IMPROVED] == 0
    assert counts[REGRESSED] >= 0.95 * 80  # the quiet machine


def test_on_a_loaded_machine_forty_pairs_find_ten_percent():
    counts = outcome_counts(LOADED, 40, Rules(), 40, RNG, "isosurface", 0.10)
    assert counts[REGRESSED] >= 0.95 * 40


def test_quieter_machines_and_more_pairs_find_less():
    def smallest(spread, pairs):
        return smallest_share(quiet(spread), "a", pairs, Rules(), 40, np.random.default_rng(1))
    assert 0.02 < smallest(0.004, 12) < smallest(0.03, 12)
    assert smallest(0.03, 24) < smallest(0.03, 8)
    assert smallest(5.0, 8) is None
    share = smallest(0.03, 12)
    found = [outcome_counts(quiet(0.03), 12, Rules(), 60, RNG, "a", s)[REGRESSED] / 60 for s in (share, 0.6 * share)]
    assert found[0] > 0.85 > found[1]


def test_swapped_pairs_keep_their_clocks_together():
    recorded = np.array([[1.0, 2.0, 3.0], [10.0, 20.0, 30.0]])
    drawn = draw(recorded, 200, True, RNG)
    assert np.array_equal(drawn[1], 10 * drawn[0])
    assert {-3, -2, -1, 1, 2, 3} == set(drawn[0])
    assert set(draw(recorded, 200, False, RNG)[0]) == {1, 2, 3}


@pytest.mark.parametrize("count, trials", [(0, 100), (3, 400), (5, 5)])
def test_bound_of_a_rate(count, trials):
    bound = at_most(count, trials)
    below = sum(comb(trials, i) * bound**i * (1 - bound)**(trials - i) for i in range(count + 1))
    assert bound == 1 if count == trials else below == pytest.approx(0.05, rel=1e-6)


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """A calibration of the synthetic machine, in its file."""
    rules, recorded = Rules(), {"ci: dvr": RNG.normal(0, 0.005, (2, 20))}
    slowed = {0.05: {"ci: dvr": recorded["ci: dvr"] + np.log(1.05)}}
    parts = calibrate(recorded, slowed, rules, 30)
    path = tmp_path_factory.mktemp("calibration") / "calibration.json"
    device = "llvmpipe (LLVM 15) / llvmpipe / Mesa 25"
    save(path, calibration_document(parts, device, rules, "2025-01-31T12:00:00Z", [], "quiet machine"))
    return path


def test_document_tells_rates_by_number_of_pairs(stored):
    document = read_calibration(stored)
    assert (document["format"], document["version"]) == ("volmark.calibration", 1)
    entry = document["by_pairs"]["12"]
    assert list(document["by_pairs"]) == ["8", "12", "16"]  # up to what was recorded
    assert sum(entry["aa"].values()) == entry["trials"] == 30
    assert entry["injected"][0]["outcomes"][REGRESSED] >= 38
    assert 0.02 < entry["smallest_slowdown"]["ci: dvr"] <= 0.05
    assert document["spread"]["ci: dvr"]["cpu"] == pytest.approx(0.005, rel=0.5)
    assert document["injected_median"]["0.05"]["ci: dvr"]["wall"] == pytest.approx(0.05, abs=0.01)


def test_verdicts_say_what_was_calibrated(tmp_path, stored):
    evidence = read_evidence(write_gate(tmp_path, {("ci", "dvr"): (make_side(), make_side())}, pairs=9))
    verdict, calibration = judge(evidence, Rules()), read_calibration(stored)
    calibration["by_pairs"]["9"] = calibration["by_pairs"].pop("8")
    text = calibration_text(calibration, verdict)
    assert "2025-01-31" in text and "gates of 9 pairs" in text and "`quiet machine`" in text and "is found" in text
    assert "gates of 8 pairs" in calibration_text(read_calibration(stored), verdict)  # the largest number not above
    others = [calibration | {"device": "another"}, calibration | {"by_pairs": {"12": calibration["by_pairs"]["12"]}}]
    assert all("Not calibrated for this" in calibration_text(other, verdict) for other in others)
    assert "Not calibrated for this" in calibration_text(calibration, judge(evidence, Rules(margin=0.05)))
    assert "gate calibrate" in calibration_text(None, verdict)
    assert calibration_text(calibration, judge(evidence, Rules(clocks=()))) == ""


def test_damaged_files_are_one_line(tmp_path, stored):
    path = tmp_path / "calibration.json"
    assert read_calibration(path) is None
    document = json.loads(stored.read_text())
    for text in ("{", "{}", json.dumps(document | {"by_pairs": {"8": {}}}), json.dumps(document | {"rules": 1})):
        path.write_text(text)
        with pytest.raises(InputError) as error:
            read_calibration(path)
        assert "calibration.json" in str(error.value) and "\n" not in str(error.value)
