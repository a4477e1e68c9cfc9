"""Hands batches to workers until all are done."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..errors import InputError
from .batches import Batch, BatchQueue, by_volume, point_list
from .dask_workers import Workers
from .job import Job
from .progress import Progress

_MOST_ATTEMPTS = 4
_MOST_FAILURES_IN_A_ROW = 3
"""Different batches that fail on a worker, before it gets no more: its machine lacks something."""
_DONE = (0, 1)
"""Exit codes of `volmark run`; 1: some run failed, which is a result too."""
_BAD_INPUT = 2


@dataclass
class Lost:
    """A batch without an end."""

    batch: Batch
    reason: str


def hand_out(workers: Workers, job: Job, batches: list[Batch], progress: Progress) -> list[Lost]:
    """Raises InputError if the program refuses the scenario."""
    return _HandOut(workers, job, batches, progress).run()


class _HandOut:
    def __init__(self, workers: Workers, job: Job, batches: list[Batch], progress: Progress):
        self._workers, self._job, self._progress = workers, job, progress
        self._queue = BatchQueue(by_volume(batches))
        self._running: dict = {}
        """Future to batch and the worker that it was meant for."""
        self._attempts: dict[Batch, int] = {}
        self._failed_in_a_row: dict[str, set[Batch]] = {}
        self._lost: list[Lost] = []

    def run(self) -> list[Lost]:
        try:
            while self._queue or self._running:
                self._workers.tend(self._progress)
                present = self._workers.present()
                self._take_from_dead(present)
                usable = {w for w in present if len(self._failed_in_a_row.get(w, ())) < _MOST_FAILURES_IN_A_ROW}
                self._give(usable)
                if not self._running and not usable and (present or self._workers.hopeless):
                    self._give_up()
                for future, outcome in self._workers.wait(list(self._running), 1.0):
                    self._take(*self._running.pop(future), outcome)
                self._progress.show(len(usable))
        finally:
            self._workers.cancel(list(self._running))
            self._progress.finish()
        return self._lost

    def _give(self, usable: set[str]) -> None:
        busy = {worker for _, worker in self._running.values()}
        for worker in sorted(usable - busy):
            batch = self._queue.next_for(worker, usable)
            if batch is not None:
                future = self._workers.submit([*self._job.run_command(), "--points", point_list(batch.points)], worker)
                self._running[future] = batch, worker

    def _take_from_dead(self, present: set[str]) -> None:
        for future, (batch, worker) in list(self._running.items()):
            if worker not in present:
                del self._running[future]
                self._workers.cancel([future])
                self._fail(batch, worker, f"{worker} is gone")

    def _take(self, batch: Batch, worker: str, outcome: dict[str, Any]) -> None:
        code, said = outcome["exit"], outcome["said"]
        if code in _DONE:
            self._failed_in_a_row.pop(worker, None)
            self._progress.advance(len(batch.points), outcome["seconds"])
        elif code == _BAD_INPUT:
            raise InputError(f"{said} ({worker})")
        else:
            self._failed_in_a_row.setdefault(worker, set()).add(batch)
            ended = f"exit code {code}" if code is not None else "no end"
            self._fail(batch, worker, f"{ended} on {worker}" + (f": {said}" if said else ""))

    def _fail(self, batch: Batch, worker: str, reason: str) -> None:
        self._attempts[batch] = self._attempts.get(batch, 0) + 1
        if self._attempts[batch] >= _MOST_ATTEMPTS:
            self._lose(batch, reason)
        else:
            self._progress.say(f"points {point_list(batch.points)}: {reason}: handed out again")
            self._queue.give_back(batch, worker)

    def _lose(self, batch: Batch, reason: str) -> None:
        self._lost.append(Lost(batch, reason))
        self._progress.say(f"points {point_list(batch.points)}: {reason}: given up")

    def _give_up(self) -> None:
        for batch in self._queue.take_all():
            self._lost.append(Lost(batch, "no worker is left that can run it"))
