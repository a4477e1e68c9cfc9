"""A paper's claim and the cells that it is about."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Callable

from ..columns import ABSENT
from .evidence import NOT_MEASURED, all_of


@dataclass
class Case:
    """One cell that a claim is about."""

    where: str
    published: str
    measured: str = NOT_MEASURED
    verdict: str = NOT_MEASURED
    other: str = NOT_MEASURED
    """The same in the paper's other measure (Wording.other), which is not time alone."""
    other_verdict: str = NOT_MEASURED
    reason: str = ""
    """What about this machine decides it, or keeps it from being decided."""
    numbers: dict[str, float | None] = field(default_factory=dict)
    """What `measured` says, for CSV."""


@dataclass
class Claim:
    text: str
    section: str
    cases: list[Case] = field(default_factory=list)
    join: Callable[[list[str]], str] = all_of
    note: str = ""
    in_other: bool = True
    """Whether the claim means something in the other measure."""

    @property
    def verdict(self) -> str:
        return self.join([c.verdict for c in self.cases])

    @property
    def other_verdict(self) -> str:
        return self.join([c.other_verdict for c in self.cases]) if self.in_other else ABSENT
