"""The Slurm script, run by hand, and by a Slurm of one node where slurmctld, slurmd and munge are installed."""

import json
import os
import secrets
import shutil
import signal
import socket
import subprocess
import tempfile
import time
from pathlib import Path

import pytest
from fake_grid import Grid
from volmark_analysis.__main__ import main

DAEMONS = ("munged", "slurmctld", "slurmd")


def made_script(grid, *more):
    script = grid.config.with_name("it's a grid.sh")
    assert main([*grid.arguments, "--slurm", str(script), *more]) == 0
    return script


def run_task(script, task):
    return subprocess.run(["bash", str(script)], env={**os.environ, "SLURM_ARRAY_TASK_ID": str(task)}, capture_output=True,
                          text=True, cwd="/")


def tasks_in(script):
    last = next(line for line in script.read_text().splitlines() if line.startswith("#SBATCH --array="))
    return int(last.rpartition("-")[2]) + 1


@pytest.mark.parametrize("tasks, expected", [(1000, 12), (5, 5)])
def test_the_tasks_of_the_array_make_every_point_once(tmp_path, tasks, expected):
    grid = Grid(tmp_path, seconds=0, replicates=1)
    script = made_script(grid, "--tasks", str(tasks))
    assert tasks_in(script) == expected
    for task in range(expected):
        done = run_task(script, task)
        assert done.returncode == 0, done.stderr
    grid.check_all_once(replicates=1)
    assert not grid.log("index")
    before = len(grid.log("begin"))
    assert run_task(script, 0).returncode == 0 and len(grid.log("begin")) == before  # again: nothing is left


def test_a_task_stays_on_few_volumes_and_keeps_comparisons_together(tmp_path):
    script = made_script(Grid(tmp_path), "--tasks", "3").read_text()
    tasks = [line.strip(' "') for line in script.split("tasks=(\n")[1].split("\n)")[0].splitlines()]
    assert tasks == ["0-1 2-3 4-5 6-7", "8-9 10-11 12-13 14-15", "16-17 18-19 20-21 22-23"]  # a volume each


def test_a_changed_scenario_is_refused(tmp_path):
    grid = Grid(tmp_path)
    script = made_script(grid)
    Grid(tmp_path, steps=[1, 2, 3, 5])
    done = run_task(script, 0)
    assert done.returncode == 2 and "make it again" in done.stderr and not grid.folder.exists()


def test_exit_codes_come_through_but_a_failed_run_ends_no_task(tmp_path):
    for code, begun in ((1, 22), (3, 2)):
        folder = tmp_path / str(code)
        folder.mkdir()
        grid = Grid(folder, seconds=0, replicates=1, fail={"2": code}, failures=99)
        assert run_task(made_script(grid, "--tasks", "1"), 0).returncode == code
        assert len(grid.log("begin")) == begun


def test_options_of_sbatch(tmp_path):
    lines = made_script(Grid(tmp_path)).read_text().splitlines()
    assert "#SBATCH --exclusive" in lines
    lines = made_script(Grid(tmp_path), "--sbatch=--gres=gpu:1", "--sbatch=--time=1:00:00").read_text().splitlines()
    assert "#SBATCH --gres=gpu:1" in lines and "#SBATCH --time=1:00:00" in lines and "#SBATCH --exclusive" not in lines


def test_a_script_that_cant_be_written_is_one_line(tmp_path, capsys):
    assert main([*Grid(tmp_path).arguments, "--slurm", str(tmp_path / "absent" / "x.sh")]) == 2
    said = capsys.readouterr().err
    assert "can't be written" in said and len(said.splitlines()) == 1


# A Slurm of one node --------------------------------------------------------------------------------------------


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.fixture
def slurm():
    """A controller, a node and munge in a folder of their own; gives the environment of their commands."""
    missing = [name for name in DAEMONS if shutil.which(name, path="/usr/sbin:/usr/bin") is None]
    if missing or os.getuid() != 0:
        pytest.skip(f"needs {', '.join(missing)} (slurmctld, slurmd, munge)" if missing else "needs root")
    folder = Path(tempfile.mkdtemp(prefix="slurm_"))  # short: the name of munge's socket is limited
    host = socket.gethostname()
    (folder / "key").write_bytes(secrets.token_bytes(1024))
    (folder / "key").chmod(0o600)
    for name in ("state", "spool"):
        (folder / name).mkdir()
    (folder / "slurm.conf").write_text("\n".join([
        "ClusterName=volmark", f"SlurmctldHost={host}(127.0.0.1)", "SlurmUser=root", "SlurmdUser=root",
        "AuthType=auth/munge", f"AuthInfo=socket={folder}/munge", "CryptoType=crypto/munge",
        f"SlurmctldPort={free_port()}", f"SlurmdPort={free_port()}", f"StateSaveLocation={folder}/state",
        f"SlurmdSpoolDir={folder}/spool", f"SlurmctldPidFile={folder}/slurmctld.pid", f"SlurmdPidFile={folder}/slurmd.pid",
        f"SlurmctldLogFile={folder}/slurmctld.log", f"SlurmdLogFile={folder}/slurmd.log", "ProctrackType=proctrack/pgid",
        "TaskPlugin=task/none", "SwitchType=switch/none", "MpiDefault=none", "ReturnToService=2",
        "SelectType=select/cons_tres", "SelectTypeParameters=CR_Core", "SchedulerParameters=batch_sched_delay=0,sched_interval=1",
        f"NodeName={host} NodeAddr=127.0.0.1 CPUs={os.cpu_count()} State=UNKNOWN",
        "PartitionName=all Nodes=ALL Default=YES State=UP MaxTime=INFINITE"]) + "\n")
    environment = {**os.environ, "SLURM_CONF": f"{folder}/slurm.conf", "PATH": f"/usr/sbin:{os.environ['PATH']}"}
    try:
        subprocess.run(["munged", f"--socket={folder}/munge", f"--key-file={folder}/key", f"--pid-file={folder}/munged.pid",
                        f"--log-file={folder}/munged.log", f"--seed-file={folder}/seed", "--force"], check=True)
        for daemon in ("slurmctld", "slurmd"):
            subprocess.run([daemon], env=environment, check=True)
        until(lambda: "idle" in said(environment, "sinfo", "-h", "-o", "%t"), "a node")
        yield environment
    finally:
        for name in reversed(DAEMONS):
            if (folder / f"{name}.pid").exists():
                os.kill(int((folder / f"{name}.pid").read_text()), signal.SIGKILL)
        shutil.rmtree(folder)


def said(environment, *command):
    return subprocess.run(command, env=environment, capture_output=True, text=True).stdout.strip()


def until(test, what):
    deadline = time.monotonic() + 60
    while not test():
        assert time.monotonic() < deadline, f"waited a minute for {what}"
        time.sleep(0.05)


def test_slurm_runs_the_script_and_goes_on_after_a_cancelled_task(tmp_path, slurm):
    grid = Grid(tmp_path, seconds=0.05)
    # One core: without its dependency the job with the index would run beside it.
    script = made_script(grid, "--tasks", "1", "--sbatch=--ntasks=1")
    first = said(slurm, "bash", str(script))
    assert first.startswith("array ")
    grid.wait_for("end", 3)
    subprocess.run(["scancel", "--signal=KILL", first.split()[1].rstrip(",")], env=slurm, check=True)
    until(lambda: not said(slurm, "squeue", "-h"), "the cancelled jobs")
    done = len(grid.log("end"))
    assert 3 <= done < 48
    assert said(slurm, "bash", str(script)).startswith("array ")
    until(lambda: not said(slurm, "squeue", "-h"), "all jobs")
    grid.check_all_once()
    # The second index, after all tasks of the second array.
    assert (grid.folder / "log").read_text().splitlines()[-1] == "index"
    assert (grid.folder.parent / "fake.slurm" / "0.log").exists()
    status = json.loads(said(slurm, grid.arguments[3], "status", str(grid.folder)))
    assert status["left"] == 0
