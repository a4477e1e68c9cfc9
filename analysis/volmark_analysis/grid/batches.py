"""What is handed out: batches of points that the program measures together, and who gets which next."""

from __future__ import annotations

import json
from collections import deque
from dataclasses import dataclass

from .job import PlannedPoint


@dataclass(frozen=True)
class Batch:
    points: tuple[int, ...]
    """Indices in the expansion."""
    volume: str
    """What batches on the same volume have in common."""


def batches_of(points: list[PlannedPoint]) -> list[Batch]:
    """As the program batches them: points of a group take turns, at most `measure.interleave` of them. A technique is never
    parted from those it is compared with, but where there are more of them than may be alive at once."""
    batches: list[list[PlannedPoint]] = []
    open_batches: dict[str, list[PlannedPoint]] = {}
    for point in points:
        batch = open_batches.get(point.group)
        if batch is None or len(batch) >= point.config["measure"]["interleave"]:
            batch = open_batches[point.group] = []
            batches.append(batch)
        batch.append(point)
    return [Batch(tuple(p.index for p in batch), _volume_of(batch[0])) for batch in batches]


def _volume_of(point: PlannedPoint) -> str:
    return json.dumps([point.config["scene"], point.config.get("volume")], sort_keys=True)


def by_volume(batches: list[Batch]) -> list[Batch]:
    """Those of a volume one after another, otherwise in their order."""
    volumes: dict[str, list[Batch]] = {}
    for batch in batches:
        volumes.setdefault(batch.volume, []).append(batch)
    return [batch for members in volumes.values() for batch in members]


def point_list(points: tuple[int, ...]) -> str:
    """"3,7-9", as `--points` takes it."""
    parts: list[list[int]] = []
    for point in sorted(points):
        if parts and point == parts[-1][1] + 1:
            parts[-1][1] = point
        else:
            parts.append([point, point])
    return ",".join(str(first) if first == last else f"{first}-{last}" for first, last in parts)


class BatchQueue:
    """Batches to do. A worker stays with its volume while there is work on it, as volumes are cached per machine; then it
    takes one that nobody has begun, and at last helps with the one that has most left."""

    def __init__(self, batches: list[Batch]):
        self._left: dict[str, deque[Batch]] = {}
        self._volumes: dict[str, str] = {}
        self._failed_on: dict[Batch, set[str]] = {}
        for batch in batches:
            self._left.setdefault(batch.volume, deque()).append(batch)

    def __len__(self) -> int:
        return sum(map(len, self._left.values()))

    def give_back(self, batch: Batch, worker: str) -> None:
        """It failed there: others come first."""
        self._failed_on.setdefault(batch, set()).add(worker)
        self._left[batch.volume].append(batch)

    def next_for(self, worker: str, workers: set[str]) -> Batch | None:
        """`workers`: all that could take it."""
        own, begun = self._volumes.get(worker), set(self._volumes.values())
        for volume in sorted(self._left, key=lambda v: (v != own, v in begun, -len(self._left[v]) if v in begun else 0)):
            for batch in self._left[volume]:
                failed_on = self._failed_on.get(batch, set())
                if worker not in failed_on or workers <= failed_on:
                    self._left[volume].remove(batch)
                    self._volumes[worker] = volume
                    return batch
        return None

    def take_all(self) -> list[Batch]:
        batches = [batch for left in self._left.values() for batch in left]
        self._left.clear()
        return batches
