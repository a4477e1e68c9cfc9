"""Figures 6, 7 and 8 in the paper's layout."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...columns import number_text
from ...plots import FAINT, LOG_FROM_RATIO, TEXT, finish, plain_log_ticks
from ...points import PointResult
from ...search.objective import measured
from ..figures import Drawn, caption_text, over_phases, panel_title, panels
from ..measurements import Measurements
from . import published
from .claims import stereo_factor
from .published import CUBES, MARCHING, MESH, OURS
from .sources import (LEVEL_WITHIN, VIEWS, Source, Sources, figure6_of, megapixels, size_of, size_text, sweep_of)


@dataclass(frozen=True)
class _Style:
    color: str
    line: object
    marker: str


_STYLES = {OURS: _Style("#0072B2", "-", "o"), MARCHING: _Style("#D55E00", "-", "s"), MESH: _Style("#009E73", (0, (5, 1.6)), "^"),
           CUBES: _Style("#7F7F7F", (0, (1.2, 1.4)), "D")}
"""Hues of the paper."""
_BANDS = "Bands: 95 % intervals with five processes or more, otherwise lowest and highest of the processes or orbits."
_LEGEND_INCHES = 0.3
_TIMES = {"draw": "draw time, ms", "frame": "draw and update, ms"}


def figures_of(sources: Sources) -> list[Drawn]:
    return [figure6(sources), figure7a(sources["fig7a"]), figure7b(sources["fig7b"]), figure8(sources["fig8"])]


def _caption(text: str, results: list[PointResult], datasets) -> str:
    return caption_text(text, results, published.stand_in_text(datasets))


# Figure 6 and 7 (a) -------------------------------------------------------------------------------------------


def figure6(sources: Sources) -> Drawn:
    shown = {(view, d): figure6_of(sources, d, view).draw for view in VIEWS for d in published.STATIC}
    shown = {key: draw for key, draw in shown.items() if draw.all_done()}
    results = [r for draw in shown.values() for r in draw.all_done()]
    caption = _caption(f"Figure 6: mean draw time by resolution, 16:9; still views as in the paper, and on an orbit. {_BANDS}", results,
                       published.STATIC)
    if not shown:
        return Drawn("fig6", caption, None)
    views, datasets = [v for v in VIEWS if any(v == key[0] for key in shown)], [d for d in published.STATIC if any(d == key[1] for key in shown)]
    figure, axes = panels(len(datasets), len(views))
    for ax, (view, dataset) in zip(axes, [(view, dataset) for view in views for dataset in datasets]):
        panel_title(ax, f"{dataset}, {view}")
        if (view, dataset) in shown:
            _draw_by_size(ax, shown[view, dataset], "draw")
        else:
            ax.set_axis_off()
            ax.text(0.5, 0.5, "not measured", ha="center", color=TEXT, transform=ax.transAxes)
    _legend(figure, axes)
    return Drawn("fig6", caption, figure)


def _draw_by_size(ax, measurements: Measurements, measure: str) -> None:
    lows, highs = [], []
    for method, style in _STYLES.items():
        rows = sorted((megapixels(size_of(r)), measured(r, "mean_ms")) for r in measurements.all_done(method=method))
        if not rows:
            continue
        x, times = [row[0] for row in rows], [row[1] for row in rows]
        ax.fill_between(x, [t.low for t in times], [t.high for t in times], color=style.color, alpha=0.2, lw=0)
        ax.plot(x, [t.value for t in times], color=style.color, ls=style.line, marker=style.marker, ms=3.5, lw=1.6, label=method)
        lows += [t.low for t in times]
        highs += [t.high for t in times]
    ax.set_xlim(left=0)
    _finish_times(ax, "megapixels", measure, min(lows), max(highs))


def _finish_times(ax, x: str, measure: str, lowest: float, highest: float) -> None:
    """Draw times from 0 as in the paper; extracting may take so much longer that only a logarithmic axis shows both."""
    logarithmic = measure == "frame" and highest > LOG_FROM_RATIO * lowest
    if logarithmic:
        ax.set_yscale("log")
        plain_log_ticks(ax.yaxis)
    else:
        ax.set_ylim(0, 1.12 * highest)
    finish(ax, x, _TIMES[measure] + (" (logarithmic)" if logarithmic else ""))


def _legend(figure, axes) -> None:
    """One for all panels, of all methods that are in one of them."""
    entries = {name: handle for ax in axes for handle, name in zip(*ax.get_legend_handles_labels())}
    height = figure.get_figheight()
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - _LEGEND_INCHES / height))
    figure.legend(entries.values(), entries.keys(), loc="upper left", ncol=len(entries), frameon=False, fontsize=8.5, labelcolor=TEXT)


def figure7a(fig7a: Source) -> Drawn:
    results = fig7a.draw.all_done()
    caption = _caption(f"Figure 7 (a): mean times by resolution with a new time step in every frame. Left: draw time, as in the paper; right: "
                       f"with update, so that extracting counts. {_BANDS} Marching cubes is not in the paper's figure.", results,
                       (published.SUPERNOVA,))
    if not results:
        return Drawn("fig7a", caption, None)
    figure, axes = panels(2)
    for ax, measure in zip(axes, _TIMES):
        _draw_by_size(ax, getattr(fig7a, measure), measure)
    _legend(figure, axes)
    return Drawn("fig7a", caption, figure)


# Figure 7 (b) -------------------------------------------------------------------------------------------------


def figure7b(fig7b: Source) -> Drawn:
    results = fig7b.draw.all_done()
    low, high = published.LEVEL_AT - LEVEL_WITHIN, published.LEVEL_AT + LEVEL_WITHIN
    caption = _caption(f"Figure 7 (b): times of each frame by isovalue. Left: draw time, as in the paper; right: with update, so that extracting "
                       f"counts. Lines: median over orbits; bands: lowest and highest orbit; with timed pacing the frames of the first process. "
                       f"Grey: isovalues {low:g} to {high:g}, around which the paper's direct rasterization falls to the level of ray marching. "
                       f"Marching cubes is not in the paper's figure.", results, ("chameleon",))
    if not results:
        return Drawn("fig7b", caption, None)
    figure, axes = panels(2)
    first, last = sweep_of(fig7b.draw)
    for ax, measure in zip(axes, _TIMES):
        ax.axvspan(low, high, color=FAINT, alpha=0.6, lw=0, zorder=0)
        lowest, highest = _draw_sweep(ax, getattr(fig7b, measure), first, last)
        ax.set_xlim(first, last)
        _finish_times(ax, "isovalue", measure, lowest, highest)
    _legend(figure, axes)
    return Drawn("fig7b", caption, figure)


def _draw_sweep(ax, measurements: Measurements, first: float, last: float) -> tuple[float, float]:
    """Returns the lowest and the highest time of a line."""
    lowest, highest = np.inf, 0.0
    for method, style in _STYLES.items():
        for r in measurements.all_done(method=method):
            phases, times = over_phases(r)
            isovalues = first + (last - first) * phases
            if r.orbit_matrices is not None:
                orbits = np.concatenate(r.orbit_matrices)
                ax.fill_between(isovalues, orbits.min(axis=0), orbits.max(axis=0), color=style.color, alpha=0.2, lw=0)
            ax.plot(isovalues, times, color=style.color, ls=style.line, lw=1.5, label=method)
            lowest, highest = min(lowest, times.min()), max(highest, times.max())
    return lowest, highest


# Figure 8 -----------------------------------------------------------------------------------------------------


def figure8(fig8: Source) -> Drawn:
    results = fig8.draw.all_done()
    sizes = " and ".join(dict.fromkeys(size_text(size_of(r)) for r in results))
    caption = _caption(f"Figure 8: what a second view costs, in percent of the draw time of one{f', at {sizes}' if sizes else ''}. Thin lines: 95 % "
                       f"interval with five processes or more, otherwise the spread over poses. Shaded: what the paper found on its volumes, of ray "
                       f"marching about 100 %.", results, published.DATASETS)
    factors = {(d, m): stereo_factor(fig8.draw, d, m) for d in published.DATASETS for m in published.METHODS}
    factors = {key: factor for key, factor in factors.items() if factor is not None}
    if not factors:
        return Drawn("fig8", caption, None)
    figure, (ax,) = panels(1, 1, 3.4)
    figure.set_size_inches(7.5, 3.4)
    datasets = [d for d in published.DATASETS if any(d == key[0] for key in factors)]
    for i, method in enumerate(published.METHODS):
        _draw_overheads(ax, method, 0.27 * (i - 1), {n: factors[d, method] for n, d in enumerate(datasets) if (d, method) in factors})
    ax.axhline(0, color=TEXT, lw=0.8)
    ax.set_xticks(range(len(datasets)), datasets)
    finish(ax, "", "overhead of stereo, %", grid="y")
    _legend(figure, [ax])
    return Drawn("fig8", caption, figure)


def _draw_overheads(ax, method: str, shift: float, factors: dict) -> None:
    """`factors`: by number of the volume."""
    color, half = _STYLES[method].color, 0.125
    low, high = published.STEREO_OVERHEAD.get(method, (published.STEREO_OVERHEAD_OF_MARCHING,) * 2)
    for n, factor in factors.items():
        overhead = 100 * (factor.value - 1)
        ax.bar(n + shift, overhead, 2 * half, color=color, zorder=2, label=method if n == min(factors) else "_nolegend_")
        end = overhead
        if factor.low is not None:
            ax.plot((n + shift,) * 2, (100 * (factor.low - 1), 100 * (factor.high - 1)), color=TEXT, lw=1.1, marker="_", ms=5, zorder=4)
            end = max(end, 100 * (factor.high - 1))
        ax.annotate(number_text(overhead), (n + shift, max(end, 0)), xytext=(0, 3), textcoords="offset points", ha="center", fontsize=7.5,
                    color=TEXT)
        ax.fill_between((n + shift - half, n + shift + half), 100 * low, 100 * high, color=TEXT, alpha=0.28, lw=0.8, zorder=3)
