"""claims.md."""

from __future__ import annotations

from ...columns import ABSENT
from ..grids import TextGrid, to_markdown
from . import published
from .claims import Claim
from .evidence import KINDS

_RULES = ("A claim about several cells is held if it is in all of them and not held if it is not in one; what is left is not decidable. "
          "A claim about most is held in more than half and not held if half of them refute it. A cell is held or not held only if "
          "its bounds lie on one side as a whole; without bounds it is not decidable. Cells that lack a run are not measured.")


def claims_markdown(claims: list[Claim]) -> str:
    summary = TextGrid("claims", f"Claims of the paper, checked. {published.stand_in_text(published.DATASETS)}",
                       ["no.", "claim", "paper's place", "in time", "in samples + node tests", "cells held in time", "not measured"])
    for number, claim in enumerate(claims, 1):
        verdicts = [c.verdict for c in claim.cases]
        summary.rows.append([str(number), claim.text, claim.section, claim.verdict, claim.work_verdict,
                             f"{verdicts.count('held')} of {len(verdicts)}", str(verdicts.count("not measured"))])
    summary.notes = [_RULES, *(f"{text}." for text in KINDS.values()), "Samples and node tests are counted exactly: their ratio has no bounds."]
    parts = ["# Claims of the bitfield-octree paper (2021)", "", to_markdown(summary)]
    for number, claim in enumerate(claims, 1):
        parts += [f"## {number}. {claim.text}", "", f"In time: {claim.verdict}." + (
            f" In samples + node tests: {claim.work_verdict}." if claim.work_verdict != ABSENT else "")]
        parts += [claim.note] if claim.note else []
        parts += ["", _details(claim)]
    return "\n".join(parts)


def _details(claim: Claim) -> str:
    header = ["cell", "measured", "published", "verdict"] + (["samples + node tests", "verdict in these"] if claim.in_work else [])
    grid = TextGrid("", f"Cells. {published.stand_in_text(published.DATASETS)}", header)
    for case in claim.cases:
        row = [case.where, case.measured, case.published, case.verdict]
        grid.rows.append(row + ([case.work, case.work_verdict] if claim.in_work else []))
    return to_markdown(grid)
