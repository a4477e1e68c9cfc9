"""Joins the three kinds of evidence into one verdict per point, per scenario and overall. The rule is in
analysis/README.md; here it is `join` and the outcome of each finding."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field

import numpy as np

from .comparability import labels_of, load_label, refuse_different
from .evidence import BASE, CANDIDATE, CONFIRMATION, Evidence, Point
from .exact import Exact, counter_changes, exact_of, instructions_change, picture_changes
from .rules import (CLOCKS, EXIT_CODES, IMPROVED, INCONCLUSIVE, NOT_COMPARED, REGRESSED, SAME, Rules)
from .timing import ClockVerdict, join_clocks, judge_times, pair_differences, suspects

_MOST_NAMED = 4
_GRAVEST_FIRST = (REGRESSED, INCONCLUSIVE, IMPROVED, SAME)


@dataclass
class Finding:
    evidence: str
    """runs, checks, pictures, counters, instructions, time"""
    outcome: str
    text: str


@dataclass
class PointVerdict:
    scenario: str
    name: str
    labels: dict[str, str]
    outcome: str
    findings: list[Finding]
    exact: dict[str, Exact]
    """By build; only those that ran."""
    clocks: dict[str, ClockVerdict] = field(default_factory=dict)
    times_ms: dict[str, dict[str, float]] = field(default_factory=dict)
    """Median frame time by build and clock, over all processes: for the history, not for the comparison."""

    @property
    def key(self) -> str:
        return f"{self.scenario}: {self.name}"

    def instructions(self, build: str) -> float | None:
        return self.exact[build].instructions if build in self.exact else None

    def mse(self, build: str) -> float | None:
        """Of the worst picture; None without a reference."""
        errors = [p.errors["mse"] for p in self.exact[build].pictures.values() if "mse" in p.errors] \
            if build in self.exact else []
        return max(errors, default=None)


def error_text(mse: float | None) -> str:
    """What stands beside every time."""
    if mse is None:
        return "error not measured"
    return f"{-10 * np.log10(mse):.1f} dB" if mse > 0 else "identical"


@dataclass
class Verdict:
    outcome: str
    points: list[PointVerdict]
    notes: list[str]
    """Labels of comparability: what a reader must know to trust the verdict."""
    device: str
    rules: Rules

    @property
    def scenarios(self) -> dict[str, str]:
        names = dict.fromkeys(p.scenario for p in self.points)
        return {name: join([p.outcome for p in self.points if p.scenario == name]) for name in names}

    @property
    def exit_code(self) -> int:
        return EXIT_CODES[self.outcome]


def join(outcomes: list[str]) -> str:
    """The gravest. What was not compared says nothing; if nothing was, that is inconclusive."""
    return next((outcome for outcome in _GRAVEST_FIRST if outcome in outcomes), INCONCLUSIVE)


def differences_of(points: list[Point], stage: str, rules: Rules) -> dict[tuple[str, str], np.ndarray]:
    """Log ratios of all pairs, by point and clock."""
    return {(p.key, clock): pair_differences(p.completed(BASE, stage), p.completed(CANDIDATE, stage), clock)
            for p in points for clock in rules.clocks if p.completed(BASE, stage) and p.completed(CANDIDATE, stage)}


def suspected_points(points: list[Point], rules: Rules) -> list[Point]:
    """Those whose time needs a confirmation."""
    keys = {key for key, _ in suspects(differences_of(points, "first", rules), rules)}
    return [p for p in points if p.key in keys]


def judge(evidence: Evidence, rules: Rules, baseline: dict[str, Exact] | None = None) -> Verdict:
    """`baseline`: exact quantities of the base by point, if it was stored instead of run. Raises InputError."""
    points = evidence.points
    notes: list[str] = []
    if baseline is None:
        for point in points:
            _check(point, notes)
        times = judge_times(differences_of(points, "first", rules), differences_of(points, CONFIRMATION, rules), rules)
    else:
        times = {}
        notes.append("against a stored baseline: exact quantities only, time was not compared")
    verdicts = [_judge_point(point, times, rules, baseline) for point in points]
    if baseline is not None:
        notes += [f"{name}: in the baseline only" for name in baseline.keys() - {p.key for p in points}]
    runs = [run for p in points for build in (BASE, CANDIDATE) for run in p.first[build] if run.completed]
    busy = load_label(runs) if times else None
    return Verdict(join([v.outcome for v in verdicts]), verdicts, list(dict.fromkeys(notes + ([busy] if busy else []))),
                   device_name(runs), rules)


def device_name(runs: list) -> str:
    identities = [str(run.provenance.get("device", {}).get("identity", "")) for run in runs]
    return next((identity for identity in identities if identity), "unknown device")


def _check(point: Point, notes: list[str]) -> None:
    base, candidate = point.completed(BASE), point.completed(CANDIDATE)
    if base and candidate:
        refuse_different(base, candidate, point.key)
        notes += labels_of(base, candidate)


def _judge_point(point: Point, times: dict, rules: Rules, baseline: dict[str, Exact] | None) -> PointVerdict:
    exact = {build: exact_of(point.completed(build), point.instructions.get(build))
             for build in (BASE, CANDIDATE) if point.completed(build)}
    if baseline is not None and point.key in baseline:
        exact[BASE] = baseline[point.key]
    findings = _run_findings(point, exact)
    clocks = {clock: times[point.key, clock] for clock in rules.clocks if (point.key, clock) in times}
    if not findings:
        findings = _exact_findings(exact[BASE], exact[CANDIDATE], rules)
        if clocks:
            findings.append(_time_finding(clocks, rules))
    return PointVerdict(point.scenario, point.name, point.labels, join_findings(findings), findings, exact, clocks,
                        {build: _median_times(point.completed(build)) for build in exact if point.completed(build)})


def join_findings(findings: list[Finding]) -> str:
    outcomes = [f.outcome for f in findings]
    return NOT_COMPARED if outcomes and set(outcomes) == {NOT_COMPARED} else join(outcomes)


def _run_findings(point: Point, exact: dict[str, Exact]) -> list[Finding]:
    """Something only if there is nothing to compare."""
    missing = {build: point.failure(build) or "nothing stored" for build in (BASE, CANDIDATE) if build not in exact}
    if not missing:
        return []
    if BASE not in missing:
        return [Finding("runs", REGRESSED, f"candidate can't run it ({missing[CANDIDATE]})")]
    if CANDIDATE not in missing:
        return [Finding("runs", NOT_COMPARED, f"base can't run it ({missing[BASE]})")]
    return [Finding("runs", NOT_COMPARED, f"neither can run it (base {missing[BASE]}; candidate {missing[CANDIDATE]})")]


def _exact_findings(base: Exact, candidate: Exact, rules: Rules) -> list[Finding]:
    findings = []
    new_failures = {n: d for n, d in candidate.failed_checks.items() if n not in base.failed_checks}
    if new_failures:
        findings.append(Finding("checks", REGRESSED, "fails in candidate only: " + _listed(
            [f"{name} ({detail})" if detail else name for name, detail in new_failures.items()])))
    accepted = SAME if rules.accept_changes else REGRESSED
    changes = picture_changes(base, candidate, rules.error_tolerance)
    worse = [c for c in changes if c.worse]
    if worse:
        findings.append(Finding("pictures", REGRESSED, "worse: " + _listed([f"{c.what}: {c.detail}" for c in worse])))
    elif changes:
        findings.append(Finding("pictures", accepted, f"changed{_accepted(rules)}: " + _listed(
            [f"{c.what}: {c.detail or f'{c.before}, now {c.after}'}" for c in changes])))
    elif candidate.pictures:
        unlike = [name for name, p in candidate.pictures.items() if p.digest is None]
        findings.append(Finding("pictures", SAME, f"unrepeatable, no larger errors: {_listed(unlike)}" if unlike
                                else f"identical ({len(candidate.pictures)})"))
    changes = counter_changes(base, candidate)
    if changes:
        findings.append(Finding("counters", accepted, f"changed{_accepted(rules)}: " + _listed(
            [f"{c.what} {c.before} to {c.after}" + (f" ({c.detail})" if c.detail else "") for c in changes])))
    elif candidate.counters:
        unlike = [name for name, c in candidate.counters.items() if c.digest is None]
        findings.append(Finding("counters", SAME, f"unrepeatable: {_listed(unlike)}" if unlike
                                else f"identical ({', '.join(candidate.counters)})"))
    share = instructions_change(base, candidate)
    if share is not None:
        more = share > rules.instructions_tolerance
        outcome = accepted if more else IMPROVED if share < -rules.instructions_tolerance else SAME
        findings.append(Finding("instructions", outcome, f"{100 * share:+.4f} % a frame{_accepted(rules) if more else ''}"))
    return findings


def _accepted(rules: Rules) -> str:
    return " (accepted)" if rules.accept_changes else ""


def _listed(texts: list[str]) -> str:
    more = len(texts) - _MOST_NAMED
    return "; ".join(texts[:_MOST_NAMED]) + (f"; and {more} more" if more > 0 else "")


def _time_finding(clocks: dict[str, ClockVerdict], rules: Rules) -> Finding:
    return Finding("time", join_clocks([c.outcome for c in clocks.values()]),
                   "; ".join(f"{name} {clock_text(c, rules)}" for name, c in clocks.items()))


def clock_text(clock: ClockVerdict, rules: Rules) -> str:
    """"+5.1 % [+4.2, +6.0] slower, confirmed"."""
    if clock.ratio is None:
        return "no pairs"
    span = "too few pairs for an interval" if clock.low is None or clock.high is None \
        else f"[{percent(clock.low)}, {percent(clock.high)}]"
    text = f"{percent(clock.ratio)} % {span}"
    if clock.suspected and clock.outcome != REGRESSED:
        text += ", suspected but not confirmed" if clock.p_confirmed is not None else ", suspected, confirmation missing"
    return text + (", confirmed" if clock.outcome == REGRESSED else "")


def percent(ratio: float) -> str:
    return f"{100 * (ratio - 1):+.1f}"


def _median_times(runs: list) -> dict[str, float]:
    return {clock: float(np.median(np.concatenate([run.headline[column].to_numpy() for run in runs])))
            for clock, column in CLOCKS.items()}


def to_json(verdict: Verdict, evidence: Evidence, more: dict) -> dict:
    return {"format": "volmark.verdict", "version": 1, "outcome": verdict.outcome, "exit_code": verdict.exit_code,
            **more, "base": asdict(evidence.base), "candidate": asdict(evidence.candidate), "device": verdict.device,
            "rules": verdict.rules.to_json(), "notes": verdict.notes,
            "scenarios": [{"name": name, "title": evidence.titles.get(name, ""), "outcome": outcome,
                           "points": [_point_json(p) for p in verdict.points if p.scenario == name]}
                          for name, outcome in verdict.scenarios.items()]}


def _point_json(point: PointVerdict) -> dict:
    return {"name": point.name, "labels": point.labels, "outcome": point.outcome,
            "findings": [asdict(f) for f in point.findings],
            "exact": {build: exact.to_json() for build, exact in point.exact.items()},
            "time": {clock: asdict(c) for clock, c in point.clocks.items()}, "times_ms": point.times_ms}
