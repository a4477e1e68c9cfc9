"""claims.md and claims.csv."""

from __future__ import annotations

from dataclasses import dataclass

from ..columns import ABSENT
from .claims import Case, Claim
from .evidence import HELD, KINDS, NOT_MEASURED
from .grids import TextGrid, to_csv, to_markdown

_RULES = ("A claim about several cells is held if it is in all of them and not held if it is not in one; what is left is not decidable. "
          "A claim about most is held in more than half and not held if half of them refute it. A cell is held or not held only if "
          "its bounds lie on one side as a whole; without bounds it is not decidable. Cells that lack a run are not measured.")


@dataclass(frozen=True)
class Wording:
    """What is said differently about each paper."""

    title: str
    stand_ins: str
    time: str
    """The measure of the verdicts: "time"."""
    other: str
    """The other measure, of Case.other: "samples + node tests"."""
    other_in_details: str
    notes: tuple[str, ...] = ()


def claims_markdown(claims: list[Claim], wording: Wording) -> str:
    summary = TextGrid("claims", f"Claims of the paper, checked. {wording.stand_ins}",
                       ["no.", "claim", "paper's place", f"in {wording.time}", f"in {wording.other}", f"cells held in {wording.time}",
                        NOT_MEASURED])
    for number, claim in enumerate(claims, 1):
        verdicts = [c.verdict for c in claim.cases]
        summary.rows.append([str(number), claim.text, claim.section, claim.verdict, claim.other_verdict,
                             f"{verdicts.count(HELD)} of {len(verdicts)}", str(verdicts.count(NOT_MEASURED))])
    summary.notes = [_RULES, *(f"{text}." for text in KINDS.values()), *wording.notes]
    parts = [f"# {wording.title}", "", to_markdown(summary)]
    for number, claim in enumerate(claims, 1):
        parts += [f"## {number}. {claim.text}", "", f"In {wording.time}: {claim.verdict}." + (
            f" In {wording.other}: {claim.other_verdict}." if claim.other_verdict != ABSENT else "")]
        parts += [claim.note] if claim.note else []
        parts += ["", _details(claim, wording)]
    return "\n".join(parts)


def _details(claim: Claim, wording: Wording) -> str:
    has_reasons = any(case.reason for case in claim.cases)
    header = ["cell", "measured", "published", "verdict"] + ([wording.other, wording.other_in_details] if claim.in_other else [])
    grid = TextGrid("", f"Cells. {wording.stand_ins}", header + ["reason"] * has_reasons)
    for case in claim.cases:
        row = [case.where, case.measured, case.published, case.verdict]
        row += [case.other, case.other_verdict] if claim.in_other else []
        grid.rows.append(row + [case.reason] * has_reasons)
    return to_markdown(grid)


CSV_HEADER = ["claim", "text", "section", "claim_verdict", "claim_other_verdict", "cell", "published", "measured", "value", "low", "high",
              "bounds", "verdict", "other", "other_value", "other_low", "other_high", "other_bounds", "other_verdict", "reason"]


def claims_csv(claims: list[Claim]) -> str:
    """A row for each cell."""
    return to_csv(CSV_HEADER, [_csv_row(number, claim, case) for number, claim in enumerate(claims, 1) for case in claim.cases])


def _csv_row(number: int, claim: Claim, case: Case) -> dict:
    row = {"claim": number, "text": claim.text, "section": claim.section, "claim_verdict": claim.verdict, "cell": case.where,
           "published": case.published, "measured": case.measured, "verdict": case.verdict, "reason": case.reason} | case.numbers
    if claim.in_other:
        return row | {"claim_other_verdict": claim.other_verdict, "other": case.other, "other_verdict": case.other_verdict}
    return {name: value for name, value in row.items() if not name.startswith("other")}
