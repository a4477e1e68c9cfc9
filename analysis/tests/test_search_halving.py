"""Successive halving, with measuring made up: harness/tests/program has it with the real program."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from made_points import made_point, noisy
from test_grid_batches import Stream
from volmark_analysis.errors import InputError
from volmark_analysis.grid.job import Job, PlannedPoint
from volmark_analysis.grid.progress import Progress
from volmark_analysis.search import halving
from volmark_analysis.search.candidates import Limit
from volmark_analysis.search.halving import Question, halve, rungs_of


@pytest.mark.parametrize("eta", [2, 3, 4])
@pytest.mark.parametrize("replicates", [1, 2, 5, 9, 20])
def test_rungs_grow_by_eta_up_to_the_most(eta, replicates):
    rungs = rungs_of(eta, replicates)
    assert rungs[0] == 1 and rungs[-1] == replicates
    assert all(a < b <= eta * a for a, b in zip(rungs, rungs[1:]))
    assert all(b == eta * a for a, b in zip(rungs[:-2], rungs[1:-1]))


class Grid:
    """Points of several scenes with known times; each process of a point draws its own noise."""

    def __init__(self, monkeypatch, seed=1, scenes=2, count=25, noise=0.05, device=lambda i: "gpu"):
        rng = np.random.default_rng(seed)
        self.ms = {i: rng.uniform(5, 15) for i in range(scenes * count)}
        self.psnr = {i: rng.uniform(30, 50) for i in self.ms}
        self.scene = {i: f"scene {i // count}" for i in self.ms}
        self.processes = {i: noisy(rng, ms, 9, between=noise) for i, ms in self.ms.items()}
        self.device = device
        self.measured, self.rungs = {}, []
        planned = [PlannedPoint(i, {}, str(i), {"scene": self.scene[i], "measure": {"interleave": 1}}) for i in self.ms]
        monkeypatch.setattr(Job, "points", lambda job: planned)
        monkeypatch.setattr(Job, "folder", Path("/results/grid"))
        monkeypatch.setattr(Job, "has_begun", True)
        monkeypatch.setattr(halving, "hand_out", self.hand_out)
        monkeypatch.setattr(halving, "load_experiment", lambda folder: SimpleNamespace(folder=folder))
        monkeypatch.setattr(halving, "point_results", lambda experiment: [self.result(i) for i in self.measured])

    def hand_out(self, workers, job, batches, progress):
        count = int(job.scenario_options[-1].removeprefix("measure.replicates="))
        points = {i for batch in batches for i in batch.points}
        self.rungs.append((count, points))
        for i in points:
            self.measured[i] = max(self.measured.get(i, 0), count)
        return []

    def result(self, i):
        return made_point(i, self.processes[i][:self.measured[i]], (self.psnr[i],), labels={"scene": self.scene[i]},
                          device=self.device(i))

    def halve(self, limits=(), eta=3, replicates=9, per=("scene",)):
        self.said = Stream()
        job = Job(Path("/volmark"), Path("/x.json"), Path("/results"), (), ())
        return halve(None, job, Question("median_ms", list(per), list(limits)), eta, replicates, Progress(self.said))


@pytest.mark.parametrize("seed", range(5))
def test_each_rung_keeps_the_best_share_of_each_scene(monkeypatch, seed):
    grid = Grid(monkeypatch, seed)
    halved = grid.halve()
    assert [(count, len(points)) for count, points in grid.rungs] == [(1, 50), (3, 18), (9, 6)]
    for scene in ("scene 0", "scene 1"):
        for (count, points), (_, kept) in zip(grid.rungs, grid.rungs[1:]):
            def time(i, n=count):
                return np.median(np.concatenate([o for orbits in grid.processes[i][:n] for o in orbits]))
            mine = sorted((i for i in points if grid.scene[i] == scene), key=time)
            assert [i for i in mine if i in kept] == mine[:-(-len(mine) // 3)]
    assert halved.runs == sum(grid.measured.values()) == 50 + 18 * 2 + 6 * 6 and halved.full_runs == 50 * 9
    assert {r.point_index for c in halved.contests for r in c.points} == grid.rungs[-1][1]
    assert sum("rung" in text for text in grid.said) == 3


def test_it_finds_the_best_when_the_noise_is_smaller_than_the_difference(monkeypatch):
    for seed in range(5):
        with monkeypatch.context() as patch:
            grid = Grid(patch, seed, scenes=1, noise=0.0005)
            halved = grid.halve()
            order = sorted(grid.ms, key=grid.ms.get)
            if grid.ms[order[1]] > 1.02 * grid.ms[order[0]]:
                best = min(halved.contests[0].points, key=lambda r: r.statistics["median_ms"])
                assert best.point_index == order[0]


def test_points_outside_the_limits_are_not_measured_again(monkeypatch):
    grid = Grid(monkeypatch)
    halved = grid.halve([Limit("psnr_db", 40.0)])
    allowed = {i for i, psnr in grid.psnr.items() if psnr >= 40}
    assert grid.rungs[1][1] <= allowed and len(grid.rungs[1][1]) < 18
    assert {r.point_index for c in halved.contests for r in c.points} <= allowed


def test_nothing_within_the_limits_is_said(monkeypatch):
    grid = Grid(monkeypatch)
    with pytest.raises(InputError, match="no point is left.*25 outside psnr_db at least 60"):
        grid.halve([Limit("psnr_db", 60.0)])
    assert len(grid.rungs) == 1


def test_times_of_several_devices_are_refused(monkeypatch):
    grid = Grid(monkeypatch, device=lambda i: f"gpu {i % 2}")
    with pytest.raises(InputError, match="gpu 0, gpu 1: times of different devices can't be compared"):
        grid.halve()


def test_one_process_at_most_is_one_rung(monkeypatch):
    grid = Grid(monkeypatch)
    grid.halve(replicates=1)
    assert [count for count, _ in grid.rungs] == [1]
