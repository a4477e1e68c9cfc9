"""What a frame does, counted: exact, unlike its time."""

from __future__ import annotations

from ...points import PointResult


def work_of(result: PointResult) -> float | None:
    """Samples and node tests of a frame, also of the light's rays, which are exact."""
    if "samples" not in result.counters:
        return None
    return sum(result.counters.get(name, 0.0) for name in ("samples", "node_tests", "shadow_samples", "shadow_node_tests"))


def work_ratio(a: PointResult, b: PointResult) -> float | None:
    work_a, work_b = work_of(a), work_of(b)
    return None if work_a is None or not work_b else work_a / work_b
