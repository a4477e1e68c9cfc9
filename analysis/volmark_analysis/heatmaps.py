"""Grids as heat maps: frame time and error by two axes, one map for every combination of the others."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import Callable

import matplotlib
import numpy as np
from matplotlib.colors import to_hex

from .columns import ABSENT, error_text, number_text
from .pictures import MAPS
from .points import PointResult, varying_axes

MOST_CELLS = 2000
"""Of all maps together; what is beyond is said."""
_LOG_FROM_RATIO = 5.0


@dataclass
class Shade:
    """A quantity that can colour the cells. One scale for all maps, so that they can be compared."""

    title: str
    low: float
    high: float
    logarithmic: bool
    text: Callable[[float], str]

    def place(self, value: float) -> float:
        """0 at the lowest value, 1 at the highest."""
        if self.high == self.low:
            return 0.5
        value = min(max(value, self.low), self.high)
        if self.logarithmic:
            return float(np.log(value / self.low) / np.log(self.high / self.low))
        return (value - self.low) / (self.high - self.low)


@dataclass
class Cell:
    time: str
    error: str
    """Of the same picture, or why there is no time."""
    colors: list[tuple[str, str]]
    """Ground and ink, one pair for each shade; empty without a result."""


@dataclass
class HeatMap:
    title: str
    rows: list[str]
    columns: list[str]
    cells: dict[tuple[str, str], Cell] = field(default_factory=dict)


@dataclass
class Grid:
    row_axis: str
    column_axis: str
    shades: list[Shade]
    maps: list[HeatMap]
    maps_left_out: int


def grid_of(results: list[PointResult]) -> Grid | None:
    """None unless points differ on two axes or more and some completed."""
    axes = varying_axes(results)
    if len(axes) < 2 or not any(r.completed for r in results):
        return None
    column_axis, row_axis = sorted(axes, key=lambda a: _extent(a, results), reverse=True)[:2]
    shades = _shades(results)
    others = [a for a in axes if a not in (row_axis, column_axis)]
    # A technique has the axes of its own parameters: those it lacks do not belong into its titles.
    by_title: dict[str, list[PointResult]] = {}
    for r in results:
        title = ", ".join(r.labels[a] if a in ("technique", "scene") else f"{a} {r.labels[a]}"
                          for a in others if r.labels.get(a))
        by_title.setdefault(title, []).append(r)
    maps = [_map_of(title, members, row_axis, column_axis, shades) for title, members in by_title.items()]
    kept, cells = [], 0
    for heat_map in maps:
        cells += len(heat_map.rows) * len(heat_map.columns)
        if cells <= MOST_CELLS:
            kept.append(heat_map)
    return Grid(row_axis, column_axis, [shade for shade, _ in shades], kept, len(maps) - len(kept)) if kept else None


def _extent(axis: str, results: list[PointResult]) -> tuple[bool, int]:
    """Axes of numbers come before axes of names, then those with more values."""
    values = {r.labels[axis] for r in results if axis in r.labels}
    return all(_is_number(v) for v in values), len(values)


def _is_number(text: str) -> bool:
    try:
        float(text.strip("[] ").split(",")[0])  # a resolution counts as one
    except ValueError:
        return False
    return True


def _shades(results: list[PointResult]) -> list[tuple[Shade, Callable]]:
    """Each with what it takes from a result: a number or None. Identical pictures have an infinite PSNR."""
    def psnr(r):
        return float("inf") if r.errors.get("identical") else r.errors.get("psnr_db")

    quantities = [("frame time, ms", lambda r: r.statistics["mean_ms"], number_text),
                  ("lowest PSNR, dB", psnr, lambda v: f"{v:.1f}")]
    quantities += [(title, lambda r, name=name: r.errors.get(name), number_text)
                   for name, title in (("ssim", "lowest SSIM"), ("flip", "highest FLIP"),
                                       ("depth_p995_voxels", "depth error p99.5, voxels"))]
    done = [r for r in results if r.completed]
    shades = []
    for title, value_of, text in quantities:
        values = [v for v in map(value_of, done) if v is not None and np.isfinite(v)]
        if values:
            low, high = min(values), max(values)
            shades.append((Shade(title, low, high, low > 0 and high > _LOG_FROM_RATIO * low, text), value_of))
    return shades


def _map_of(title: str, members: list[PointResult], row_axis: str, column_axis: str, shades) -> HeatMap:
    def values(axis):
        return list(dict.fromkeys(r.labels.get(axis, ABSENT) for r in members))

    heat_map = HeatMap(title, values(row_axis), values(column_axis))
    for r in members:
        key = (r.labels.get(row_axis, ABSENT), r.labels.get(column_axis, ABSENT))
        if r.completed:
            colors = [_colors(shade, value_of(r)) for shade, value_of in shades]
            heat_map.cells[key] = Cell(number_text(r.statistics["mean_ms"]), error_text(r), colors)
        else:
            heat_map.cells[key] = Cell(ABSENT, r.status.replace("_", " "), [])
    return heat_map


def _colors(shade: Shade, value: float | None) -> tuple[str, str]:
    return ("none", "inherit") if value is None else _color_table()[round(255 * shade.place(value))]


@cache
def _color_table() -> list[tuple[str, str]]:
    """Ground and ink from the lowest to the highest value."""
    colors = matplotlib.colormaps[MAPS["grid"]](np.linspace(0, 1, 256))[:, :3]
    linear = np.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)
    # Black or white, whichever has the larger contrast: (lighter + 0.05) / (darker + 0.05).
    return [(to_hex(color), "#000" if (luminance + 0.05) ** 2 > 1.05 * 0.05 else "#fff")
            for color, luminance in zip(colors, linear @ (0.2126, 0.7152, 0.0722))]
