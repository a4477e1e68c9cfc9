"""One JSON line per verdict, and a plot over them: instructions and CPU time a frame, with the places of change."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ..errors import InputError
from ..plots import FAINT, TEXT
from .change_points import change_points, steps
from .evidence import CANDIDATE, VERSION, Side
from .rules import IMPROVED, INCONCLUSIVE, REGRESSED, SAME
from .verdicts import Verdict, error_text

FORMAT = "volmark.gate_history"
_COLORS = {SAME: "#0072B2", REGRESSED: "#D55E00", IMPROVED: "#009E73", INCONCLUSIVE: "#7F7F7F"}
_LINE, _CHANGE = "#9aa0a8", "#CC79A7"
_MOST_NAMED = 24
_LEGEND = 0.3
"""Inches."""


@dataclass
class Series:
    """One quantity of one point over verdicts."""

    point: str
    quantity: str
    places: np.ndarray
    """Of the verdicts that have it, in the order of the history."""
    values: np.ndarray
    outcomes: list[str]
    errors: list[float | None]
    """Mean squared ones of the worst pictures: no time without them."""
    changes: list[int]
    """Indices into `values`."""


def line_of(verdict: Verdict, base: Side, candidate: Side, created: str) -> dict:
    return {"format": FORMAT, "version": VERSION, "created": created, "outcome": verdict.outcome,
            "device": verdict.device, "base": {"name": base.name, "commit": base.commit},
            "candidate": {"name": candidate.name, "commit": candidate.commit},
            "points": [{"scenario": p.scenario, "point": p.name, "outcome": p.outcome,
                        "instructions": p.instructions(CANDIDATE), "mse": p.mse(CANDIDATE),
                        "cpu_ms": p.times_ms.get(CANDIDATE, {}).get("cpu"),
                        "wall_ms": p.times_ms.get(CANDIDATE, {}).get("wall"),
                        "ratios": {name: [c.ratio, c.low, c.high] for name, c in p.clocks.items()}}
                       for p in verdict.points]}


def append(path: Path, line: dict) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with open(path, "a", encoding="utf-8") as file:
        file.write(json.dumps(line) + "\n")


def read_history(path: Path) -> list[dict]:
    """Raises InputError. A last line that a stopped program left unfinished is not read."""
    try:
        lines = path.read_text(encoding="utf-8").split("\n")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: can't be read ({getattr(error, 'strerror', None) or error})") from None
    entries = []
    for number, line in enumerate(lines[:-1], start=1):
        try:
            entry = json.loads(line)
            if entry["format"] != FORMAT or entry["version"] != VERSION:
                raise ValueError(f"expected format {FORMAT}, version {VERSION}")
            if not isinstance(entry["points"], list) or not all(isinstance(p, dict) for p in entry["points"]):
                raise ValueError("expected a list of points")
        except (ValueError, KeyError, TypeError) as error:
            raise InputError(f"{path}: line {number}: not an entry of a gate's history ({error})") from None
        entries.append(entry)
    if not entries:
        raise InputError(f"{path}: empty, no verdict to show")
    return entries


def series_of(entries: list[dict], tolerance: float) -> list[Series]:
    """By point, instructions before CPU time."""
    names = dict.fromkeys(f"{p.get('scenario')}: {p.get('point')}" for e in entries for p in e["points"])
    found = []
    for name in names:
        for quantity in ("instructions", "cpu_ms"):
            places, values, outcomes, errors = [], [], [], []
            for place, entry in enumerate(entries):
                for p in entry["points"]:
                    if f"{p.get('scenario')}: {p.get('point')}" == name and isinstance(p.get(quantity), (int, float)):
                        places.append(place)
                        values.append(float(p[quantity]))
                        outcomes.append(str(p.get("outcome")))
                        errors.append(p.get("mse"))
            if values:
                changes = steps(np.array(values), tolerance) if quantity == "instructions" \
                    else change_points(np.log(np.maximum(values, 1e-9)))
                found.append(Series(name, quantity, np.array(places), np.array(values), outcomes, errors, changes))
    return found


def names_of(entries: list[dict]) -> list[str]:
    """Of the candidates: their commit, or what was asked for."""
    candidates = [e.get("candidate", {}) for e in entries]
    return [str(c.get("commit", "")[:9] or c.get("name", ""))[-18:] for c in candidates]


def changes_text(series: list[Series], entries: list[dict]) -> list[str]:
    """One line per change: where, what, from which level to which."""
    names, lines = names_of(entries), []
    for s in series:
        bounds = [0, *s.changes, len(s.values)]
        for i, change in enumerate(s.changes):
            before, after = (float(np.median(s.values[bounds[j]:bounds[j + 1]])) for j in (i, i + 1))
            lines.append(f"{names[s.places[change]]}  {s.point}  {s.quantity} {100 * (after / before - 1):+.2f} %")
    return lines


def write_plot(folder: Path, entries: list[dict], tolerance: float) -> list[Path]:
    """history.svg and history.png of the device that was used last."""
    device = entries[-1].get("device")
    shown = [e for e in entries if e.get("device") == device]
    series = series_of(shown, tolerance)
    if not series:
        raise InputError("history: no verdict has times or instructions to plot")
    others = f" ({len(entries) - len(shown)} of other devices left out)" if len(shown) < len(entries) else ""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / "history.svg", folder / "history.png"]
    # Names may hold dollar signs.
    with matplotlib.rc_context({"text.parse_math": False, "svg.hashsalt": "volmark", "svg.fonttype": "path"}):
        figure = _figure(f"Verdicts on {device}{others}", series, names_of(shown))
        for path, metadata in zip(paths, ({"Date": None, "Creator": None}, {"Software": None})):
            figure.savefig(path, dpi=130, metadata=metadata)
    return paths


def _figure(title: str, series: list[Series], names: list[str]) -> Figure:
    points = list(dict.fromkeys(s.point for s in series))
    height = 0.9 + 2.1 * len(points)
    figure = Figure(figsize=(11, height), layout="constrained")
    figure.get_layout_engine().set(rect=(0, _LEGEND / height, 1, 1 - _LEGEND / height))
    figure.suptitle(title, fontsize=10, color=TEXT)
    axes = figure.subplots(len(points), 2, squeeze=False, sharex=True)
    for row, point in zip(axes, points):
        for ax, quantity in zip(row, ("instructions", "cpu_ms")):
            mine = [s for s in series if (s.point, s.quantity) == (point, quantity)]
            _draw(ax, mine[0] if mine else None, point, quantity)
    _name_verdicts(axes[-1], names)
    _legend(figure)
    return figure


def _draw(ax, series: Series | None, point: str, quantity: str) -> None:
    title = "instructions a frame, millions" if quantity == "instructions" else "process CPU, ms a frame"
    if series is not None:
        title += f"; pictures {' to '.join(dict.fromkeys(map(error_text, _extremes(series.errors))))}"
    ax.set_title(f"{point}\n{title}", fontsize=8, color=TEXT, loc="left")
    ax.grid(color=FAINT, linewidth=0.6)
    ax.tick_params(labelsize=7)
    ax.spines[["top", "right"]].set_visible(False)
    if series is None:
        ax.text(0.5, 0.5, "not measured", transform=ax.transAxes, ha="center", fontsize=8, color=_LINE)
        return
    values = series.values / 1e6 if quantity == "instructions" else series.values
    ax.plot(series.places, values, color=_LINE, linewidth=1, zorder=1)
    ax.scatter(series.places, values, s=16, zorder=2, c=[_COLORS.get(o, _LINE) for o in series.outcomes])
    for change in series.changes:
        ax.axvline(series.places[change] - 0.5, color=_CHANGE, linestyle=(0, (4, 2)), linewidth=1.2)
    low, high = values.min(), values.max()
    room = max(0.08 * (high - low), 0.01 * high)  # so that equal values don't look like noise
    ax.set_ylim(low - room, high + room)
    ax.ticklabel_format(axis="y", useOffset=False)


def _extremes(errors: list[float | None]) -> list[float | None]:
    known = [e for e in errors if e is not None]
    return [max(known), min(known)] if known else [None]


def _name_verdicts(row, names: list[str]) -> None:
    every = -(-len(names) // _MOST_NAMED)
    for ax in row:
        ax.set_xticks(range(0, len(names), every), names[::every], rotation=60, ha="right", fontsize=6)


def _legend(figure: Figure) -> None:
    handles = [Line2D([], [], marker="o", linestyle="", markersize=4, color=color, label=outcome)
               for outcome, color in _COLORS.items()]
    handles.append(Line2D([], [], color=_CHANGE, linestyle=(0, (4, 2)), label="level changes"))
    figure.legend(handles=handles, loc="lower center", ncols=len(handles), fontsize=8, frameon=False)

