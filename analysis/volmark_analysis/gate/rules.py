"""The numbers that a verdict depends on, in one place."""

from __future__ import annotations

from dataclasses import asdict, dataclass

REGRESSED, SAME, IMPROVED, INCONCLUSIVE = "regressed", "same", "improved", "inconclusive"
NOT_COMPARED = "not compared"
"""Of a point that base can't run: there is nothing to hold it against."""
EXIT_CODES = {SAME: 0, IMPROVED: 0, REGRESSED: 1, INCONCLUSIVE: 4}
CLOCKS = {"cpu": "cpu_ms", "wall": "host_ms"}
"""Columns of frames.csv."""


@dataclass(frozen=True)
class Rules:
    margin: float = 0.02
    """Times whose ratio lies within 1 / (1 + margin) and 1 + margin are the same."""
    level: float = 0.05
    """Chance of any false suspicion, and again of any false confirmation, over all points and clocks."""
    confidence: float = 0.95
    """Of the intervals that are shown, and that must lie within the margin for "same"."""
    instructions_tolerance: float = 5e-4
    """Share of instructions per frame that may differ."""
    error_tolerance: float = 0.02
    """Share by which an error against the reference may grow before the picture is called worse."""
    clocks: tuple[str, ...] = tuple(CLOCKS)
    accept_changes: bool = False

    def to_json(self) -> dict:
        return asdict(self)
