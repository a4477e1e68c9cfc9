"""What repeats exactly: counters, pictures, checks and instructions of a point on one build, and how two builds differ.

Quantities are held as digests beside a few readable numbers, so that a stored baseline and a fresh run compare alike.
"""

from __future__ import annotations

import hashlib
from dataclasses import asdict, dataclass, field

import numpy as np

from ..exr import read_channels
from ..load import Run

# Errors against the reference: +1 if larger is worse, -1 if smaller is.
_ERRORS = {"mse": 1, "ssim": -1, "flip": 1, "flip_hdr": 1, "depth_mean_voxels": 1, "depth_p995_voxels": 1,
           "depth_max_voxels": 1, "missed_share": 1, "spurious_share": 1}


@dataclass
class Counter:
    mean: float
    digest: str | None
    """Of the values of all counted frames; None if the build's own processes disagree."""


@dataclass
class Picture:
    digest: str | None
    """Of all channels of the decoded file; None if the build's own processes disagree."""
    errors: dict[str, float]
    """Against the reference, the worst of the processes; empty without a reference."""


@dataclass
class Exact:
    """Of one point on one build. JSON: dataclasses as objects."""

    counters: dict[str, Counter] = field(default_factory=dict)
    pictures: dict[str, Picture] = field(default_factory=dict)
    """By "frame F view V"."""
    failed_checks: dict[str, str] = field(default_factory=dict)
    instructions: float | None = None
    """Per frame; None if they were not counted."""

    def to_json(self) -> dict:
        return asdict(self)

    @staticmethod
    def from_json(document: dict) -> "Exact":
        return Exact({n: Counter(**c) for n, c in document["counters"].items()},
                     {n: Picture(**p) for n, p in document["pictures"].items()},
                     dict(document["failed_checks"]), document["instructions"])


@dataclass
class Change:
    """`what` changed from `before` to `after`; `worse`: no matter what was accepted."""

    what: str
    before: str
    after: str
    worse: bool = False
    detail: str = ""


def exact_of(runs: list[Run], instructions: float | None = None) -> Exact:
    """Of the completed processes of a point on one build."""
    exact = Exact(instructions=instructions)
    for run in runs:
        for check in run.checks:
            if check.get("passed") is False:
                exact.failed_checks.setdefault(str(check.get("name")), str(check.get("detail", "")))
    kinds = {c["name"]: c["kind"] for c in runs[0].technique.get("counters", [])}
    for name in (n for n in runs[0].counters if kinds.get(n) != "statistical"):
        found = {_counter_digest(run, name) for run in runs}
        exact.counters[name] = Counter(runs[0].counters[name], found.pop() if len(found) == 1 else None)
    # A technique that isn't deterministic promises no equal bits, only errors of equal size.
    deterministic = runs[0].technique.get("deterministic") is not False
    places = dict.fromkeys((p["frame"], p["view"]) for run in runs for p in run.pictures)
    for frame, view in places:
        entries = [(run, p) for run in runs for p in run.pictures if (p["frame"], p["view"]) == (frame, view)]
        found = {picture_digest(run.folder / p["file"]) for run, p in entries} if deterministic else set()
        errors = {name: [float(p[name]) for _, p in entries if p.get(name) is not None] for name in _ERRORS}
        exact.pictures[f"frame {frame} view {view}"] = Picture(
            found.pop() if len(found) == 1 else None,
            {name: (max if _ERRORS[name] > 0 else min)(values) for name, values in errors.items() if values})
    return exact


def _counter_digest(run: Run, name: str) -> str:
    rows = run.counter_rows
    values = rows[["frame", name]].to_numpy() if rows is not None and name in rows else np.array(run.counters[name])
    return hashlib.sha256(np.ascontiguousarray(values, float).tobytes()).hexdigest()


def picture_digest(path) -> str:
    """Of the decoded values, so that compression and attributes of the file don't matter."""
    channels, views = read_channels(path)
    digest = hashlib.sha256(repr(views).encode())
    for name in sorted(channels):
        values = channels[name]
        digest.update(f"{name} {values.dtype} {values.shape}".encode())
        digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


def counter_changes(base: Exact, candidate: Exact) -> list[Change]:
    """Counters that only one side has are changes too."""
    changes = []
    for name in dict.fromkeys([*base.counters, *candidate.counters]):
        a, b = base.counters.get(name), candidate.counters.get(name)
        if a is None or b is None:
            changes.append(Change(name, _mean(a), _mean(b)))
        elif a.digest != b.digest or a.digest is None:
            detail = "" if a.digest and b.digest else "does not repeat between processes"
            # Processes that disagree in both builds tell nothing about the change.
            if a.digest or b.digest:
                changes.append(Change(name, _mean(a), _mean(b), detail=detail))
    return changes


def _mean(counter: Counter | None) -> str:
    return "absent" if counter is None else f"{counter.mean:.12g}"


def picture_changes(base: Exact, candidate: Exact, tolerance: float) -> list[Change]:
    """`worse`: an error against the reference grew by more than the tolerance. Bits may differ without."""
    changes = []
    for name in dict.fromkeys([*base.pictures, *candidate.pictures]):
        a, b = base.pictures.get(name), candidate.pictures.get(name)
        if a is None or b is None:
            changes.append(Change(name, "absent" if a is None else "there", "absent" if b is None else "there"))
            continue
        worse = [_error_text(key, a, b) for key in _ERRORS if _is_worse(key, a, b, tolerance)]
        if worse:
            changes.append(Change(name, "", "", worse=True, detail="; ".join(worse)))
        elif a.digest != b.digest:
            repeats = "" if a.digest and b.digest else "does not repeat between processes; "
            errors = [_error_text(key, a, b) for key in ("mse", "depth_max_voxels") if key in a.errors and key in b.errors]
            changes.append(Change(name, (a.digest or "")[:8], (b.digest or "")[:8],
                                  detail=repeats + ("; ".join(errors) or "no reference to judge it by")))
    return changes


def _is_worse(key: str, a: Picture, b: Picture, tolerance: float) -> bool:
    if key not in a.errors or key not in b.errors:
        return False
    before, after = a.errors[key], b.errors[key]
    if _ERRORS[key] < 0:  # SSIM: 1 is equal
        before, after = 1.0 - before, 1.0 - after
    return after > before * (1.0 + tolerance) + 1e-12


def _error_text(key: str, a: Picture, b: Picture) -> str:
    return f"{key} {a.errors[key]:.6g} to {b.errors[key]:.6g}"


def instructions_change(base: Exact, candidate: Exact) -> float | None:
    """Share by which instructions per frame grew; None if a side has none."""
    if base.instructions is None or candidate.instructions is None:
        return None
    return candidate.instructions / base.instructions - 1.0
