"""Parts of a grid, and what is told about it from outside."""

import json
import signal
import time

import pytest
from test_grid import faults, slow_grid


def status(volmark, name="scenario"):
    result = volmark("status", volmark.results / name, "--json")
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def run(volmark, path, *options):
    return volmark("run", path, "--results", volmark.results, *options)


def test_chosen_points_are_run_and_all_are_counted(volmark):
    path = slow_grid(volmark, 6)
    assert run(volmark, path, "--points", "1,3-4", "--no-index").returncode == 0
    assert {int(key[1]) for key in volmark.runs()} == {101, 103, 104}
    assert not (volmark.results / "scenario" / "index.csv").exists()
    now = status(volmark)
    assert (now["planned"], now["completed"], now["left"], now["running"]) == (6, 3, 3, 0)
    assert now["left_points"] == [0, 2, 5] and now["seconds_left"] > 0

    assert volmark("index", volmark.results / "scenario").returncode == 0
    rows = (volmark.results / "scenario" / "index.csv").read_text().splitlines()
    assert len(rows) == 2 + 3
    assert run(volmark, path).returncode == 0
    now = status(volmark)
    assert (now["completed"], now["left"], now["left_points"], now["seconds_left"]) == (6, 0, [], 0)
    assert volmark("index", f"{volmark.results}/scenario/").returncode == 0
    google = json.loads((volmark.results / "scenario" / "google_benchmark.json").read_text())
    assert all(row["name"].startswith("scenario/") for row in google["benchmarks"])


@pytest.mark.parametrize("text", ["", "6", "2-1", "-1", "1,,2", "x", "0-6", "1;2"])
def test_points_that_are_not_there_are_one_line(volmark, text):
    result = run(volmark, slow_grid(volmark, 6), f"--points={text}")
    if text == "":
        return  # CLI11 takes an empty value as none
    assert result.returncode == 2 and "--points: found" in result.stderr and "numbers and ranges of 0 to 5" in result.stderr
    assert not volmark.results.exists()


def test_failures_replicates_and_growth_are_counted(volmark):
    document = faults("none", "throw", "unsupported")
    document["set"]["measure"] = {"replicates": 2}
    assert run(volmark, volmark.scenario(document)).returncode == 1
    now = status(volmark)
    assert (now["planned"], now["completed"], now["failed"], now["unsupported"], now["left"]) == (6, 2, 2, 2, 0)
    assert "2 failed" in volmark("status", volmark.results / "scenario").stdout


def test_a_grid_at_work_is_told_from_one_that_died(volmark):
    path = slow_grid(volmark, 8)
    process = volmark.start("run", path, "--results", volmark.results)
    deadline = time.time() + 60
    while time.time() < deadline:
        if list((volmark.results / "scenario" / "runs").glob("*/*.claim")):
            now = status(volmark)
            if now["running"]:
                break
        time.sleep(0.05)
    assert now["active"][0]["pid"] == process.pid and now["active"][0]["runs"] >= 1
    assert now["completed"] + now["running"] + now["left"] == 8
    process.send_signal(signal.SIGKILL)
    process.wait()
    now = status(volmark)
    assert now["running"] == 0 and now["active"] == []
    assert now["completed"] + now["left"] == 8


def test_what_is_no_experiment_is_one_line(volmark):
    for command in ("status", "index"):
        result = volmark(command, volmark.folder)
        assert result.returncode == 2 and "found no experiment.json" in result.stderr
    (volmark.folder / "experiment.json").write_text('{"format": "volmark.experiment", "version": 7}')
    result = volmark("status", volmark.folder)
    assert result.returncode == 2 and "/version: found 7, allowed: 1" in result.stderr
