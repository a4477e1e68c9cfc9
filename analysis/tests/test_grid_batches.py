"""What is handed out, and in which order."""

import random

import pytest
from volmark_analysis.grid.batches import Batch, BatchQueue, batches_of, by_volume, point_list
from volmark_analysis.grid.job import PlannedPoint
from volmark_analysis.grid.progress import Progress, duration_text


def random_points(rng, count=60):
    interleave = rng.randint(1, 4)
    return [PlannedPoint(i, {}, f"group {rng.randint(0, 12)}",
                         {"scene": f"scene {rng.randint(0, 3)}", "measure": {"interleave": interleave}}) for i in range(count)]


@pytest.mark.parametrize("seed", range(20))
def test_batches_hold_every_point_once_and_only_compared_ones(seed):
    points = random_points(random.Random(seed))
    batches = batches_of(points)
    assert sorted(i for b in batches for i in b.points) == list(range(len(points)))
    room = points[0].config["measure"]["interleave"]
    for batch in batches:
        assert len({points[i].group for i in batch.points}) == 1 and len(batch.points) <= room
    for group in {p.group for p in points}:  # parted only where there are too many
        sizes = [len(b.points) for b in batches if points[b.points[0]].group == group]
        assert len(sizes) == -(-sum(sizes) // room)
    assert sorted(by_volume(batches), key=batches.index) == batches
    volumes = [b.volume for b in by_volume(batches)]
    assert sum(a != b for a, b in zip(volumes, volumes[1:])) == len(set(volumes)) - 1


@pytest.mark.parametrize("seed", range(20))
def test_point_lists_read_back(seed):
    rng = random.Random(seed)
    numbers = tuple(rng.sample(range(40), rng.randint(1, 40)))
    text = point_list(numbers)
    read = {i for part in text.split(",") for first, _, last in [part.partition("-")]
            for i in range(int(first), int(last or first) + 1)}
    assert read == set(numbers)
    assert len(text.split(",")) == sum(n - 1 not in read for n in read)  # as short as it can be


def batch(number, volume):
    return Batch((number,), volume)


@pytest.mark.parametrize("seed", range(20))
def test_a_worker_leaves_a_volume_only_when_nothing_is_left_of_it(seed):
    rng = random.Random(seed)
    batches = [batch(i, f"volume {rng.randint(0, 4)}") for i in range(40)]
    queue, given, before = BatchQueue(batches), [], {}
    workers = {f"worker {i}" for i in range(rng.randint(1, 4))}
    while queue:
        worker = rng.choice(sorted(workers))
        left = [b for b in batches if b not in given]
        taken = queue.next_for(worker, workers)
        own, begun = before.get(worker), set(before.values())
        assert taken not in given
        if taken.volume != own:
            assert not any(b.volume == own for b in left)
            if taken.volume in begun:  # helps only where nothing is untouched
                assert all(b.volume in begun for b in left)
        given.append(taken)
        before[worker] = taken.volume
    assert sorted(given, key=batches.index) == batches and queue.next_for("worker 0", workers) is None


def test_what_failed_on_a_worker_goes_to_others_first():
    queue, only = BatchQueue([batch(0, "v")]), {"a", "b"}
    first = queue.next_for("a", only)
    queue.give_back(first, "a")
    assert queue.next_for("a", only) is None and queue.next_for("b", only) == first
    queue.give_back(first, "b")
    assert queue.next_for("a", only) == first  # all have failed: it may have been chance
    queue.give_back(first, "a")
    assert queue.next_for("a", {"a"}) == first and len(queue) == 0


class Stream(list):
    write = list.append

    def isatty(self):
        return False

    def flush(self):
        pass


def test_time_left_follows_the_latest_batches():
    progress = Progress(Stream())
    progress.start(1000)
    for _ in range(500):
        progress.advance(1, 0.01)  # done before
    for _ in range(20):
        progress.advance(1, 30.0)
    assert progress.line(2) == f"520 of 1000 points, 2 workers, {duration_text(480 * 30 / 2)} left"
    assert "left" not in progress.line(0)
    assert duration_text(7200) == "2 h 00 min" and duration_text(59.6) == "1 min 00 s"
