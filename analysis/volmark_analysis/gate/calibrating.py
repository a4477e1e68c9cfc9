"""Records what a calibration is made from: A/A pairs, pairs against a slowed build, and repeated instruction counts."""

from __future__ import annotations

import contextlib
import multiprocessing
import random
import shlex
import time
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

from .builds import Build
from .calibration import Recorded, calibrate, calibration_document, recorded_from
from .comparability import load_label
from .evidence import BASE, CANDIDATE, Point, point_name, points_of
from ..load import load_experiment
from .program import Scenario, count_instructions, run
from .rules import Rules
from .stages import Clock
from .verdicts import device_name, differences_of

_WASTED_INSTRUCTIONS = 0.001


@dataclass
class Calibration:
    """What to record."""

    build: Build
    scenarios: list[Scenario]
    folder: Path
    clock: Clock
    rules: Rules
    pairs: int
    shares: list[float]
    """Of time, that slowed builds waste."""
    trials: int
    load: int
    """Busy processes beside, to know the gate on a machine that others use."""
    shaders: Path
    device: str
    instructions: bool


def run_calibration(task: Calibration) -> dict:
    """The document to store. Raises InputError and MachineError."""
    program = task.build.program
    instructions = [_instruction_entry(task, scenario, point) for scenario in task.scenarios
                    for point in scenario.points] if task.instructions else []
    with _busy(task.load):
        points = _record(task, "aa", program)
        slowed = {share: _record(task, f"slower-{100 * share:g}", _slowed(task.folder, program, share))
                  for share in task.shares}
    runs = [run for point in points for build in (BASE, CANDIDATE) for run in point.completed(build)]
    conditions = f"{load_label(runs) or 'quiet machine'}" + (f", {task.load} busy processes beside" if task.load else "")
    task.clock.say(f"simulating {task.trials} gates for each number of pairs")
    parts = calibrate(_recorded(points, task.rules),
                      {share: _recorded(found, task.rules) for share, found in slowed.items()}, task.rules, task.trials)
    created = datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    return calibration_document(parts, device_name(runs), task.rules, created, instructions, conditions)


def _record(task: Calibration, name: str, candidate: Path) -> list[Point]:
    points = []
    for scenario in task.scenarios:
        task.clock.say(f"{name}: {task.pairs} pairs of {scenario.name}")
        run({BASE: task.build.program, CANDIDATE: candidate}, scenario, task.folder / name, task.pairs, task.device)
        points += points_of(load_experiment(task.folder / name / scenario.name))
    return points


def _recorded(points: list[Point], rules: Rules) -> Recorded:
    return recorded_from(differences_of(points, "first", rules), rules)


def _slowed(folder: Path, program: Path, share: float) -> Path:
    """A script that starts the same program with a share of its time wasted."""
    script = folder / f"slower-{100 * share:g}.sh"
    folder.mkdir(parents=True, exist_ok=True)
    script.write_text(f'#!/bin/sh\nVOLMARK_WASTE_TIME={share} exec {shlex.quote(str(program))} "$@"\n', encoding="utf-8")
    script.chmod(0o755)
    return script.resolve()


def _instruction_entry(task: Calibration, scenario: Scenario, point: dict) -> dict:
    """Two counts of the same program, and one of a program that wastes a thousandth more."""
    def count(name, environment=None):
        task.clock.say(f"instructions of {scenario.name}, {name}")
        folder = task.folder / "instructions" / f"{scenario.name}-{point['index']}-{name}"
        return count_instructions(task.build.program, scenario, point["index"], folder, task.shaders,
                                  environment).per_frame

    first, again = count("first"), count("again")
    wasted = round(_WASTED_INSTRUCTIONS * first)
    more = count("more", {"VOLMARK_WASTE_INSTRUCTIONS": str(wasted)})
    return {"scenario": scenario.name, "point": point_name(point["labels"]), "per_frame": first,
            "repeats_within": abs(again / first - 1), "injected": wasted / first, "found": more / first - 1,
            "tolerance": task.rules.instructions_tolerance}


@contextlib.contextmanager
def _busy(count: int):
    """So many processes that work and pause at random."""
    processes = [multiprocessing.Process(target=_work_and_pause, args=(seed,), daemon=True) for seed in range(count)]
    for process in processes:
        process.start()
    try:
        yield
    finally:
        for process in processes:
            process.terminate()


def _work_and_pause(seed: int) -> None:
    rng = random.Random(seed)
    while True:
        end = time.monotonic() + rng.expovariate(1 / 0.4)
        while time.monotonic() < end:
            pass
        time.sleep(rng.expovariate(1 / 0.2))
