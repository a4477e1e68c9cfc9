"""Grids that Python hands out to workers, each with the program as its child."""

import contextlib
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
