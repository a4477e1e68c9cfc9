"""Successive halving: all points are measured by one process each, the best share of each contest by several more, and so on.
Most of the measuring goes to the points that matter. All is in one experiment: a stopped search goes on."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..errors import InputError
from ..grid.batches import batches_of
from ..grid.dask_workers import Workers
from ..grid.hand_out import Lost, hand_out
from ..grid.job import Job
from ..grid.progress import Progress
from ..load import Experiment, load_experiment
from ..points import PointResult, device_of, point_results
from .best import best_of, counts_of
from .candidates import Contest, Limit, contests_of, latest


@dataclass(frozen=True)
class Question:
    """What is searched for."""

    objective: str
    per: list[str]
    limits: list[Limit]


@dataclass
class Halved:
    experiment: Experiment
    contests: list[Contest]
    """Of the last rung: the points that were measured most."""
    lost: list[Lost]
    runs: int
    """Processes that the search asked for, and those of the full grid with as many for every point."""
    full_runs: int


def rungs_of(eta: int, replicates: int) -> list[int]:
    """Processes per point: 1, eta, eta^2 ... and at last `replicates`."""
    rungs = [1]
    while rungs[-1] < replicates:
        rungs.append(min(rungs[-1] * eta, replicates))
    return rungs


def survivors_of(contest: Contest, eta: int) -> list[PointResult]:
    """The fastest share of 1/eta, at least one."""
    ranked = sorted(contest.points, key=lambda r: contest.times[id(r)].value)
    return ranked[:math.ceil(len(ranked) / eta)]


def halve(workers: Workers, job: Job, question: Question, eta: int, replicates: int, progress: Progress) -> Halved:
    """Raises InputError if the scenario can't be run or its points can't be compared."""
    points = {point.index: point for point in job.points()}
    chosen, lost, rungs, runs = set(points), [], rungs_of(eta, replicates), 0
    for number, count in enumerate(rungs, start=1):
        batches = batches_of([points[index] for index in sorted(chosen)])
        progress.start(len(chosen), f"rung {number} of {len(rungs)}, {count} process{'es' if count > 1 else ''} each: ")
        lost += hand_out(workers, job.with_assignment(f"measure.replicates={count}"), batches, progress)
        runs += len(chosen) * (count - (rungs[number - 2] if number > 1 else 0))
        if not job.has_begun:
            raise InputError(f"{job.config}: nothing was run: {lost[0].reason}")
        experiment = load_experiment(job.folder)
        contests = _contests(experiment, chosen, question)
        progress.say(_summary(contests, number, len(rungs), count))
        if number < len(rungs):
            chosen = {r.point_index for contest in contests for r in survivors_of(contest, eta)}
    return Halved(experiment, contests, lost, runs, len(points) * replicates)


def _contests(experiment: Experiment, chosen: set[int], question: Question) -> list[Contest]:
    results = [r for r in point_results(experiment) if r.point_index in chosen]
    devices = sorted({" ".join(filter(None, device_of(r.any_run))) for r in latest(results) if r.completed})
    if len(devices) > 1:
        raise InputError(f"{experiment.folder}: points were measured on {', '.join(devices)}: times of different devices can't "
                         f"be compared, a search needs workers of one")
    contests = contests_of(results, question.per, question.objective, question.limits)
    if not any(contest.points for contest in contests):
        raise InputError(f"{experiment.folder}: no point is left: {' '.join(map(counts_of, contests))}")
    return contests


def _summary(contests: list[Contest], number: int, rungs: int, count: int) -> str:
    best = [(contest, best_of(contest)) for contest in contests if contest.points]
    shown = "; ".join(f"{contest.title}: {contest.times[id(b.point)].text} ms, {len(b.ties)} ties of {len(contest.points)}"
                      for contest, b in best[:3])
    return f"rung {number} of {rungs} ({count} process{'es' if count > 1 else ''} each): {shown}" + (
        f"; and {len(best) - 3} more" if len(best) > 3 else "")
