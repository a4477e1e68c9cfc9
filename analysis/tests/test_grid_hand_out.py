"""The loop that hands out batches, without Dask: workers that do what a test says."""

import random
from dataclasses import dataclass
from pathlib import Path

import pytest
from test_grid_batches import Stream, batch
from volmark_analysis.errors import InputError
from volmark_analysis.grid.hand_out import hand_out
from volmark_analysis.grid.job import Job
from volmark_analysis.grid.progress import Progress

JOB = Job(Path("/volmark"), Path("/scenario.json"), Path("/results"), (), ())

KILLED = "killed"


@dataclass(eq=False)
class Future:
    points: str
    worker: str


class FakeWorkers:
    """`do(points, worker)` gives the exit code of a batch, or KILLED if the worker dies of it and another one comes."""

    hopeless = False

    def __init__(self, workers, do, rng=None):
        self.workers, self.do, self.rng = set(workers), do, rng or random.Random(1)
        self.asked, self.cancelled, self.most = [], [], 0

    def present(self):
        return set(self.workers)

    def tend(self, progress):
        pass

    def submit(self, command, worker):
        assert command[:2] == ["/volmark", "run"] and command[-2] == "--points" and "--no-index" in command
        self.asked.append((command[-1], worker))
        return Future(command[-1], worker)

    def wait(self, futures, seconds):
        self.most = max(self.most, len(futures))
        assert len({f.worker for f in futures}) == len(futures)  # one thing at a time
        if not futures:
            return []
        future = self.rng.choice(futures)
        code = self.do(future.points, future.worker)
        if code == KILLED:
            self.workers.remove(future.worker)
            self.workers.add(future.worker + "'")
            return []
        return [(future, {"exit": code, "said": "what it said", "seconds": 0.1})]

    def cancel(self, futures):
        self.cancelled += futures


def batches(count=12):
    return [batch(i, f"volume {i % 3}") for i in range(count)]


def run(workers, chosen=None):
    stream = Stream()
    progress = Progress(stream)
    progress.start(12)
    return hand_out(workers, JOB, chosen or batches(), progress), "".join(stream)


@pytest.mark.parametrize("seed", range(10))
def test_every_batch_is_handed_out_once(seed):
    workers = FakeWorkers({"a", "b", "c"}, lambda points, worker: 0, random.Random(seed))
    lost, _ = run(workers)
    assert sorted(int(points) for points, _ in workers.asked) == list(range(12)) and not lost
    assert workers.most == 3


def test_a_failed_run_is_a_result():
    workers = FakeWorkers({"a"}, lambda points, worker: 1)
    lost, _ = run(workers)
    assert len(workers.asked) == 12 and not lost


def test_what_fails_is_tried_elsewhere_and_at_last_given_up():
    workers = FakeWorkers({"a", "b"}, lambda points, worker: 3 if points == "5" else 0)
    lost, said = run(workers)
    tried = [worker for points, worker in workers.asked if points == "5"]
    assert len(tried) == 4 and set(tried) == {"a", "b"}
    assert [entry.batch.points for entry in lost] == [(5,)] and "exit code 3" in lost[0].reason
    assert "what it said" in lost[0].reason and "handed out again" in said and "given up" in said
    assert len(workers.asked) == 11 + 4


def test_one_batch_that_fails_costs_no_other():
    lost, _ = run(FakeWorkers({"only"}, lambda points, worker: 3 if points == "5" else 0))
    assert [entry.batch.points for entry in lost] == [(5,)]


def test_a_worker_that_can_run_nothing_loses_nothing():
    workers = FakeWorkers({"broken", "good"}, lambda points, worker: 127 if worker == "broken" else 0)
    lost, _ = run(workers)
    assert not lost and sum(worker == "broken" for _, worker in workers.asked) == 3


def test_without_a_worker_that_can_run_anything_all_is_given_up():
    lost, _ = run(FakeWorkers({"broken"}, lambda points, worker: 127))
    assert len(lost) == 12
    dead = FakeWorkers(set(), lambda points, worker: 0)
    dead.hopeless = True
    lost, _ = run(dead)
    assert len(lost) == 12 and "no worker is left" in lost[0].reason


def test_what_kills_every_worker_is_given_up():
    workers = FakeWorkers({"a", "b"}, lambda points, worker: KILLED if points == "7" else 0)
    lost, said = run(workers)
    assert [entry.batch.points for entry in lost] == [(7,)] and len(workers.asked) == 11 + 4
    assert "is gone: handed out again" in said and len(workers.cancelled) == 4


@pytest.mark.parametrize("seed", range(10))
def test_killed_workers_lose_no_batch(seed):
    rng, killed = random.Random(seed), []

    def do(points, worker):
        if rng.random() < 0.3 and killed.count(points) < 3:
            killed.append(points)
            return KILLED
        return 0

    workers = FakeWorkers({"a", "b"}, do, rng)
    lost, _ = run(workers)
    assert not lost and sorted(points for points, _ in workers.asked) == sorted([str(i) for i in range(12)] + killed)


def test_what_dask_gives_up_is_tried_again():
    workers = FakeWorkers({"a", "b"}, lambda points, worker: None if points == "2" else 0)
    lost, _ = run(workers)
    assert [entry.reason.split()[0:2] for entry in lost] == [["no", "end"]] and len(workers.asked) == 11 + 4


def test_bad_input_ends_it_and_takes_back_what_is_handed_out():
    workers = FakeWorkers({"a", "b"}, lambda points, worker: 2)
    with pytest.raises(InputError, match="what it said"):
        run(workers)
    assert len(workers.cancelled) == 1 and len(workers.asked) == 2
