"""The stages of a gate: instructions, first pairs, confirmation of what looks slower, verdict."""

from __future__ import annotations

import json
import math
import os
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from datetime import datetime, timezone
from pathlib import Path

from ..errors import InputError
from . import history
from .baselines import read_baseline, write_baseline
from .builds import Build, MachineError
from .calibration import calibration_text, read_calibration
from .evidence import BASE, CANDIDATE, CONFIRMATION, FIRST, VERSION, Evidence, Side, point_name, read_evidence
from .exact import Exact
from .markdown import to_markdown
from .program import Scenario, kept_count, run
from .rules import Rules
from .verdicts import Verdict, judge, suspected_points, to_json

PROBE_PAIRS = 2
FEWEST_PAIRS = 8
"""Run even if the time is up: fewer can't reject anything after Holm's adjustment."""
MOST_PAIRS = 40
CONFIRMATION_SHARE = 0.5
"""Of the time that is left for pairs: kept for the confirmation, and usually not needed."""
_CONFIRMING_SEED = 2
"""Another order of turns than the first pairs had."""


class Clock:
    """Time since the start, against the budget."""

    def __init__(self, minutes: float = float("inf")):
        self.start, self.minutes = time.monotonic(), minutes

    @property
    def spent(self) -> float:
        return time.monotonic() - self.start

    @property
    def left(self) -> float:
        return 60 * self.minutes - self.spent

    def say(self, text: str) -> None:
        left = "" if math.isinf(self.left) else f", at most {max(self.left, 0) / 60:.1f} min left"
        spent = int(self.spent)
        print(f"gate [{spent // 60}:{spent % 60:02}{left}]: {text}", file=sys.stderr, flush=True)


@dataclass
class Gate:
    """What to compare, and how long that may take."""

    builds: dict[str, Build]
    """Both, or the candidate alone if there is a baseline."""
    scenarios: list[Scenario]
    folder: Path
    clock: Clock
    rules: Rules
    shaders: Path
    """Compiled ones, kept from gate to gate."""
    device: str = ""
    pairs: int | None = None
    """None: as many as the time allows."""
    instructions: bool = True
    baseline: Path | None = None
    notes: list[str] = field(default_factory=list)
    seconds_per_pair: dict[str, float] = field(default_factory=dict)
    """By scenario, of all its points."""

    @property
    def times(self) -> bool:
        """Whether there is time to compare: a stored baseline has none."""
        return BASE in self.builds and bool(self.rules.clocks)

    @property
    def programs(self) -> dict[str, Path]:
        return {name: build.program for name, build in self.builds.items()}


def measure(gate: Gate) -> None:
    """Leaves the folder with everything that judging needs. Raises InputError and MachineError."""
    gate.folder.mkdir(parents=True, exist_ok=True)
    base = gate.builds[BASE].side if BASE in gate.builds else Side(str(gate.baseline), source="baseline")
    _write_json(gate.folder / "gate.json", {"format": "volmark.gate", "version": VERSION, "base": vars(base),
                                            "candidate": vars(gate.builds[CANDIDATE].side)})
    if gate.instructions:
        _count(gate)
    pairs = _first_pairs(gate)
    if gate.times:
        _confirm(gate, pairs)


def _count(gate: Gate) -> None:
    """Counting doesn't mind company: as many at a time as there are cores."""
    # Of one program under two names one count tells both.
    sides = [CANDIDATE] if len(set(gate.programs.values())) == 1 else list(gate.builds)
    jobs = [(side, scenario, point) for scenario in gate.scenarios for point in scenario.points for side in sides]
    done = 0

    def one(job):
        nonlocal done
        side, scenario, point = job
        folder = gate.folder / "instructions" / f"{scenario.name}-{point['index']}-{side}"
        try:
            count = kept_count(gate.builds[side].counts, gate.programs[side], scenario, point["index"], folder, gate.shaders)
        except (MachineError, InputError) as error:
            return job, None, str(error)
        done += 1
        gate.clock.say(f"counted instructions of {scenario.name}, {side} ({done} of {len(jobs)})")
        return job, count, ""

    gate.clock.say(f"counting instructions: {len(jobs)} runs under valgrind")
    pool = ThreadPoolExecutor(os.cpu_count())
    try:
        results = list(pool.map(one, jobs))
    finally:
        pool.shutdown(cancel_futures=True)  # Ctrl-C: those that wait don't start
    counts = []
    for (side, scenario, point), count, problem in results:
        if problem:
            gate.notes.append(f"instructions of {side}, {scenario.name}, not counted: {problem}")
            continue
        for name in gate.builds if len(sides) == 1 else (side,):
            counts.append({"scenario": scenario.name, "labels": point["labels"], "build": name,
                           "per_frame": count.per_frame, "frames": count.frames})
    _write_json(gate.folder / "instructions.json",
                {"format": "volmark.instructions", "version": VERSION, "counts": counts})


def _first_pairs(gate: Gate) -> int:
    """Returns how many."""
    folder = gate.folder / FIRST
    if not gate.times:
        for scenario in gate.scenarios:  # one process tells what is exact
            gate.clock.say(f"{scenario.name}: exact quantities")
            run(gate.programs, scenario, folder, 1, gate.device)
        return 0
    probe = min(PROBE_PAIRS, gate.pairs or PROBE_PAIRS)
    for scenario in gate.scenarios:
        gate.clock.say(f"{scenario.name}: {probe} pairs, to see how long they take")
        started = time.monotonic()
        run(gate.programs, scenario, folder, probe, gate.device)
        gate.seconds_per_pair[scenario.name] = (time.monotonic() - started) / probe
    per_round = sum(gate.seconds_per_pair.values())
    affordable = probe + int(max(gate.clock.left, 0) * (1 - CONFIRMATION_SHARE) / per_round)
    pairs = gate.pairs or min(max(affordable, FEWEST_PAIRS), MOST_PAIRS)
    for scenario in gate.scenarios:
        if pairs > probe:
            gate.clock.say(f"{scenario.name}: {pairs} pairs of processes, about "
                           f"{(pairs - probe) * gate.seconds_per_pair[scenario.name] / 60:.1f} min")
            run(gate.programs, scenario, folder, pairs, gate.device)
    return pairs


def _confirm(gate: Gate, pairs: int) -> None:
    """With fresh processes, of the suspected points alone."""
    suspected = [p.key for p in suspected_points(read_evidence(gate.folder).points, gate.rules)]
    if not suspected:
        return
    wanted = {s.name: [p["index"] for p in s.points if f"{s.name}: {point_name(p['labels'])}" in suspected]
              for s in gate.scenarios}
    per_round = sum(gate.seconds_per_pair[s.name] * len(wanted[s.name]) / len(s.points) for s in gate.scenarios)
    affordable = int(max(gate.clock.left, 0) / per_round) if per_round else FEWEST_PAIRS
    confirming = gate.pairs or min(max(affordable, FEWEST_PAIRS), max(pairs, FEWEST_PAIRS))
    for scenario in gate.scenarios:
        if wanted[scenario.name]:
            gate.clock.say(f"{scenario.name}: looks slower; {confirming} fresh pairs to confirm or clear it")
            run(gate.programs, scenario, gate.folder / CONFIRMATION, confirming, gate.device, wanted[scenario.name],
                seed=_CONFIRMING_SEED)


@dataclass
class Judged:
    verdict: Verdict
    evidence: Evidence
    markdown: str
    document: dict


def judge_folder(folder: Path, rules: Rules, calibration: Path, baseline: Path | None = None,
                 notes: list[str] | None = None, spent: float | None = None) -> Judged:
    """Writes verdict.json and verdict.md into the folder. Raises InputError."""
    evidence = read_evidence(folder)
    stored = read_baseline(baseline, evidence) if baseline is not None else None
    verdict = judge(evidence, rules, stored)
    verdict.notes += notes or []
    text = calibration_text(read_calibration(calibration), verdict)
    markdown = to_markdown(verdict, evidence.base, evidence.candidate, text, spent)
    created = datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ")
    document = to_json(verdict, evidence, {"created": created, "spent_seconds": spent, "calibration": text})
    _write_json(folder / "verdict.json", document)
    _write(folder / "verdict.md", markdown)
    return Judged(verdict, evidence, markdown, document)


def remember(judged: Judged, path: Path) -> None:
    history.append(path, history.line_of(judged.verdict, judged.evidence.base, judged.evidence.candidate,
                                         judged.document["created"]))


def store_baseline(judged: Judged, path: Path) -> None:
    exact: dict[str, Exact] = {f"{p.scenario}: {p.name}": p.exact[CANDIDATE] for p in judged.verdict.points
                               if CANDIDATE in p.exact}
    write_baseline(path, exact, judged.verdict.device, judged.evidence.candidate, judged.document["created"])


def _write_json(path: Path, document: dict) -> None:
    _write(path, json.dumps(document, indent=1) + "\n")


def _write(path: Path, text: str) -> None:
    staged = path.with_name(path.name + ".part")
    staged.write_text(text, encoding="utf-8")
    os.replace(staged, path)
