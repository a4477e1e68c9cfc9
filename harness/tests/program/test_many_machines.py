"""Grids and searches that Python hands out to workers, each with the program as its child."""

import contextlib
import csv
import io
import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import time

import pytest
from conftest import PROGRAM, SOURCE
from test_grid import finished, hidden, slow_grid

pytest.importorskip("distributed", reason="needs python3-distributed")


def start(volmark, *arguments):
    environment = {**volmark.environment, "PYTHONPATH": str(SOURCE / "analysis")}
    return subprocess.Popen([sys.executable, "-m", "volmark_analysis", *map(str, arguments), "--program", PROGRAM, "--results",
                             str(volmark.results)], cwd=volmark.folder, env=environment, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


def descendants(pid):
    """Process ids and command lines below a process."""
    found = {}
    try:
        children = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
        for task in pathlib.Path(f"/proc/{pid}/task").iterdir():
            children += (task / "children").read_text().split()
        for child in set(map(int, children)):
            found[child] = pathlib.Path(f"/proc/{child}/cmdline").read_text()
            found |= descendants(child)
    except OSError:
        pass
    return found


@pytest.mark.parametrize("victim", ["dask_worker", "--points"])
def test_killed_workers_and_programs_lose_and_repeat_nothing(volmark, victim):
    path, rng = slow_grid(volmark, 16), random.Random(3)
    process = start(volmark, "grid", path, "--workers", 2)
    kills, seen, deadline = 0, {}, time.time() + 120
    while process.poll() is None and time.time() < deadline:
        seen = finished(volmark) | seen  # the first time that each was seen
        alive = [pid for pid, command in descendants(process.pid).items() if victim in command and "setpriv" not in command]
        if kills < 3 and alive and len(seen) > 3 * kills:
            time.sleep(rng.uniform(0, 0.3))
            with contextlib.suppress(ProcessLookupError):  # it may just have ended
                os.kill(rng.choice(alive), signal.SIGKILL)
                kills += 1
        time.sleep(0.02)
    output, said = process.communicate(timeout=30)
    assert process.returncode == 0 and kills == 3, said
    assert "16 of 16 runs done" in output and said.count("handed out again") >= 1
    after = finished(volmark)
    assert len(after) == len(volmark.runs()) == 16  # every point once, all files readable
    assert all(after[run] == written for run, written in seen.items())
    assert not hidden(volmark)
    assert (volmark.results / "scenario" / "index.csv").exists()
    status = json.loads(volmark("status", volmark.results / "scenario", "--json").stdout)
    assert status["left"] == 0 and status["active"] == []


def test_an_interrupted_grid_leaves_nothing_half_made(volmark):
    path = slow_grid(volmark, 8)
    process = start(volmark, "grid", path)
    deadline = time.time() + 60
    while len(finished(volmark)) < 2 and time.time() < deadline:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 130 and "goes on from here" in said
    assert not hidden(volmark)
    before = finished(volmark)
    assert 2 <= len(before) < 8
    assert volmark("run", path, "--results", volmark.results).returncode == 0  # the program alone goes on as well
    after = finished(volmark)
    assert len(after) == 8 and all(after[run] == written for run, written in before.items())


def test_a_search_measures_the_best_points_most(volmark):
    document = {"scene": "marschner_lobb", "resolution": [32, 24], "pictures": {"count": 2, "reference": "none"},
                "pacing": {"mode": "frames", "frames": 6, "orbits": 2, "warm_up_frames": 3}}
    document["technique"] = {"name": "test_faults", "parameters": {}}
    path = volmark.scenario({"set": document, "blocks": [{"axes": {"ms": {
        "path": "technique.parameters.frame_ms", "values": [6, 1, 5, 2, 7, 3, 8, 4, 9]}}}]})
    process = start(volmark, "halve", path, "--replicates", 4, "--eta", 2, "--format", "csv")
    output, said = process.communicate(timeout=120)
    assert process.returncode == 0, said
    rows = list(csv.DictReader(io.StringIO(output)))
    assert rows[0]["ms"] == "1" and rows[0]["rank"] == "best" and rows[0]["replicates"] == "4"
    assert all(float(r["low_ms"]) <= float(rows[0]["high_ms"]) for r in rows[1:])
    replicates = {}
    for labels in volmark.runs():
        replicates[int(labels[1])] = max(replicates.get(int(labels[1]), 0), labels[2] + 1)
    assert sorted(replicates) == list(range(1, 10))
    assert sorted(replicates.values()) == [1] * 4 + [2] * 2 + [4] * 3  # 9 points, 5 of them twice, 3 of them four times
    assert all(replicates[ms] == 4 for ms in (1, 2))
    assert "20 runs; the full grid with 4 processes per point has 36" in said.replace("\n", " ")
    before = finished(volmark)
    again = start(volmark, "halve", path, "--replicates", 4, "--eta", 2, "--format", "csv").communicate(timeout=120)[0]
    assert list(csv.DictReader(io.StringIO(again)))[0]["ms"] == "1" and finished(volmark) == before  # nothing is run again
