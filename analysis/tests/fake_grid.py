"""A scenario of the stand-in for the volmark program, and what became of its runs."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

FAKE = Path(__file__).with_name("fake_grid_program.py")


class Grid:
    """A scenario of 24 points in 12 batches, on 3 volumes."""

    def __init__(self, folder, **settings):
        self.folder = folder / "results" / "fake"
        self.config = folder / "fake.json"
        self.config.write_text(json.dumps({"name": "fake", "scenes": ["a", "b", "c"], "techniques": ["x", "y"],
                                           "steps": [1, 2, 3, 4], "seconds": 0.05, "replicates": 2, **settings}))
        self.arguments = ["grid", str(self.config), "--program", str(FAKE), "--results", str(folder / "results")]

    def start(self, *more):
        environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parent.parent), "PYTHONDONTWRITEBYTECODE": "1"}
        return subprocess.Popen([sys.executable, "-m", "volmark_analysis", *self.arguments, *more], env=environment,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def log(self, word):
        path = self.folder / "log"
        lines = path.read_text().splitlines() if path.exists() else []
        return [line.split()[1:] for line in lines if line.split()[0] == word]

    def wait_for(self, word, count):
        deadline = time.monotonic() + 60
        while len(self.log(word)) < count:
            assert time.monotonic() < deadline, f"{len(self.log(word))} of {count} times {word}"
            time.sleep(0.01)

    def check_all_once(self, points=24, replicates=2):
        ended = [tuple(line[:2]) for line in self.log("end")]
        assert sorted(ended) == sorted((str(p), str(r)) for p in range(points) for r in range(replicates))
        assert not self.log("twice")
        files = list(self.folder.glob("runs/[!.]*/run.json"))
        assert len({(d["point_index"], d["replicate"]) for d in map(json.loads, (f.read_text() for f in files))}) == len(files)
        assert len(files) == points * replicates

    def check_one_at_a_time(self):
        """Runs of one worker never overlap: a worker's children are in its process group."""
        by_worker = {}
        for _, _, group, begin, end in self.log("end"):
            by_worker.setdefault(group, []).append((float(begin), float(end)))
        for spans in by_worker.values():
            spans.sort()
            assert all(a[1] <= b[0] for a, b in zip(spans, spans[1:]))
        return set(by_worker)
