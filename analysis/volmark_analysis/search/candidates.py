"""Which points compete with which."""

from __future__ import annotations

from dataclasses import dataclass, field
from difflib import get_close_matches

from ..errors import InputError
from ..points import PointResult, axes_of, device_of
from .objective import HIGHER_IS_BETTER, Measured, measured


@dataclass(frozen=True)
class Limit:
    """Of the worst captured picture."""

    error: str
    value: float

    def allows(self, result: PointResult) -> bool | None:
        """None: the error was not measured."""
        found = error_of(result, self.error)
        if found is None:
            return None
        return found >= self.value if HIGHER_IS_BETTER[self.error] else found <= self.value

    def __str__(self) -> str:
        return f"{self.error} {'at least' if HIGHER_IS_BETTER[self.error] else 'at most'} {self.value:g}"


def error_of(result: PointResult, error: str) -> float | None:
    """Of the worst captured picture; None if not measured."""
    if error == "psnr_db" and "psnr_db" not in result.errors and result.errors.get("identical"):
        return float("inf")
    return result.errors.get(error)


@dataclass
class Contest:
    """Points that compete: of one scene (or what the search is per) and one device."""

    where: dict[str, str]
    points: list[PointResult] = field(default_factory=list)
    times: dict[int, Measured] = field(default_factory=dict)
    """By id of a result."""
    left_out: dict[str, int] = field(default_factory=dict)
    """How many points don't compete, by why."""

    @property
    def title(self) -> str:
        return ", ".join(text for text in self.where.values() if text) or "all points"


def contests_of(results: list[PointResult], per: list[str], objective: str, limits: list[Limit],
                needed: str | None = None) -> list[Contest]:
    """`per`: axes that are not searched over; `needed`: an error that points must have. Times of several devices never
    compete, nor do pictures of isosurfaces with those of volumes. Raises InputError."""
    known = list(dict.fromkeys(["scene", *axes_of(results)]))
    for axis in per:
        if axis not in known:
            near = get_close_matches(axis, known, n=1)
            raise InputError(f"--per: no axis {axis!r}{f'; did you mean {near[0]}?' if near else ''} "
                             f"(allowed: {', '.join(known)})")
    done = [r for r in results if r.completed]
    apart = {name: of for name, of in (("draws", _draws_of), ("device", _device_of)) if len(set(map(of, done))) > 1}
    contests: dict[tuple, Contest] = {}
    for r in latest(results):
        where = {axis: _value_of(r, axis) for axis in per}
        if r.completed:
            where |= {name: of(r) for name, of in apart.items()}
        contest = contests.setdefault(tuple(where.items()), Contest(where))
        time = measured(r, objective)
        reason = f"without {objective if r.completed else 'a result'}" if time is None else _why_refused(r, limits, needed)
        if reason is None:
            contest.times[id(r)] = time
            contest.points.append(r)
        else:
            contest.left_out[reason] = contest.left_out.get(reason, 0) + 1
    return list(contests.values())


def _value_of(r: PointResult, axis: str) -> str:
    return r.labels.get(axis) or (r.scene if axis == "scene" else "")


def _draws_of(r: PointResult) -> str:
    return str(r.any_run.technique.get("draws", ""))


def _device_of(r: PointResult) -> str:
    return " ".join(part for part in device_of(r.any_run) if part)


def _why_refused(r: PointResult, limits: list[Limit], needed: str | None) -> str | None:
    if needed is not None and error_of(r, needed) is None:
        return f"without {needed}"
    for limit in limits:
        allowed = limit.allows(r)
        if allowed is None:
            return f"without {limit.error}"
        if not allowed:
            return f"outside {limit}"
    return None


def latest(results: list[PointResult]) -> list[PointResult]:
    """Of a point that several builds measured on one device, the result of the last one."""
    kept: dict[tuple, PointResult] = {}
    done = {r.point_index for r in results if r.completed}
    for r in results:
        if not r.completed and r.point_index in done:
            continue
        key = r.point_index, device_of(r.any_run) if r.completed else None
        if key not in kept or _started(r) > _started(kept[key]):
            kept[key] = r
    return list(kept.values())


def _started(r: PointResult) -> str:
    return max((str(run.provenance.get("started", "")) for run in r.completed), default="")
