"""The verdict as Markdown, for a pull request or a terminal. Everything that comes from data is written as a code
span: there a reader's browser makes no links, mentions or HTML of it."""

from __future__ import annotations

import re

from ..columns import number_text
from .evidence import BASE, CANDIDATE, Side
from .rules import IMPROVED, INCONCLUSIVE, NOT_COMPARED, REGRESSED, SAME
from .verdicts import PointVerdict, Verdict, clock_text, error_text

_SIGNS = {REGRESSED: "❌", SAME: "✅", IMPROVED: "🚀", INCONCLUSIVE: "❔", NOT_COMPARED: "➖"}
_LONGEST = 600
_UNPRINTABLE = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\u200e\u200f\u202a-\u202e\u2066-\u2069]+")
"""Control characters, line ends, and what turns the direction of text."""


def code(text: str) -> str:
    """`text` as an inline code span that can't be left, in a table cell too: no line breaks or control characters, a
    fence longer than any run of backticks inside. A bar would end the cell even here, so it is written as a broken
    bar."""
    plain = _UNPRINTABLE.sub(" ", str(text)).replace("|", "¦")
    plain = plain if len(plain) <= _LONGEST else plain[:_LONGEST - 1] + "…"
    if not plain.strip():
        return "–"
    fence = "`" * (1 + max((len(run) for run in re.findall("`+", plain)), default=0))
    space = " " if plain[0] in "` " or plain[-1] in "` " else ""
    return f"{fence}{space}{plain}{space}{fence}"


def to_markdown(verdict: Verdict, base: Side, candidate: Side, calibration: str, spent_seconds: float | None = None) -> str:
    """`calibration`: what is known about false alarms and detectable slowdowns."""
    lines = [f"## {_SIGNS[verdict.outcome]} volmark gate: {verdict.outcome}", "",
             f"{_side(candidate)} against {_side(base)} on {code(verdict.device)}"
             + (f", {spent_seconds / 60:.1f} minutes" if spent_seconds is not None else ""), "",
             "| scenario | point | verdict | process CPU | wall | instructions | pictures and counters |",
             "| --- | --- | --- | --- | --- | --- | --- |"]
    lines += [_row(point, verdict) for point in verdict.points]
    reasons = [line for point in verdict.points for line in _reasons(point)]
    if reasons:
        lines += ["", "**Why**", "", *reasons]
    if verdict.notes:
        lines += ["", "**To know**", "", *(f"- {code(note)}" for note in verdict.notes)]
    if any(point.clocks for point in verdict.points):
        lines += ["", "**Times**, median ms a frame and the error of the worst picture", "", *_times(verdict.points)]
    lines += ["", f"{calibration} {_method(verdict)}"]
    return "\n".join(lines) + "\n"


def _side(side: Side) -> str:
    commit = f" ({code(side.commit[:12])})" if side.commit and not side.commit.startswith(side.name) else ""
    return f"{code(side.name)}{commit}"


def _row(point: PointVerdict, verdict: Verdict) -> str:
    time = [clock_text(point.clocks[c], verdict.rules) if c in point.clocks else "–" for c in ("cpu", "wall")]
    by_evidence = {f.evidence: f for f in point.findings}
    instructions = by_evidence["instructions"].text if "instructions" in by_evidence else "–"
    exact = [f"{f.evidence} {_word(f.text)}" for f in point.findings if f.evidence in ("pictures", "counters", "checks", "runs")]
    cells = [code(point.scenario), code(point.name), f"{_SIGNS[point.outcome]} {point.outcome}", *time, instructions,
             ", ".join(exact) or "–"]
    return f"| {' | '.join(cells)} |"


def _word(text: str) -> str:
    """The first word of a finding; the rest, which may hold names from the data, is below the table."""
    return re.match(r"[a-z']*( (can't run it|\(accepted\)))?", text)[0] or "–"


def _reasons(point: PointVerdict) -> list[str]:
    shown = [f for f in point.findings if f.outcome != SAME or "(accepted)" in f.text]
    return [f"- {code(point.scenario)}, {code(point.name)}: {f.evidence} **{f.outcome}**, {code(f.text)}" for f in shown]


def _times(points: list[PointVerdict]) -> list[str]:
    lines = ["| scenario | point | build | cpu | wall | error |", "| --- | --- | --- | ---: | ---: | --- |"]
    for point in points:
        for build in (BASE, CANDIDATE):
            times = point.times_ms.get(build)
            if times:
                lines.append(f"| {code(point.scenario)} | {code(point.name)} | {build} | {number_text(times['cpu'])} | "
                             f"{number_text(times['wall'])} | {error_text(point.mse(build))} |")
    return lines


def _method(verdict: Verdict) -> str:
    rules = verdict.rules
    pairs = sorted({c.pairs for p in verdict.points for c in p.clocks.values()})
    text = f"Exact quantities are compared bit by bit, instructions to {100 * rules.instructions_tolerance:g} %."
    if not pairs:
        return text
    span = f"{pairs[0]}" if len(pairs) == 1 else f"{pairs[0]} to {pairs[-1]}"
    return (f"{text} Times: candidate / base over {span} pairs of processes that took turns, {100 * rules.confidence:g} % "
            f"signed-rank intervals; *same* lies within ±{100 * rules.margin:g} % as a whole, *regressed* above it at "
            f"{100 * rules.level:g} % over all points and clocks (Holm), and again with fresh processes.")
