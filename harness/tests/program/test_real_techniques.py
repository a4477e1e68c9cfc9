"""The two ray marchers through the whole chain, with the validation layers on, and what others read of it."""

import json
import math
import pathlib
import subprocess
import sys

import numpy
import pandas
import pytest
from conftest import SMALL

COMPARE = pathlib.Path("/usr/share/benchmark/compare.py")


@pytest.fixture(scope="module")
def experiment(tmp_path_factory):
    from conftest import Volmark
    volmark = Volmark(tmp_path_factory.mktemp("real"))
    document = {
        "set": {**SMALL, "scene": "nested_ellipsoids", "resolution": [64, 64], "pictures": {"count": 2, "reference": "cpu"}},
        "blocks": [{"set": {"technique.name": name, "technique.parameters.filtering": "shader"}, "axes": {"step": {"path": "technique.parameters.step", "values": [0.5, 1]}}}
                   for name in ("iso_raymarch", "dvr_raymarch")]}
    result = volmark("run", volmark.scenario(document), "--results", volmark.results, "--validate")
    assert result.returncode == 0, result.stderr
    return volmark


def frames_of(experiment, run):
    folder = experiment.results / "scenario" / "runs" / run["run"][:2] / run["run"]
    return pandas.read_csv(folder / "frames.csv", comment="#"), folder


def test_every_check_passes(experiment):
    runs = experiment.runs()
    assert len(runs) == 4
    for run in runs.values():
        assert run["status"] == "completed", run["reason"]
        checks = {check["name"]: check for check in run["checks"]}
        assert {"timed_frame_equals_replay", "memory_equals_ledger", "validation"} <= set(checks)
        assert all(check["passed"] for check in checks.values()), checks


def test_errors_stand_beside_the_times(experiment):
    for run in experiment.runs().values():
        assert run["pictures"]
        for picture in run["pictures"]:
            assert picture["reference"] == "cpu" and picture["psnr_db"] > 30, picture
        if run["technique"]["draws"] == "isosurface":
            for picture in run["pictures"]:
                assert picture["depth_p995_voxels"] < 0.05, picture
                assert picture["missed_share"] + picture["spurious_share"] < 0.002, picture


def test_statistics_equal_numpy(experiment):
    for run in experiment.runs().values():
        frames, _ = frames_of(experiment, run)
        ms = frames[frames.orbit_kind == "headline"].frame_ms.to_numpy()
        said = run["statistics"]["frame"]
        slowest = numpy.sort(ms)[::-1]
        covered = numpy.searchsorted(numpy.cumsum(slowest), 0.01 * ms.sum())
        for name, value in {
            "mean_ms": ms.mean(), "median_ms": numpy.median(ms), "p99_ms": numpy.percentile(ms, 99),
            "low1_avg_ms": slowest[:math.ceil(len(ms) / 100)].mean(), "low1_integral_ms": slowest[covered],
            "fps": 1000 / ms.mean(), "clock_mean_ms": 1 / (1 / ms).mean()}.items():
            assert said[name] == pytest.approx(value, rel=1e-9), name


def test_frames_are_complete(experiment):
    for run in experiment.runs().values():
        frames, folder = frames_of(experiment, run)
        assert (frames.orbit_kind == "headline").sum() == 12
        for kind in ("headline", "breakdown"):
            for _, orbit in frames[frames.orbit_kind == kind].groupby("orbit"):
                assert list(orbit.frame) == list(range(6))
                assert numpy.allclose(orbit.phase, numpy.arange(6) / 6)
        headline = frames[frames.orbit_kind == "headline"]
        assert headline.gpu_ms.notna().all() and (headline.host_ms >= headline.gpu_ms * 0.9).all()
        assert frames[frames.orbit_kind == "breakdown"]["pass.march"].notna().all()
        assert numpy.allclose(headline.frame_ms, headline.update_ms + headline.draw_ms)
        counters = pandas.read_csv(folder / "counters.csv", comment="#")
        assert len(counters) == 6 and (counters.samples > 0).all()


def test_every_format_carries_its_version(experiment):
    folder = experiment.results / "scenario"
    assert json.loads((folder / "experiment.json").read_text())["version"] == 1
    for path in folder.rglob("*.csv"):
        assert path.read_text().startswith("# volmark."), path
    for path in folder.rglob("run.json"):
        assert json.loads(path.read_text())["version"] == 1


@pytest.mark.skipif(not COMPARE.exists(), reason="Google Benchmark's compare.py is not installed")
def test_google_benchmarks_own_tool_reads_it(experiment):
    path = experiment.results / "scenario" / "google_benchmark.json"
    result = subprocess.run([sys.executable, COMPARE, "benchmarks", path, path], capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    assert "iso_raymarch" in result.stdout


def test_report(experiment):
    result = subprocess.run([sys.executable, "-m", "volmark_analysis", "report", experiment.results / "scenario"],
                            capture_output=True, text=True)
    assert result.returncode == 0, result.stderr
    text = (experiment.results / "scenario" / "report.html").read_text()
    assert "iso_raymarch" in text and "dvr_raymarch" in text and "data:image/png" in text
