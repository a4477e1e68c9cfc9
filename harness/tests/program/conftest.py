"""What the tests of the program share: starting it, and scenarios of test techniques."""

import json
import os
import pathlib
import subprocess

import pytest

PROGRAM = os.environ["VOLMARK_PROGRAM"]
BUILD = pathlib.Path(os.environ["VOLMARK_BUILD"])
SOURCE = pathlib.Path(os.environ["VOLMARK_SOURCE"])


class Volmark:
    """The program with its own results folder and the test techniques."""

    def __init__(self, folder):
        self.folder = folder
        self.results = folder / "results"
        self.environment = dict(
            os.environ,
            VOLMARK_TECHNIQUES=f"{BUILD}/tests/techniques",
            VOLMARK_SCENES=str(SOURCE / "scenes"),
        )

    def start(self, *arguments, **options):
        return subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.folder, env=self.environment,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)

    def __call__(self, *arguments, timeout=300):
        return subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, env=self.environment,
                              capture_output=True, text=True, timeout=timeout)

    def scenario(self, document, name="scenario"):
        document = {"volmark": 1, "name": name, **document}
        path = self.folder / f"{name}.json"
        path.write_text(json.dumps(document))
        return path

    def runs(self, name="scenario"):
        """run.json of every finished run, by its labels."""
        found = {}
        for path in sorted((self.results / name / "runs").glob("*/[!.]*/run.json")):
            document = json.loads(path.read_text())
            found[tuple(document["labels"].values()) + (document["replicate"],)] = document
        return found


@pytest.fixture
def volmark(tmp_path):
    return Volmark(tmp_path)


SMALL = {
    "scene": "marschner_lobb",
    "resolution": [32, 24],
    "pacing": {"mode": "frames", "frames": 6, "orbits": 2, "warm_up_frames": 3},
    "pictures": {"count": 2, "reference": "none"},
}
