"""What goes wrong around a grid: full and read-only disks, damaged files, modules of another SDK, kills at any moment."""

import json
import os
import pathlib
import random
import shutil
import signal
import subprocess
import threading
import time

import pytest
from conftest import BUILD, SMALL
from test_grid import faults, finished, hidden

KILLS = int(os.environ.get("VOLMARK_KILLS", "8"))


def run(volmark, path, *options):
    return volmark("run", path, "--results", volmark.results, *options)


def host_grid(volmark, points, **measure):
    """Runs of a technique that draws at once: most of their time is files and processes."""
    document = {"set": {**SMALL, "technique": {"name": "test_host_threads", "parameters": {}}, "measure": measure},
                "blocks": [{"axes": {"view": {"path": "timeline.start_azimuth_degrees",
                                 "values": [i / 8 for i in range(points)]}}}]}
    document["set"]["volume.generator.dims"] = [16, 16, 16]
    return volmark.scenario(document)


@pytest.fixture
def small_disk(volmark):
    """The results folder as a file system of its own, which can be made smaller, larger and read-only."""
    volmark.results.mkdir()
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64m", "volmark_test", volmark.results],
                          capture_output=True, text=True)
    if done.returncode != 0:
        pytest.skip(f"no file system can be mounted here: {done.stderr.strip()}")

    def remount(options):
        subprocess.run(["mount", "-o", f"remount,{options}", volmark.results], check=True)

    yield remount
    subprocess.run(["umount", "-l", volmark.results], check=True)


def assert_whole(volmark):
    """Whatever is there under a final name can be read, and nothing is half-written."""
    for path in finished(volmark):
        document = json.loads(path.read_text())
        for name in ("frames", "counters", "pictures"):
            lines = (path.parent / f"{name}.csv").read_text().splitlines()
            assert lines[0] == f"# volmark.{name} 1"
            assert len({line.count(",") for line in lines[1:] if '"' not in line}) == 1, "a row was cut off"
        for picture in document.get("pictures") or []:
            content = (path.parent / picture["file"]).read_bytes()
            assert content[:4] == b"\x76\x2f\x31\x01" and len(content) > 100


def test_a_full_disk_ends_the_grid_with_one_line_and_it_resumes(volmark, small_disk):
    path = host_grid(volmark, 6, interleave=1)
    filler = volmark.results / "filler"
    (volmark.results / "scenario").mkdir()
    filler.write_bytes(bytes((64 << 20) - (60 << 10)))  # room for experiment.json and about two runs
    result = run(volmark, path)
    assert result.returncode == 3, result.stdout
    assert "No space left on device" in result.stderr.splitlines()[-1]
    assert_whole(volmark)
    done = finished(volmark)
    assert len(done) < 6
    filler.unlink()
    result = run(volmark, path)
    assert result.returncode == 0, result.stderr
    assert len(finished(volmark)) == 6 and not hidden(volmark)
    assert all(finished(volmark)[file] == written for file, written in done.items())
    assert_whole(volmark)


def test_results_that_become_read_only_end_the_grid_and_it_resumes(volmark, small_disk):
    document = faults("none", frame_ms=4)
    document["blocks"][0]["axes"]["view"] = {"path": "timeline.elevation_degrees", "values": list(range(8))}
    document["set"]["measure"] = {"interleave": 1}
    path = volmark.scenario(document)
    process = volmark.start("run", path, "--results", volmark.results)
    deadline = time.time() + 60
    while len(finished(volmark)) < 2 and time.time() < deadline:
        time.sleep(0.01)
    for attempt in range(200):  # refused while a file is being written
        if subprocess.run(["mount", "-o", "remount,ro", volmark.results], capture_output=True).returncode == 0:
            break
        time.sleep(0.005)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 3
    assert "Read-only file system" in errors.splitlines()[-1]
    assert_whole(volmark)
    small_disk("rw")
    assert run(volmark, path).returncode == 0
    assert len(finished(volmark)) == 8 and not hidden(volmark)


@pytest.mark.parametrize("damage", ["", "{", '{"format": "volmark.run"', "\0\0\0\0", "[]"])
def test_a_damaged_run_is_done_again(volmark, damage):
    path = host_grid(volmark, 3)
    assert run(volmark, path).returncode == 0
    victim, *others = finished(volmark).items()
    victim[0].write_text(damage)
    result = run(volmark, path)
    assert result.returncode == 0 and "1 completed, 2 done before" in result.stdout
    assert json.loads(victim[0].read_text())["status"] == "completed"
    assert all(finished(volmark)[file] == written for file, written in others)


def test_a_module_of_another_sdk_is_named_and_costs_nobody_else(volmark):
    modules = volmark.folder / "modules"
    modules.mkdir()
    (other,) = (BUILD / "harness" / "tests" / "technique" / "modules" / "sdk_version").glob("*.so")
    shutil.copy(other, modules)
    shutil.copy(BUILD / "tests" / "techniques" / "test_techniques.so", modules)
    volmark.environment["VOLMARK_TECHNIQUES"] = str(modules)
    result = run(volmark, host_grid(volmark, 1))
    assert result.returncode == 0, result.stderr
    assert other.name in result.stderr and "0.0.9" in result.stderr


def test_a_missing_module_is_one_line(volmark):
    volmark.environment["VOLMARK_TECHNIQUES"] = str(volmark.folder)
    result = run(volmark, host_grid(volmark, 1))
    assert result.returncode == 2 and "test_host_threads" in result.stderr
    assert not volmark.results.exists()


@pytest.mark.parametrize("name", ["../out", "a/../../out", "/out", "..", ".hidden", "a/b", "$(touch out)", "`touch out`",
                                  "out;touch out", "a\\b", "a\nb", ""])
def test_a_config_names_no_other_folder(volmark, name):
    path = volmark.folder / "config.json"
    path.write_text(json.dumps({"volmark": 1, "name": name, "set": {**SMALL, "technique": {"name": "test_host_threads"}}}))
    result = run(volmark, path)
    assert result.returncode == 2 and "/name: " in result.stderr and result.stderr.count("\n") == 1
    assert sorted(entry.name for entry in volmark.folder.iterdir()) == ["config.json"]


def test_texts_of_a_config_write_nothing_outside_the_results(volmark):
    evil = "../../../out $(touch out) `touch out` ; touch out | touch out"
    document = {"title": evil, "description": evil,
                "set": {**SMALL, "technique": {"name": "test_host_threads", "parameters": {}}},
                "blocks": [{"axes": {"case": {"values": [{"label": evil, "set": {}}, {"label": "../" * 20, "set": {}}]}}}]}
    assert run(volmark, volmark.scenario(document)).returncode == 0
    assert sorted(entry.name for entry in volmark.folder.iterdir()) == ["results", "scenario.json"]
    assert sorted(entry.name for entry in volmark.results.iterdir()) == ["scenario"]


def workers_of(process):
    children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
    try:
        return [int(pid) for pid in children.read_text().split()]
    except OSError:
        return []


def test_kills_at_any_moment_lose_and_repeat_nothing(volmark):
    """VOLMARK_KILLS=200 is the long form. Runners, workers or both, alone or two at a time on one grid."""
    source = random.Random(4)
    points = 3 * KILLS + 12
    paths = {kind: host_grid(volmark, points, interleave=3, isolation=kind) for kind in ("run", "volume")}
    environment = dict(volmark.environment)
    written = {}
    kills = {"runner": 0, "worker": 0}
    while sum(kills.values()) < KILLS:
        volmark.environment = environment
        processes = [volmark.start("run", paths[source.choice(("run", "volume"))], "--results", volmark.results,
                                   "--no-index") for _ in range(source.choice((1, 1, 2)))]
        for process in processes:  # nobody reads them otherwise
            for stream in (process.stdout, process.stderr):
                threading.Thread(target=stream.read, daemon=True).start()
        while any(process.poll() is None for process in processes) and sum(kills.values()) < KILLS:
            time.sleep(source.uniform(0.02, 1.2))
            victim = source.choice(processes)
            workers = workers_of(victim)
            if workers and source.random() < 0.3:
                os.kill(source.choice(workers), signal.SIGKILL)
                kills["worker"] += 1
            elif victim.poll() is None:
                victim.kill()
                victim.wait()
                kills["runner"] += 1
            now = finished(volmark)
            assert all(now.get(file) == stamp for file, stamp in written.items()), "a finished run was touched"
            written = now
        for process in processes:
            process.kill()
            assert process.wait() in (0, 1, -signal.SIGKILL)
        if len(written) == points:
            points *= 2  # faster than it was killed: more to do
            paths = {kind: host_grid(volmark, points, interleave=3, isolation=kind) for kind in ("run", "volume")}
    time.sleep(0.3)  # workers whose runner was killed end too
    assert run(volmark, paths["run"]).returncode in (0, 1)
    assert all(finished(volmark)[file] == stamp for file, stamp in written.items())
    assert run(volmark, paths["run"], "--retry", "failed").returncode == 0
    runs = volmark.runs()
    assert len(runs) == len(finished(volmark)) == points, kills
    assert {document["status"] for document in runs.values()} == {"completed"}
    assert not hidden(volmark)
    assert_whole(volmark)
    index = (volmark.results / "scenario" / "index.csv").read_text().splitlines()
    assert len(index) == 2 + points
