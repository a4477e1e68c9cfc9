"""Builds of volmark are compared as techniques are: interleaved, under a label of their own."""

import pytest
from conftest import PROGRAM, SMALL


def script(volmark, name, **variables):
    """A build that differs from this one by its environment."""
    path = volmark.folder / name
    settings = " ".join(f"{key}='{value}'" for key, value in variables.items())
    path.write_text(f'#!/bin/sh\nexec env {settings} "{PROGRAM}" "$@"\n')
    path.chmod(0o755)
    return path


def grid(volmark, **settings):
    technique = {"name": "test_faults", "parameters": {"frame_ms": 1}}
    document = {"set": {**SMALL, "technique": technique, **settings},
                "blocks": [{"axes": {"at": {"path": "technique.parameters.at", "values": [100, 200, 300]}}}]}
    return volmark.scenario(document)


def test_builds_of_a_point_take_turns_in_a_recorded_shuffled_order(volmark):
    path = grid(volmark, pacing={**SMALL["pacing"], "orbits": 12}, measure={"replicates": 2, "interleave": 3})
    result = volmark("run", path, "--build", f"old={PROGRAM}", "--build", f"new={PROGRAM}", "--points", "0,2",
                     "--results", volmark.results)
    assert result.returncode == 0, result.stderr
    runs = volmark.runs()
    assert len(runs) == 2 * 2 * 2 and len({run["run"] for run in runs.values()}) == 8
    assert len({run["point"] for run in runs.values()}) == 2, "a build is not part of what a point is"
    assert {tuple(run["labels"]) for run in runs.values()} == {("technique", "build", "at")}
    for at in ("100", "300"):
        for replicate in (0, 1):
            old, new = (runs["test_faults", build, at, replicate]["turns"] for build in ("old", "new"))
            old, new = ([turn for turn in turns if turn["orbit_kind"] == "headline"] for turns in (old, new))
            assert len(old) == len(new) == 12
            # Interleave is 3: two builds of one point fit, those of a second one don't.
            assert all({a["place"], b["place"]} == {0, 1} and a["of"] == b["of"] == 2 for a, b in zip(old, new))
            assert {turn["place"] for turn in old} == {0, 1}, "never another order"


def test_a_slower_build_is_slower_by_what_it_wastes(volmark):
    slow = script(volmark, "slow", VOLMARK_WASTE_TIME="1")
    path = volmark.scenario({"set": {**SMALL, "technique": {"name": "test_host_threads", "parameters": {}},
                                     "resolution": [256, 256]}})
    result = volmark("run", path, "--build", f"base={PROGRAM}", "--build", f"slow={slow}", "--results", volmark.results)
    assert result.returncode == 0, result.stderr
    base, slow = (volmark.runs()["test_host_threads", build, 0] for build in ("base", "slow"))
    assert slow["statistics"]["cpu"]["median_ms"] > 1.5 * base["statistics"]["cpu"]["median_ms"]
    assert slow["provenance"]["environment"]["VOLMARK_WASTE_TIME"] == "1", "what was asked for is on record"


def test_a_build_without_the_technique_is_a_row_that_says_so(volmark):
    empty = script(volmark, "empty", VOLMARK_TECHNIQUES="/nowhere")
    result = volmark("run", grid(volmark), "--points", "1", "--build", f"base={empty}", "--build", f"new={PROGRAM}",
                     "--results", volmark.results)
    assert result.returncode == 0, result.stderr
    runs = volmark.runs()
    assert runs["test_faults", "new", "200", 0]["status"] == "completed"
    assert runs["test_faults", "base", "200", 0]["status"] == "unsupported"
    assert runs["test_faults", "base", "200", 0]["reason"] == 'build "base" has no technique "test_faults"'


@pytest.mark.parametrize("builds, said", [
    (["old"], 'found "old", allowed: NAME=PROGRAM'),
    (["a b=/bin/true"], "allowed: NAME=PROGRAM"),
    (["old=/no/such/program"], "--build old: found /no/such/program, allowed: a program that can be started"),
    (["old=/bin/true"], "--build old: /bin/true did not answer as a worker (exit code 0)"),
    ([f"old={PROGRAM}", f"old={PROGRAM}"], "--build old: found twice"),
])
def test_what_is_no_build_is_one_line(volmark, builds, said):
    options = [text for build in builds for text in ("--build", build)]
    result = volmark("run", grid(volmark), *options, "--results", volmark.results)
    assert result.returncode == 2 and said in result.stderr and result.stderr.count("\n") == 1, result.stderr
    assert not volmark.results.exists()


def test_an_axis_called_build_is_in_the_way(volmark):
    path = volmark.scenario({"set": {**SMALL, "technique": {"name": "test_faults", "parameters": {}}},
                             "blocks": [{"axes": {"build": {"path": "measure.seed", "values": [1, 2]}}}]})
    result = volmark("run", path, "--build", f"a={PROGRAM}", "--results", volmark.results)
    assert result.returncode == 2 and 'found an axis "build"' in result.stderr
    assert not volmark.results.exists()


def test_drawing_alone_does_as_many_frames_as_it_says(volmark):
    result = volmark("draw", grid(volmark), "--point", "2", "--orbits", "3")
    assert result.returncode == 0 and "test_faults: 18 frames" in result.stdout
    assert not volmark.results.exists()
    result = volmark("draw", grid(volmark), "--point", "3")
    assert result.returncode == 2 and "--point: found" in result.stderr
