import json

import numpy as np
import pytest
from gate_folders import DEVICE, make_side, write_gate
from volmark_analysis.errors import InputError
from volmark_analysis.gate.evidence import read_evidence
from volmark_analysis.gate.rules import IMPROVED, INCONCLUSIVE, NOT_COMPARED, REGRESSED, SAME, Rules
from volmark_analysis.gate.verdicts import join, judge, suspected_points, to_json

SAME_SIDES = (make_side(), make_side())


def judged(tmp_path, candidate, base=None, rules=Rules(), pairs=8, confirming=0):
    """The verdict on one point."""
    folder = write_gate(tmp_path / "gate", {("ci", "dvr"): (base or make_side(), candidate)}, pairs, confirming)
    verdict = judge(read_evidence(folder), rules)
    return verdict, verdict.points[0]


def finding(point, evidence):
    found = [f for f in point.findings if f.evidence == evidence]
    assert len(found) == 1, point.findings
    return found[0]


def test_equal_builds_are_the_same(tmp_path):
    verdict, point = judged(tmp_path, make_side())
    assert verdict.outcome == SAME and verdict.exit_code == 0 and not verdict.notes
    assert {f.outcome for f in point.findings} == {SAME}
    assert {f.evidence for f in point.findings} == {"pictures", "counters", "instructions", "time"}
    assert verdict.device == DEVICE


@pytest.mark.parametrize("change, evidence", [
    ({"picture": 0.501}, "pictures"), ({"counters": {"samples": 9001.0, "rays": 120.0}}, "counters"),
    ({"counters": {"samples": 9000.0, "rays": 119.0}}, "counters"), ({"counters": {"samples": 9000.0}}, "counters"),
    ({"counters": {"samples": 9000.0, "rays": 120.0, "more": 1.0}}, "counters"), ({"instructions": 10.01e6}, "instructions")])
def test_exact_changes_are_red_until_accepted(tmp_path, change, evidence):
    verdict, point = judged(tmp_path, make_side(**change))
    assert verdict.outcome == REGRESSED and verdict.exit_code == 1
    assert [f.evidence for f in point.findings if f.outcome != SAME] == [evidence]
    accepted = judge(read_evidence(tmp_path / "gate"), Rules(accept_changes=True))
    assert accepted.outcome == SAME and "accepted" in finding(accepted.points[0], evidence).text


def test_faster_but_wrong_fails_even_if_accepted(tmp_path):
    verdict, point = judged(tmp_path, make_side(cpu=0.5, wall=0.5, picture=0.4, mse=2e-4), rules=Rules(accept_changes=True))
    assert verdict.outcome == REGRESSED
    assert finding(point, "time").outcome == IMPROVED
    assert "0.0001 to 0.0002" in finding(point, "pictures").text


def test_worse_errors_of_equal_bits_count_too(tmp_path):
    """Pictures of techniques that are not deterministic have no bits to compare."""
    sides = [make_side(deterministic=False, picture=p, mse=m) for p, m in ((0.5, 1e-4), (0.6, 1.01e-4), (0.6, 1.1e-4))]
    assert finding(judged(tmp_path / "a", sides[1], sides[0])[1], "pictures").outcome == SAME
    assert finding(judged(tmp_path / "b", sides[2], sides[0])[1], "pictures").outcome == REGRESSED


def test_statistical_counters_are_not_compared(tmp_path):
    assert judged(tmp_path, make_side(statistical=7.0))[0].outcome == SAME


def test_what_stops_repeating_is_a_change_and_what_never_did_is_no_evidence(tmp_path):
    wild = make_side(repeats=False)
    verdict, point = judged(tmp_path / "a", wild)
    assert verdict.outcome == REGRESSED
    assert all("does not repeat between processes" in finding(point, name).text for name in ("pictures", "counters"))
    verdict, point = judged(tmp_path / "b", wild, wild)
    assert verdict.outcome == SAME
    assert all("unrepeatable" in finding(point, name).text for name in ("pictures", "counters"))


def test_a_thousandth_more_instructions_is_found_and_less_is_better(tmp_path):
    for name, share, outcome in (("a", 1e-3, REGRESSED), ("b", 1e-5, SAME), ("c", -1e-5, SAME), ("d", -1e-3, IMPROVED)):
        verdict, point = judged(tmp_path / name, make_side(instructions=10e6 * (1 + share)))
        assert finding(point, "instructions").outcome == outcome == verdict.outcome


def test_more_work_is_red_though_time_is_in_doubt(tmp_path):
    noisy = make_side(noise=0.2, instructions=10.1e6)
    verdict, point = judged(tmp_path, noisy, make_side(noise=0.2))
    assert finding(point, "time").outcome == INCONCLUSIVE and verdict.outcome == REGRESSED


def test_less_work_is_not_green_while_time_is_in_doubt(tmp_path):
    verdict, _ = judged(tmp_path, make_side(noise=0.2, instructions=9e6), make_side(noise=0.2))
    assert verdict.outcome == INCONCLUSIVE and verdict.exit_code == 4


def test_slower_time_alone_needs_confirmation(tmp_path):
    slow = make_side(cpu=1.06, wall=1.06)
    folder = write_gate(tmp_path / "first", {("ci", "dvr"): (make_side(), slow), ("ci", "iso"): SAME_SIDES}, pairs=8)
    evidence = read_evidence(folder)
    assert [p.name for p in suspected_points(evidence.points, Rules())] == ["dvr"]
    assert judge(evidence, Rules()).outcome == INCONCLUSIVE
    verdict, point = judged(tmp_path / "both", slow, confirming=8)
    assert verdict.outcome == REGRESSED and "confirmed" in finding(point, "time").text


def test_one_slower_clock_is_enough(tmp_path):
    verdict, point = judged(tmp_path, make_side(cpu=0.9, wall=1.08), confirming=8)
    assert point.clocks["cpu"].outcome == IMPROVED and point.clocks["wall"].outcome == REGRESSED
    assert verdict.outcome == REGRESSED
    assert judge(read_evidence(tmp_path / "gate"), Rules(clocks=("cpu",))).outcome == IMPROVED


@pytest.mark.parametrize("candidate, base, outcome, words", [
    ({"status": "failed", "reason": "device lost"}, {}, REGRESSED, "failed: device lost"),
    ({}, {"status": "unsupported", "reason": "no module"}, NOT_COMPARED, "base can't run it (unsupported: no module)"),
    ({"status": "crashed"}, {"status": "crashed"}, NOT_COMPARED, "neither can run it")])
def test_points_that_a_build_cannot_run_are_named(tmp_path, candidate, base, outcome, words):
    verdict, point = judged(tmp_path, make_side(**candidate), make_side(**base))
    assert point.outcome == outcome and words in point.findings[0].text
    assert verdict.outcome == (REGRESSED if outcome == REGRESSED else INCONCLUSIVE)  # nothing was compared


def test_what_was_not_compared_does_not_outweigh_what_was(tmp_path):
    folder = write_gate(tmp_path, {("ci", "new"): (make_side(status="unsupported"), make_side()), ("ci", "dvr"): SAME_SIDES})
    assert judge(read_evidence(folder), Rules()).outcome == SAME


def test_a_check_that_fails_in_candidate_only(tmp_path):
    assert finding(judged(tmp_path / "a", make_side(checks=False))[1], "checks").outcome == REGRESSED
    assert judged(tmp_path / "b", make_side(checks=False), make_side(checks=False))[0].outcome == SAME


@pytest.mark.parametrize("change, words", [
    ({"device": "another GPU"}, "different device"), ({"provenance": {"host": {"name": "there"}}}, "different machine"),
    ({"point_hash": "other", "config": {"scene": "gyroid"}}, "different settings (base, candidate): scene \"noise\", \"gyroid\"".replace('"', "")),
    ({"point_hash": "other"}, "different data")])
def test_what_cannot_be_compared_is_refused(tmp_path, change, words):
    with pytest.raises(InputError) as error:
        judged(tmp_path, make_side(**change))
    assert words in str(error.value) and "ci: dvr" in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("change, words", [
    ({"governor": "powersave"}, "different governor"), ({"provenance": {"build": {"type": "Debug"}}}, "not a Release build"),
    ({"provenance": {"program": {"dirty": True}}}, "uncommitted changes"),
    ({"provenance": {"environment": {"LP_NUM_THREADS": "1"}}}, "environment LP_NUM_THREADS: base unset, candidate 1"),
    ({"point_hash": "other", "config": {"technique": {"new": 1}}}, "only one build knows: technique.new"),
    ({"disturbed": "switches"}, "% of the frames had competition")])
def test_what_differs_a_little_is_said(tmp_path, change, words):
    verdict, _ = judged(tmp_path, make_side(**change))
    assert verdict.outcome == SAME and any(words in note for note in verdict.notes), verdict.notes


def test_instructions_of_one_side_alone_are_no_evidence(tmp_path):
    verdict, point = judged(tmp_path, make_side(instructions=0))
    assert verdict.outcome == SAME and all(f.evidence != "instructions" for f in point.findings)


def test_the_gravest_outcome_wins():
    assert join([SAME, IMPROVED]) == IMPROVED
    assert join([SAME, INCONCLUSIVE, IMPROVED]) == INCONCLUSIVE
    assert join([INCONCLUSIVE, REGRESSED]) == REGRESSED
    assert join([NOT_COMPARED, SAME]) == SAME
    assert join([NOT_COMPARED]) == join([]) == INCONCLUSIVE


def test_pairs_are_of_equal_replicates_and_poses(tmp_path):
    """A replicate that one build lost takes its partner with it; a missing frame is no pair at all."""
    folder = write_gate(tmp_path, {("ci", "dvr"): SAME_SIDES}, pairs=9)
    runs = {(d["labels"]["build"], d["replicate"]): (path, d) for path in folder.glob("first/ci/runs/*/*/run.json")
            for d in [json.loads(path.read_text())]}
    path, document = runs["base", 2]
    path.write_text(json.dumps(document | {"status": "crashed"}))
    clock = judge(read_evidence(folder), Rules()).points[0].clocks["cpu"]
    assert clock.pairs == 8 and clock.outcome == SAME  # any other pairing brings in what processes share
    frames = runs["candidate", 5][0].parent / "frames.csv"
    frames.write_text("\n".join(frames.read_text().splitlines()[:-1]) + "\n")
    with pytest.raises(InputError, match="other poses"):
        judge(read_evidence(folder), Rules())


def test_commits_of_folders_are_what_their_programs_say(tmp_path):
    folder = write_gate(tmp_path, {("ci", "dvr"): (make_side(), make_side(provenance={"program": {"commit": "dead"}}))}, 1)
    asked = json.loads((folder / "gate.json").read_text())
    assert read_evidence(folder).candidate.commit == asked["candidate"]["commit"]
    asked["base"]["commit"] = asked["candidate"]["commit"] = ""
    (folder / "gate.json").write_text(json.dumps(asked))
    evidence = read_evidence(folder)
    assert (evidence.base.commit, evidence.candidate.commit) == ("", "dead")


def test_json_holds_what_was_decided(tmp_path):
    folder = write_gate(tmp_path, {("ci", "dvr"): (make_side(), make_side(cpu=1.2)), ("other", "iso"): SAME_SIDES})
    evidence = read_evidence(folder)
    document = json.loads(json.dumps(to_json(judge(evidence, Rules()), evidence, {"created": "now"})))
    assert (document["format"], document["version"], document["outcome"]) == ("volmark.verdict", 1, INCONCLUSIVE)
    assert [s["outcome"] for s in document["scenarios"]] == [INCONCLUSIVE, SAME]
    clock = document["scenarios"][0]["points"][0]["time"]["cpu"]
    assert clock["low"] < 1.2 < clock["high"] and clock["suspected"] and np.isclose(clock["ratio"], 1.2, atol=0.02)


@pytest.mark.parametrize("file, text", [
    ("gate.json", "{}"), ("gate.json", "["), ("gate.json", '{"format": "volmark.gate", "version": 1, "base": 1}'),
    ("instructions.json", '{"format": "volmark.instructions", "version": 1, "counts": [{"scenario": "ci"}]}'),
    ("instructions.json", '{"format": "volmark.instructions", "version": 2}'), ("first/ci/experiment.json", "{}")])
def test_damaged_folders_are_one_line(tmp_path, file, text):
    folder = write_gate(tmp_path, {("ci", "dvr"): SAME_SIDES}, pairs=1)
    (folder / file).write_text(text)
    with pytest.raises(InputError) as error:
        read_evidence(folder)
    assert file in str(error.value) and "\n" not in str(error.value)


def test_other_folders_are_one_line(tmp_path):
    with pytest.raises(InputError, match="gate.json"):
        read_evidence(tmp_path)
    folder = write_gate(tmp_path, {("ci", "dvr"): (make_side(), None)}, pairs=1)
    for path in folder.glob("first/ci/runs/*/*/run.json"):
        path.write_text(path.read_text().replace('"build": "base"', '"build": "mine"'))
    with pytest.raises(InputError, match="/labels/build"):
        read_evidence(folder)
