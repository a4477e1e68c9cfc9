"""Plots: frame time over the orbit, means, passes, error against time, counters. One colour per technique everywhere."""

from __future__ import annotations

import colorsys
import io
import re
from dataclasses import dataclass, replace
from typing import Callable

import matplotlib

matplotlib.use("Agg")

import numpy as np  # noqa: E402
from matplotlib.colors import to_hex, to_rgb  # noqa: E402
from matplotlib.figure import Figure  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator  # noqa: E402

from .columns import error_text, number_text  # noqa: E402
from .limits import MOST_BARS, MOST_COUNTER_PLOTS, MOST_LINES, MOST_PANELS, evenly  # noqa: E402
from .points import PointResult, common_text, groups_of, label_text, varying_axes  # noqa: E402

# Okabe and Ito's palette, told apart by colour-blind readers; yellow is left out for its contrast on white.
_PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#7F7F7F")
# Tol's muted scheme: passes must not look like techniques.
_PASS_PALETTE = ("#332288", "#88CCEE", "#DDCC77", "#117733", "#CC6677", "#44AA99", "#AA4499", "#999933", "#882255")
_LINES = ("-", (0, (5, 1.6)), (0, (1.2, 1.4)), (0, (6, 1.5, 1.2, 1.5)))
_MARKERS = "osD^vP*X"
LOG_FROM_RATIO = 12.0
_MOST_BANDS = 6
_MOST_IN_A_PANEL = 8
_MOST_NAMED = 12
"""Points with a legend entry each; beyond, the legend names techniques."""


_PANEL_WIDTH, _LINE = 4.9, 0.195
"""Inches; a line of a legend."""
_LONGEST_NAME = 60

TEXT, FAINT, GROUND = "#22252a", "#d9dce1", "#ffffff"
ON_DARK = {TEXT: "#e3e6ea", FAINT: "#3a3f47", GROUND: "#16181c"}
"""The same for a dark page, see in_dark()."""


@dataclass
class Style:
    color: str
    line: object
    marker: str


@dataclass
class Panel:
    title: str
    results: list[PointResult]
    axes: list[str]
    """Labels that tell the panel's results apart."""
    note: str = ""
    """What of the panel is left out."""
    slots: int = 0
    """Bars that the axis has room for, so that panels side by side have equal bars."""


@dataclass
class Plot:
    """A kind of plot: `draw(ax, panel, styles)` fills one panel; `height(panel)` is in inches."""

    name: str
    title: str
    explanation: str
    panels: list[Panel]
    draw: Callable
    height: Callable[[Panel], float]
    choice: str = ""
    """Plots of one choice show the same points; a reader picks one."""
    note: str = ""
    """Which panels are left out."""


def styles_of(results: list[PointResult]) -> dict[int, Style]:
    """By id of a result: the technique gives the hue, its variants differ in lightness, line and marker."""
    techniques = list(dict.fromkeys(r.technique for r in results))
    scene_axes = {"technique", "scene"}
    styles = {}
    for t, technique in enumerate(techniques):
        mine = [r for r in results if r.technique == technique]
        variant_axes = [a for a in varying_axes(results) if a not in scene_axes]
        variants = list(dict.fromkeys(tuple(r.labels.get(a, "") for a in variant_axes) for r in mine))
        for r in mine:
            v = variants.index(tuple(r.labels.get(a, "") for a in variant_axes))
            color = _lightened(_PALETTE[t % len(_PALETTE)], 0.0 if len(variants) == 1 else 0.45 * v / (len(variants) - 1))
            styles[id(r)] = Style(color, _LINES[v % len(_LINES)], _MARKERS[v % len(_MARKERS)])
    return styles


def _lightened(color: str, share: float) -> str:
    h, l, s = colorsys.rgb_to_hls(*to_rgb(color))
    return to_hex(colorsys.hls_to_rgb(h, l + (1 - l) * share, s))


def panels_of(results: list[PointResult]) -> list[Panel]:
    """Small multiples: by scene, or by comparable group where a scene has too many points for one panel."""
    done = [r for r in results if r.completed]
    by_scene: dict[str, list[PointResult]] = {}
    for r in done:
        by_scene.setdefault(r.scene, []).append(r)
    sets = []
    for members in by_scene.values():
        groups = groups_of(members)
        split = len(members) > _MOST_IN_A_PANEL and 1 < len(groups) < len(members)
        sets += groups if split else [members]
    axes = varying_axes(results)
    return [Panel(common_text(m, axes) or "all points", m, [a for a in varying_axes(m) if a != "scene"]) for m in sets]


def plots_of(results: list[PointResult]) -> list[Plot]:
    """Those for which there is data."""
    panels = panels_of(results)
    if not panels:
        return []
    whole = _scene_panels(results)

    def having(name):
        return _with(whole, lambda r: r.errors.get(name) is not None or name == "psnr_db" and r.errors)

    def bars_height(panel):
        return 0.75 + 0.42 * len(panel.results)

    better = {"higher": "Higher and further left is better.", "lower": "Lower and further left is better."}
    lines = "Lines join the variants of a technique; of many points, those that no other beats in both."
    plots = [
        Plot("mean", "Mean frame time", "Bars: mean of update and draw over all orbits. Thin lines: 95 % interval with five "
             "processes or more, otherwise lowest and highest mean of processes or orbits. Beside the time: the lowest PSNR.",
             _thinned(panels, MOST_BARS), draw_means, bars_height),
        Plot("orbit", "Frame time over the orbit", "Lines: median over orbits at each pose. Bands: lowest and "
             "highest orbit; they may leave the panel.",
             _thinned(panels, MOST_LINES), draw_orbit, lambda p: 2.9)]
    for error, name, direction, label, draw in (
            ("psnr_db", "error_time", "higher", "PSNR", draw_error_time),
            ("ssim", "ssim_time", "higher", "SSIM (1: equal)", _draw_named_error("ssim", "lowest SSIM")),
            ("flip", "flip_time", "lower", "FLIP (0: equal)", _draw_named_error("flip", "highest FLIP")),
            ("depth_p995_voxels", "depth_time", "lower", "Depth error", draw_depth_time)):
        title = "Error against time" if error == "psnr_db" else f"{label.split(' (')[0]} against time"
        plots.append(Plot(name, title, f"{label} of the worst captured picture. {better[direction]} {lines}",
                          having(error), draw, lambda p: 2.9, choice="error"))
    plots.append(
        Plot("passes", "Time by pass", "Mean time of each pass, from the breakdown orbits: stamping every pass may slow a "
             "frame, so the sum can exceed the mean frame time.",
             _thinned(_with(panels, lambda r: r.pass_ms), MOST_BARS), draw_passes, lambda p: bars_height(p) + 0.3))
    return [limited(p) for p in plots + _counter_plots(panels) if p.panels]


def _scene_panels(results: list[PointResult]) -> list[Panel]:
    """As panels_of(), but a scene with very many groups stays whole: points need less room than bars."""
    panels = panels_of(results)
    if len(panels) <= MOST_PANELS:
        return panels
    axes = varying_axes(results)
    scenes: dict[str, list[PointResult]] = {}
    for r in (r for r in results if r.completed):
        scenes.setdefault(r.scene, []).append(r)
    return [Panel(common_text(m, axes) or "all points", m, [a for a in varying_axes(m) if a != "scene"])
            for m in scenes.values()]


def _with(panels: list[Panel], test) -> list[Panel]:
    kept = [replace(p, results=[r for r in p.results if test(r)]) for p in panels]
    return [p for p in kept if p.results]


def _thinned(panels: list[Panel], most: int) -> list[Panel]:
    """Of a panel with very many results the fastest, the slowest and some evenly between stay."""
    def thin(panel):
        if len(panel.results) <= most:
            return panel
        kept = evenly(sorted(panel.results, key=lambda r: r.statistics["mean_ms"]), most)
        return replace(panel, results=kept,
                       note=f"{most} of {len(panel.results)} points, evenly spaced from the fastest to the slowest")
    return [thin(p) for p in panels]


def limited(plot: Plot) -> Plot:
    panels = evenly(plot.panels, MOST_PANELS)
    if len(panels) == len(plot.panels):
        return plot
    return replace(plot, panels=panels, note=f"{len(panels)} of {len(plot.panels)} panels are shown, evenly chosen; "
                   f"the tables and heat maps hold all points.")


def _counter_plots(panels: list[Panel]) -> list[Plot]:
    """One per counter that changes along the orbit."""
    plots = []
    names = dict.fromkeys(name for p in panels for r in p.results for name in r.counters)
    for name in names:
        def draw(ax, panel, styles, name=name):
            draw_counter(ax, panel, styles, name)

        kept = _thinned(_with(evenly(panels, MOST_PANELS), lambda r, n=name: _counter_varies(r, n)), MOST_LINES)
        if kept:
            plots.append(Plot(f"counter_{re.sub(r'[^A-Za-z0-9_.-]', '_', name)}", f"Counter: {name.replace('_', ' ')}",
                              "Per frame, from the counting pass of the first process.", kept, draw, lambda p: 2.6,
                              note="" if len(panels) <= MOST_PANELS else
                              f"{len(kept)} of {len(panels)} panels are shown, evenly chosen."))
        if len(plots) == MOST_COUNTER_PLOTS:
            break
    return plots


def _counter_varies(result: PointResult, name: str) -> bool:
    rows = result.completed[0].counter_rows
    return rows is not None and name in rows.columns and rows[name].nunique() > 1


# What fills a panel ------------------------------------------------------------------------------------------


def draw_means(ax, panel: Panel, styles) -> None:
    means = [r.statistics["mean_ms"] for r in panel.results]
    logarithmic = max(means) > LOG_FROM_RATIO * min(means)
    left = 0.5 * min(means) if logarithmic else 0.0
    reach = max(means)
    for y, r in enumerate(panel.results):
        ax.barh(y, means[y] - left, left=left, height=0.42, color=styles[id(r)].color, zorder=2)
        bounds = r.interval or r.spread
        end = means[y]
        if bounds is not None:
            ax.plot(bounds, (y, y), color=TEXT, lw=1.1, solid_capstyle="butt", marker="|", ms=5, zorder=3)
            end = max(end, bounds[1])
        reach = max(reach, end)
        ax.annotate(f"{number_text(means[y])} ms, {error_text(r)}", (end, y), xytext=(5, 0),
                    textcoords="offset points", va="center", fontsize=8, color=TEXT)
    if logarithmic:
        ax.set_xscale("log")
        ax.set_xlim(left, reach * (reach / min(means)) ** 0.5)
    else:
        ax.set_xlim(0, 1.5 * reach)  # room for the text beside the longest bar
    _bar_names(ax, panel)
    finish(ax, "frame time, ms" + (" (logarithmic)" if logarithmic else ""), "", grid="x")


def draw_orbit(ax, panel: Panel, styles) -> None:
    lowest, highest = np.inf, 0.0
    for r in panel.results:
        style = styles[id(r)]
        matrices = r.orbit_matrices
        if matrices is None:  # timed pacing: every frame has its own pose
            rows = r.completed[0].headline.sort_values("phase")
            phases, middle = rows.phase.to_numpy(), rows.frame_ms.to_numpy()
        else:
            orbits = np.concatenate(matrices)
            phases, middle = r.phases, np.median(orbits, axis=0)
            if len(orbits) > 1 and len(panel.results) <= _MOST_BANDS:
                ax.fill_between(phases, orbits.min(axis=0), orbits.max(axis=0), color=style.color, alpha=0.18, lw=0)
        lowest, highest = min(lowest, middle.min()), max(highest, middle.max())
        ax.plot(phases, middle, color=style.color, ls=style.line, lw=1.6, label=_with_error(r, panel.axes))
    _time_axis(ax, lowest, highest)
    ax.set_xlim(0, 1)
    legend_above(ax, panel)
    finish(ax, "place on the orbit (0 to 1)", "frame time, ms")


def draw_error_time(ax, panel: Panel, styles) -> None:
    finite = [r.errors["psnr_db"] for r in panel.results if "psnr_db" in r.errors]
    # Identical pictures have no PSNR: they get a line of their own above the others.
    top = (max(finite) if finite else 50.0) + 8.0
    _scatter(ax, panel, styles, lambda r: r.errors.get("psnr_db", top))
    if any("psnr_db" not in r.errors for r in panel.results):
        ax.axhline(top, color=FAINT, lw=0.8, ls=":", zorder=0)
        ax.annotate("identical", (0.01, top), xycoords=("axes fraction", "data"), xytext=(0, 3),
                    textcoords="offset points", fontsize=8, color=TEXT)
        ax.margins(y=0.12)
    finish(ax, ax.get_xlabel(), "lowest PSNR, dB")


def _draw_named_error(name: str, label: str):
    def draw(ax, panel: Panel, styles) -> None:
        _scatter(ax, panel, styles, lambda r: r.errors[name], higher_is_better=name == "ssim")
        finish(ax, ax.get_xlabel(), label)
    return draw


def draw_depth_time(ax, panel: Panel, styles) -> None:
    _scatter(ax, panel, styles, lambda r: r.errors["depth_p995_voxels"], higher_is_better=False)
    values = [r.errors["depth_p995_voxels"] for r in panel.results]
    if min(values) > 0 and max(values) > LOG_FROM_RATIO * min(values):
        ax.set_yscale("log")
        plain_log_ticks(ax.yaxis)
    else:
        ax.set_ylim(0, 1.15 * max(values) or 1.0)
    finish(ax, ax.get_xlabel(), "depth error p99.5, voxels")


def _scatter(ax, panel: Panel, styles, y_of, higher_is_better: bool = True) -> None:
    named = len(panel.results) <= _MOST_NAMED
    for technique in dict.fromkeys(r.technique for r in panel.results):
        mine = sorted((r for r in panel.results if r.technique == technique), key=lambda r: r.statistics["mean_ms"])
        joined = mine if named else _unbeaten(mine, y_of, higher_is_better)
        style = styles[id(next(r for r in panel.results if r.technique == technique))]
        ax.plot([r.statistics["mean_ms"] for r in joined], [y_of(r) for r in joined], lw=0.8, zorder=1,
                color=style.color, alpha=0.6)
        if not named:
            ax.plot([r.statistics["mean_ms"] for r in mine], [y_of(r) for r in mine], ls="", marker=style.marker, ms=4,
                    mew=0, color=style.color, alpha=0.6, label=f"{technique}, {len(mine)} points", zorder=3)
    for r in panel.results if named else ():
        style = styles[id(r)]
        ax.plot(r.statistics["mean_ms"], y_of(r), marker=style.marker, ms=7, ls="", mec=GROUND, mew=0.7,
                color=style.color, label=label_text(r, panel.axes), zorder=3)
    means = [r.statistics["mean_ms"] for r in panel.results]
    logarithmic = max(means) > LOG_FROM_RATIO * min(means)
    if logarithmic:
        ax.set_xscale("log")
        plain_log_ticks(ax.xaxis)
    else:
        ax.set_xlim(0, 1.1 * max(means))
    ax.set_xlabel("mean frame time, ms" + (" (logarithmic)" if logarithmic else ""))
    ax.margins(y=0.15)
    legend_above(ax, panel)


def _unbeaten(fastest_first: list[PointResult], y_of, higher_is_better: bool) -> list[PointResult]:
    """Those that have a better error than all that are faster."""
    kept, sign = [], 1 if higher_is_better else -1
    for r in fastest_first:
        if not kept or sign * y_of(r) > sign * y_of(kept[-1]):
            kept.append(r)
    return kept


def draw_passes(ax, panel: Panel, styles) -> None:
    names = list(dict.fromkeys(name for r in panel.results for name in r.pass_ms))
    totals = [sum(r.pass_ms.values()) for r in panel.results]
    lefts = np.zeros(len(panel.results))
    for n, name in enumerate(names):
        widths = np.array([r.pass_ms.get(name, 0.0) for r in panel.results])
        ax.barh(range(len(widths)), widths, left=lefts, height=0.42, label=name.replace("_", " "), zorder=2,
                color=_PASS_PALETTE[n % len(_PASS_PALETTE)], edgecolor=GROUND, linewidth=0.6)
        lefts += widths
    for y, (total, r) in enumerate(zip(totals, panel.results)):
        ax.annotate(f"{number_text(total)} ms, {error_text(r)}", (total, y), xytext=(5, 0),
                    textcoords="offset points", va="center", fontsize=8, color=TEXT)
    ax.set_xlim(0, 1.42 * max(totals))
    _bar_names(ax, panel)
    legend_above(ax, panel, columns=min(4, len(names)))
    finish(ax, "time, ms", "", grid="x")


def draw_counter(ax, panel: Panel, styles, name: str) -> None:
    for r in panel.results:
        rows, style = r.completed[0].counter_rows.sort_values("phase"), styles[id(r)]
        ax.plot(rows.phase, rows[name], color=style.color, ls=style.line, lw=1.6,
                label=label_text(r, panel.axes))
    ax.set_ylim(bottom=0)
    ax.yaxis.set_major_formatter(FuncFormatter(_short_count))
    ax.set_xlim(0, 1)
    legend_above(ax, panel)
    finish(ax, "place on the orbit (0 to 1)", f"{name.replace('_', ' ')} per frame")


# Axes, legends ------------------------------------------------------------------------------------------------


def _short_count(value, _position=None) -> str:
    for limit, unit in ((1e9, " G"), (1e6, " M"), (1e3, " k")):
        if abs(value) >= limit:
            return f"{value / limit:g}{unit}"
    return f"{value:g}"


def _with_error(r: PointResult, axes: list[str]) -> str:
    return f"{label_text(r, axes)} ({error_text(r)})"


def _time_axis(ax, lowest: float, highest: float) -> None:
    if highest > LOG_FROM_RATIO * lowest:
        ax.set_yscale("log")
        plain_log_ticks(ax.yaxis)
    else:
        ax.set_ylim(0, 1.12 * highest)


def plain_log_ticks(axis) -> None:
    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(FuncFormatter(lambda v, _: f"{v:g}"))
    axis.set_minor_locator(NullLocator())


def _bar_names(ax, panel: Panel) -> None:
    """Names above the bars: they stay readable in a narrow column. The first point is on top."""
    ax.set_ylim(max(panel.slots, len(panel.results)) - 0.55, -0.75)
    ax.set_yticks([])
    for y, r in enumerate(panel.results):
        ax.annotate(label_text(r, panel.axes), (0, y - 0.26), xycoords=("axes fraction", "data"), xytext=(1, 1),
                    textcoords="offset points", fontsize=8.5, va="bottom", color=TEXT)
    if ax.get_xscale() == "log":
        plain_log_ticks(ax.xaxis)


def legend_above(ax, panel: Panel, columns: int = 1) -> None:
    handles, names = ax.get_legend_handles_labels()
    if not handles:
        return
    names = [name if len(name) <= _LONGEST_NAME else name[:_LONGEST_NAME - 1] + "…" for name in names]
    columns = columns if columns > 1 else (2 if len(names) > 3 and max(map(len, names)) < 27 else 1)
    ax.legend(handles, names, loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncol=columns, frameon=False,
              fontsize=8, labelcolor=TEXT, handlelength=2.6, borderaxespad=0.2, columnspacing=1.2)


def finish(ax, x: str, y: str, grid: str = "both") -> None:
    ax.set_xlabel(x, color=TEXT, fontsize=9)
    ax.set_ylabel(y, color=TEXT, fontsize=9)
    ax.grid(True, axis=grid, color=FAINT, lw=0.6, zorder=0)
    ax.set_axisbelow(True)
    ax.tick_params(colors=TEXT, labelsize=8.5, length=3)
    for side in ("top", "right") + (("left",) if grid == "x" else ()):
        ax.spines[side].set_visible(False)
    for spine in ax.spines.values():
        spine.set_color(FAINT)
    ax.patch.set_alpha(0)


# Figures ------------------------------------------------------------------------------------------------------


def figure_of(plot: Plot, panels: list[Panel], styles, titles: bool = True) -> Figure:
    """Panels side by side, at most two in a row."""
    columns = min(2, len(panels))
    rows = [panels[i : i + columns] for i in range(0, len(panels), columns)]
    # Legends stand above the axes and need room of their own.
    names = 0 if plot.name == "mean" else 0.16
    heights = [max(plot.height(p) + names * min(len(p.results), _MOST_NAMED) for p in row) + (0.3 if titles else 0)
               for row in rows]
    with matplotlib.rc_context({"text.parse_math": False}):  # names may hold dollar signs
        return _drawn(plot, rows, heights, styles, titles)


def _drawn(plot: Plot, rows: list[list[Panel]], heights: list[float], styles, titles: bool) -> Figure:
    width, height = _PANEL_WIDTH * len(rows[0]), sum(heights)
    figure = Figure(figsize=(width, height))
    figure.patch.set_facecolor(GROUND)
    for i, row in enumerate(rows):
        slots = max(len(panel.results) for panel in row)
        bottom = height - sum(heights[:i + 1])
        for j, panel in enumerate(row):
            ax = figure.add_subplot()
            plot.draw(ax, replace(panel, slots=slots), styles)
            legend = ax.get_legend()
            lines = 0 if legend is None else -(-len(legend.get_texts()) // legend._ncols)
            above = _LINE * lines + 0.1
            if titles:
                title = f"{panel.title}\n{panel.note}" if panel.note else panel.title
                ax.set_title(title, loc="left", fontsize=10, fontweight="bold", color=TEXT, pad=72 * above, y=1.0)
                above += 0.2 * (1 + title.count("\n")) + 0.05
            # Placed by hand: matplotlib's layout engines would take most of the time of a report.
            left, right, below = 0.12 if not len(ax.get_yticks()) else 0.75, 0.15, 0.5
            ax.set_position([(j * _PANEL_WIDTH + left) / width, (bottom + below) / height,
                             (_PANEL_WIDTH - left - right) / width, (heights[i] - above - below) / height])
    return figure


def svg_of(figure: Figure) -> bytes:
    """Equal figures give equal bytes."""
    out = io.BytesIO()
    with matplotlib.rc_context({"svg.hashsalt": "volmark", "svg.fonttype": "path"}):
        figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    return out.getvalue()


def in_dark(svg: bytes) -> bytes:
    """The same figure for a dark page: text and ground swapped, colours lifted."""
    def swapped(match):
        color = match[0].lower()
        return ON_DARK.get(color) or _lightened(color, 0.22)
    return re.sub(r"#[0-9a-fA-F]{6}\b", swapped, svg.decode()).encode()


def write_plots(folder, results: list[PointResult]) -> list[str]:
    """Every plot with all its panels as <name>.svg and <name>.png. Returns the names."""
    folder.mkdir(parents=True, exist_ok=True)
    styles = styles_of(results)
    plots = plots_of(results)
    for plot in plots:
        figure = figure_of(plot, plot.panels, styles)
        (folder / f"{plot.name}.svg").write_bytes(svg_of(figure))
        figure.savefig(folder / f"{plot.name}.png", dpi=150, metadata={"Software": None})
    return [plot.name for plot in plots]
