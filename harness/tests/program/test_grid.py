"""A grid survives its techniques, kills and interruptions, and repeats nothing."""

import json
import re
import signal
import time

import pytest
from conftest import SMALL


def faults(*names, **parameters):
    return {"set": {**SMALL, "technique": {"name": "test_faults", "parameters": parameters}},
            "blocks": [{"axes": {"fault": {"path": "technique.parameters.fault", "values": list(names)}}}]}


def by_fault(runs):
    return {document["labels"]["fault"].strip('"'): document for document in runs.values()}


def test_each_fault_becomes_a_row_and_costs_nobody_else(volmark):
    names = ["none", "crash", "throw", "memory", "unsupported", "hang", "kill", "lie"]
    document = faults(*names)
    document["set"]["measure"] = {"time_limit_seconds": 2, "interleave": 8}
    result = volmark("run", volmark.scenario(document), "--results", volmark.results)
    assert result.returncode == 1, result.stderr
    runs = by_fault(volmark.runs())
    assert {name: runs[name]["status"] for name in names} == {
        "none": "completed", "crash": "crashed", "throw": "failed", "memory": "out_of_memory",
        "unsupported": "unsupported", "hang": "timed_out", "kill": "crashed", "lie": "completed"}
    # A sanitizer makes an abort of it.
    assert "signal 11" in runs["crash"]["reason"] or "signal 6" in runs["crash"]["reason"]
    assert "this technique throws" in runs["throw"]["reason"]
    assert "time_limit_seconds" in runs["hang"]["reason"]
    assert runs["none"]["statistics"]["frames"] == 12
    # The frame that was timed must be the frame that is shown.
    checks = {check["name"]: check["passed"] for check in runs["lie"]["checks"]}
    assert checks["timed_frame_equals_replay"] is False
    checks = {check["name"]: check["passed"] for check in runs["none"]["checks"]}
    assert checks["timed_frame_equals_replay"] is True
    assert not list((volmark.results / "scenario" / "runs").glob("*/*.claim"))


def test_failed_runs_are_repeated_on_request_only(volmark):
    path = volmark.scenario(faults("none", "throw"))
    assert volmark("run", path, "--results", volmark.results).returncode == 1
    again = volmark("run", path, "--results", volmark.results)
    assert again.returncode == 0 and "2 done before" in again.stdout
    retried = volmark("run", path, "--results", volmark.results, "--retry", "failed")
    assert retried.returncode == 1 and "1 done before" in retried.stdout


def slow_grid(volmark, points):
    document = {"set": {**SMALL, "technique": {"name": "test_faults", "parameters": {"frame_ms": 5}}},
                "blocks": [{"axes": {"at": {"path": "technique.parameters.at", "values": [100 + i for i in range(points)]}}}]}
    document["set"]["measure"] = {"interleave": 2}
    return volmark.scenario(document)


def finished(volmark):
    """Files that mark completion; hidden folders are runs being written."""
    return {path: path.stat().st_mtime_ns for path in (volmark.results / "scenario" / "runs").glob("*/[!.]*/run.json")}


def hidden(volmark):
    """Claims and folders of runs that are not finished."""
    return [path for path in (volmark.results / "scenario" / "runs").glob("*/*")
            if path.name.endswith(".claim") or path.name.startswith(".")]


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_a_grid_stopped_half_way_resumes_without_loss_or_repeats(volmark, number):
    path = slow_grid(volmark, 8)
    process = volmark.start("run", path, "--results", volmark.results)
    deadline = time.time() + 120
    while len(finished(volmark)) < 3 and time.time() < deadline:
        time.sleep(0.02)
    process.send_signal(number)
    output, _ = process.communicate(timeout=30)
    if number != signal.SIGKILL:
        assert process.returncode == 130 and "goes on from here" in output
        assert not hidden(volmark)
    before = finished(volmark)
    assert 3 <= len(before) < 8
    for run in before:
        json.loads(run.read_text())

    resumed = volmark("run", path, "--results", volmark.results)
    assert resumed.returncode == 0, resumed.stderr
    after = finished(volmark)
    assert len(after) == 8
    assert all(after[run] == written for run, written in before.items())
    assert not hidden(volmark)


def test_two_processes_share_a_grid(volmark):
    path = slow_grid(volmark, 6)
    processes = [volmark.start("run", path, "--results", volmark.results) for _ in range(2)]
    outputs = [process.communicate(timeout=120) for process in processes]
    assert [process.returncode for process in processes] == [0, 0], outputs
    assert len(volmark.runs()) == 6


def test_what_another_process_did_since_the_start_is_not_done_again(volmark):
    path = slow_grid(volmark, 16)
    process = volmark.start("run", path, "--results", volmark.results)
    deadline = time.time() + 60
    while not finished(volmark) and time.time() < deadline:
        time.sleep(0.01)
    assert "1 completed" in volmark("run", path, "--points", "15", "--results", volmark.results).stdout
    output, _ = process.communicate(timeout=120)
    assert process.returncode == 0 and re.match("15 completed, 1 done before", output), output


def test_a_grown_grid_keeps_what_is_done(volmark):
    small = volmark("run", slow_grid(volmark, 2), "--results", volmark.results)
    assert "2 completed" in small.stdout
    grown = volmark("run", slow_grid(volmark, 3), "--results", volmark.results)
    assert "1 completed, 2 done before" in grown.stdout


def test_interleaved_turns_and_replicates(volmark):
    document = faults("none", frame_ms=1)
    document["blocks"] = [{"set": {"technique.name": "test_faults"}}, {"set": {"technique": {"name": "test_host_threads", "parameters": {}}}}]
    document["set"].pop("technique")
    document["set"]["measure"] = {"replicates": 2}
    result = volmark("run", volmark.scenario(document), "--results", volmark.results)
    assert result.returncode == 0, result.stderr
    runs = volmark.runs()
    assert len(runs) == 4
    assert len({run["group"] for run in runs.values()}) == 1
    assert len({run["point"] for run in runs.values()}) == 2
    assert len({run["run"] for run in runs.values()}) == 4


def test_timed_pacing_follows_the_clock(volmark):
    document = faults("none", frame_ms=2)
    document["set"]["pacing"] = {"mode": "timed", "warm_up_seconds": 0.2, "seconds": 1}
    result = volmark("run", volmark.scenario(document), "--results", volmark.results)
    assert result.returncode == 0, result.stderr
    (run,) = volmark.runs().values()
    statistics = run["statistics"]
    total = statistics["frames"] * statistics["host"]["mean_ms"]
    assert 900 < total < 1200


def test_plain_progress_and_summary_name_the_report(volmark):
    result = volmark("run", volmark.scenario(faults("none")), "--results", volmark.results)
    assert "1 completed" in result.stdout and "volmark_analysis report" in result.stdout
    assert "\r" not in result.stderr
