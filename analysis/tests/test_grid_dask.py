"""Grids on real Dask workers, with a stand-in for the volmark program whose runs sleep. Real runs: harness/tests/program."""

import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from fake_grid import Grid
from volmark_analysis.__main__ import main

pytest.importorskip("distributed", reason="needs python3-distributed")

def workers_of(process):
    """Process ids of its workers."""
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
    return [int(pid) for pid in children if "dask_worker" in Path(f"/proc/{pid}/cmdline").read_text()]


def living_in_groups(groups):
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[2]) in groups and fields[0] != "Z":
            found.append(path.parent.name)
    return found


def test_two_workers_share_a_grid(tmp_path, capsys):
    grid = Grid(tmp_path)
    assert main([*grid.arguments, "--workers", "2"]) == 0
    assert "48 of 48 runs done" in capsys.readouterr().out
    grid.check_all_once()
    assert len(grid.check_one_at_a_time()) == 2
    assert len(grid.log("index")) == 1
    # Both techniques of a comparison are in one batch, hence on one worker.
    worker_of = {int(point): group for point, _, group, _, _ in grid.log("end")}
    assert all(worker_of[i] == worker_of[i + 1] for i in range(0, 24, 2))


def test_killed_workers_lose_and_repeat_nothing(tmp_path):
    grid, rng = Grid(tmp_path, seconds=0.3, replicates=1), random.Random(5)
    process = grid.start("--workers", "2")
    killed = {}
    for kill in range(3):
        grid.wait_for("begin", 3 + 5 * kill)
        time.sleep(rng.uniform(0, 0.1))
        worker = rng.choice(workers_of(process))
        os.kill(worker, signal.SIGKILL)
        killed[str(worker)] = time.time()
    _, said = process.communicate(timeout=60)
    assert process.returncode == 0, said
    assert said.count("ended (signal 9): started again") == 3
    grid.check_all_once(replicates=1)
    grid.check_one_at_a_time()
    # No program goes on beside the worker that takes over.
    assert all(float(end) < killed.get(group, float("inf")) + 0.1 for _, _, group, _, end in grid.log("end"))


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_stopped_grid_goes_on(tmp_path, capsys, number):
    grid = Grid(tmp_path)
    process = grid.start()
    grid.wait_for("end", 5)
    workers = workers_of(process)
    process.send_signal(number)
    _, said = process.communicate(timeout=40)
    if number != signal.SIGKILL:
        assert process.returncode == 130 and "goes on from here" in said
    deadline = time.monotonic() + 2
    while living_in_groups(set(workers)) and time.monotonic() < deadline:
        time.sleep(0.01)
    assert workers and not living_in_groups(set(workers))
    done = len(grid.log("end"))
    assert 5 <= done < 48
    assert main(grid.arguments) == 0, capsys.readouterr().err
    grid.check_all_once()


def test_workers_of_a_scheduler(tmp_path, capsys):
    grid = Grid(tmp_path)
    import distributed
    with distributed.LocalCluster(n_workers=0, host="127.0.0.1", dashboard_address=None) as cluster:
        command = [sys.executable, "-m", "distributed.cli.dask_worker", cluster.scheduler_address, "--no-nanny", "--nthreads",
                   "1", "--no-dashboard", "--local-directory", str(tmp_path)]
        # They need no copy of this package, and one without the resource gets nothing.
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        workers = [subprocess.Popen([*command, *more], cwd=tmp_path, env=environment, stdout=subprocess.DEVNULL,
                                    stderr=subprocess.DEVNULL, start_new_session=True)
                   for more in (["--resources", "GPU=1"], ["--resources", "GPU=1"], [])]
        try:
            assert main([*grid.arguments, "--scheduler", cluster.scheduler_address]) == 0
        finally:
            for worker in workers:
                worker.terminate()
                worker.wait(20)
    grid.check_all_once()
    used = grid.check_one_at_a_time()
    assert str(workers[2].pid) not in used and used <= {str(w.pid) for w in workers}
    assert "report:" in capsys.readouterr().out


def test_failures_are_bounded_and_told(tmp_path, capsys):
    grid = Grid(tmp_path, fail={"3": 3, "9": 139}, failures=4, seconds=0.01, replicates=1)
    assert main(grid.arguments) == 1
    captured = capsys.readouterr()
    assert captured.err.count("handed out again") == 6
    assert "given up: points 2, 3: exit code 3" in captured.err and "made to fail" in captured.err
    assert "20 of 24 runs done" in captured.out
    assert main(grid.arguments) == 0  # the fifth time goes well
    grid.check_all_once(replicates=1)


def test_a_program_that_runs_nowhere_is_told(tmp_path, capsys):
    grid = Grid(tmp_path)
    refuses = tmp_path / "refuses"
    refuses.write_text(f'#!/bin/sh\n[ "$1" = run ] && {{ echo no device here >&2; exit 3; }}\nexec {grid.arguments[3]} "$@"\n')
    refuses.chmod(0o755)
    assert main([*grid.arguments, "--program", str(refuses)]) == 1
    captured = capsys.readouterr()
    assert "nothing was run" in captured.out and captured.err.count("  given up: ") == 10 and "2 more batches" in captured.err
    assert "no device here" in captured.err


def test_bad_input_is_one_line(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("volmark_analysis.grid.dask_workers._SECONDS_TO_CONNECT", 1)
    grid = Grid(tmp_path)
    for more, text in ([["--set", "nonsense=1"], "no setting nonsense"], [["--program", "/nowhere"], "--program: /nowhere"],
                       [["--scheduler", "tcp://127.0.0.1:9"], "--scheduler: tcp://127.0.0.1:9"]):
        assert main([*grid.arguments, *more]) == 2
        said = capsys.readouterr().err
        assert text in said and len(said.splitlines()) == 1
    assert main(["grid", str(tmp_path / "absent.json")]) == 2
    assert not grid.folder.exists()


def test_without_dask_the_package_is_named(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main(Grid(tmp_path).arguments) == 2
    said = capsys.readouterr().err
    assert re.search(r"python3-distributed.*--slurm", said) and len(said.splitlines()) == 1
