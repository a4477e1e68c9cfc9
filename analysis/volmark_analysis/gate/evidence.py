"""One verdict folder as data: which runs belong to which point and build, and what was counted apart.

    gate.json            {"format": "volmark.gate", "version": 1, "base", "candidate": {"name", "source", "commit"}}
    first/<scenario>/    experiment folder, runs labelled build=base and build=candidate
    confirmation/...     the same with fresh processes, only what was suspected
    instructions.json    {"format": "volmark.instructions", "version": 1,
                          "counts": [{"scenario", "labels", "build", "per_frame"}]}
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path

from ..errors import InputError
from ..load import Experiment, Run, load_experiment

BASE, CANDIDATE = "base", "candidate"
FIRST, CONFIRMATION = "first", "confirmation"
VERSION = 1


@dataclass
class Side:
    """A build as it was asked for."""

    name: str
    """Revision or folder."""
    commit: str = ""
    source: str = "build"
    """"build" or "baseline": a stored one has no runs, only exact quantities."""

    @staticmethod
    def from_json(document: dict) -> "Side":
        return Side(str(document["name"]), str(document.get("commit", "")), str(document.get("source", "build")))


@dataclass
class Point:
    scenario: str
    labels: dict[str, str]
    first: dict[str, list[Run]] = field(default_factory=lambda: {BASE: [], CANDIDATE: []})
    confirmation: dict[str, list[Run]] = field(default_factory=lambda: {BASE: [], CANDIDATE: []})
    instructions: dict[str, float] = field(default_factory=dict)
    """Per frame, by build."""

    @property
    def name(self) -> str:
        return point_name(self.labels)

    @property
    def key(self) -> str:
        return f"{self.scenario}: {self.name}"

    def completed(self, build: str, stage: str = FIRST) -> list[Run]:
        return [run for run in getattr(self, stage)[build] if run.completed]

    def failure(self, build: str) -> str:
        """Why there is no completed run of a build, in one line; empty if there is one."""
        runs = self.first[build]
        if any(run.completed for run in runs):
            return ""
        return f"{runs[0].status}: {' '.join(runs[0].reason.split()) or 'no reason given'}" if runs else "never ran"


@dataclass
class Evidence:
    folder: Path
    base: Side
    candidate: Side
    points: list[Point]
    titles: dict[str, str]
    """By scenario."""


def point_name(labels: dict[str, str]) -> str:
    """The technique, then the other axes."""
    return ", ".join([labels.get("technique", "point")] +
                     [f"{axis} {value}" for axis, value in labels.items() if axis not in ("technique", "build")])


def read_evidence(folder: Path) -> Evidence:
    """Raises InputError."""
    document = read_document(folder / "gate.json", "volmark.gate")
    try:
        sides = [Side.from_json(document[name]) for name in (BASE, CANDIDATE)]
    except (KeyError, TypeError, AttributeError):
        raise InputError(f"{folder / 'gate.json'}: expected objects \"base\" and \"candidate\" with a name") from None
    points: dict[str, Point] = {}
    titles = {}
    for stage in (FIRST, CONFIRMATION):
        for path in sorted(p.parent for p in (folder / stage).glob("*/experiment.json")):
            experiment = load_experiment(path)
            titles.setdefault(experiment.name, experiment.title)
            for point in points_of(experiment, stage):
                known = points.setdefault(point.key, point)
                if known is not point:
                    setattr(known, stage, getattr(point, stage))
    if not points:
        raise InputError(f"{folder}: no experiment in {FIRST}/; expected what a gate left there")
    _add_instructions(folder / "instructions.json", points)
    for side, build in zip(sides, (BASE, CANDIDATE)):
        side.commit = side.commit or _commit_of([run for point in points.values() for run in point.completed(build)])
    return Evidence(folder, *sides, list(points.values()), titles)


def _commit_of(runs: list[Run]) -> str:
    """What the program says that it was built from; empty if it doesn't."""
    programs = [run.provenance.get("program") for run in runs]
    return next((str(p["commit"]) for p in programs if isinstance(p, dict) and p.get("commit")), "")


def points_of(experiment: Experiment, stage: str = FIRST) -> list[Point]:
    """In the scenario's order. Raises InputError for an experiment without named builds."""
    points: dict[str, Point] = {}
    for run in experiment.current_runs:
        build = run.labels.get("build")
        if build not in (BASE, CANDIDATE):
            raise InputError(f"{run.folder / 'run.json'}: /labels/build: found {json.dumps(build)}, allowed: "
                             f"\"{BASE}\", \"{CANDIDATE}\"")
        labels = {axis: value for axis, value in run.labels.items() if axis != "build"}
        point = points.setdefault(point_name(labels), Point(experiment.name, labels))
        getattr(point, stage)[build].append(run)
    return list(points.values())


def _add_instructions(path: Path, points: dict[str, Point]) -> None:
    if not path.exists():
        return
    try:
        for count in read_document(path, "volmark.instructions")["counts"]:
            point = points.get(f"{count['scenario']}: {point_name(count['labels'])}")
            if point is not None:
                point.instructions[count["build"]] = float(count["per_frame"])
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"{path}: damaged ({type(error).__name__}: {error})") from None


def read_document(path: Path, name: str) -> dict:
    """A JSON object of a format of the gate, version 1. Raises InputError."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    except ValueError as error:
        raise InputError(f"{path}: not JSON ({error})") from None
    if not isinstance(document, dict) or document.get("format") != name or document.get("version") != VERSION:
        raise InputError(f"{path}: expected format \"{name}\", version {VERSION}")
    return document
