"""Figures 4, 5, 6 and 7 in the paper's layout."""

from __future__ import annotations

import matplotlib
import numpy as np

from ...columns import number_text
from ...exr import read_exr
from ...plots import _PALETTE, FAINT, finish
from ...points import PointResult
from ..figures import Drawn, caption_text, over_phases, panel_title, panels
from ..measurements import Measurements
from . import published
from .work import work_of

_BITS_COLORS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#7F7F7F")
_SECONDS = 20.0
"""Figure 7: two revolutions."""


def figures_of(fig4: Measurements, fig5: Measurements, fig6: Measurements, fig7: Measurements) -> list[Drawn]:
    return [figure4(fig4), figure4_levels(fig4), figure5(fig5), figure6(fig6), figure7(fig7)]


def _datasets(results: list[PointResult]) -> list[str]:
    return [d for d in published.DATASETS if any(r.labels.get("dataset") == d for r in results)]


def _caption(text: str, results: list[PointResult], datasets) -> str:
    caption = caption_text(text, results, published.stand_in_text(datasets))
    return caption + (" From fewer than 299 poses a tail is not reliable." if any(r.insufficient_frames for r in results) else "")


def _dataset_title(dataset: str) -> str:
    return f"{dataset} ({published.STAND_INS[dataset]})" if dataset in published.STAND_INS else dataset


def _numbers(results: list[PointResult], axis: str) -> list[str]:
    return sorted({r.labels[axis] for r in results}, key=float)


# Figure 4 -----------------------------------------------------------------------------------------------------


def figure4(fig4: Measurements) -> Drawn:
    results = fig4.all_done(initial_level="0")
    datasets = _datasets(results)
    caption = _caption("Figure 4: frame times by leaf size (groups) and bitfield width (colours), from the root, no early exit. Dark: "
                       "mean; light: mean of the slowest 1 %.", results, ("Manix",))
    if not results:
        return Drawn("fig4", caption, None)
    figure, axes = panels(len(datasets))
    for ax, dataset in zip(axes, datasets):
        _draw_bars(ax, [r for r in results if r.labels["dataset"] == dataset])
        panel_title(ax, _dataset_title(dataset))
    axes[0].legend(title="bits", fontsize=8, title_fontsize=8, frameon=False, ncol=2)
    return Drawn("fig4", caption, figure)


def _draw_bars(ax, results: list[PointResult]) -> None:
    leaves, widths = _numbers(results, "leaf"), _numbers(results, "bits")
    width = 0.8 / len(widths)
    for b, bits in enumerate(widths):
        mine = {r.labels["leaf"]: r for r in results if r.labels["bits"] == bits}
        places = [i + (b - (len(widths) - 1) / 2) * width for i, leaf in enumerate(leaves) if leaf in mine]
        shown = [mine[leaf] for leaf in leaves if leaf in mine]
        color = _BITS_COLORS[b % len(_BITS_COLORS)]
        ax.bar(places, [r.statistics["low1_avg_ms"] for r in shown], width * 0.92, color=color, alpha=0.35, zorder=2)
        ax.bar(places, [r.statistics["mean_ms"] for r in shown], width * 0.92, color=color, zorder=3, label=bits)
    ax.set_xticks(range(len(leaves)), [f"{leaf}³" for leaf in leaves])
    finish(ax, "leaf block size", "frame time, ms", grid="y")


def figure4_levels(fig4: Measurements) -> Drawn:
    """Beyond the figure: all initial levels."""
    every = fig4.all_done()
    counts = {bits: len({r.labels["initial_level"] for r in every if r.labels["bits"] == bits}) for bits in _numbers(every, "bits")}
    bits = max(counts, key=lambda b: (counts[b], b == "32"), default="")
    results = [r for r in every if r.labels["bits"] == bits] if counts.get(bits, 0) > 1 else []
    datasets = _datasets(results)
    caption = _caption(f"Beside Figure 4: frame times by initial level at {bits or 'one of the'} bits, one line for each leaf size, no "
                       "early exit.", results, ("Manix",))
    if not results:
        return Drawn("fig4_levels", caption, None)
    figure, axes = panels(len(datasets))
    for ax, dataset in zip(axes, datasets):
        mine = [r for r in results if r.labels["dataset"] == dataset]
        for i, leaf in enumerate(_numbers(mine, "leaf")):
            _draw_levels(ax, [r for r in mine if r.labels["leaf"] == leaf], _PALETTE[i % len(_PALETTE)], "-", f"leaf {leaf}³")
        finish(ax, "initial octree level", "mean frame time, ms")
        ax.set_ylim(bottom=0)
        ax.legend(fontsize=8, frameon=False)
        panel_title(ax, _dataset_title(dataset))
    return Drawn("fig4_levels", caption, figure)


def _draw_levels(ax, results: list[PointResult], color: str, line, label: str, value=lambda r: r.statistics["mean_ms"]) -> None:
    rows = sorted((int(r.labels["initial_level"]), value(r)) for r in results if value(r) is not None)
    ax.plot([level for level, _ in rows], [y for _, y in rows], color=color, ls=line, marker="o", ms=3.5, lw=1.5, label=label)


# Figure 5 -----------------------------------------------------------------------------------------------------


def figure5(fig5: Measurements) -> Drawn:
    results = fig5.all_done()
    caption = _caption(f"Figure 5: iterations (samples plus node tests) of each ray on the kingsnake, from the root, no early exit; "
                       f"black 0, brightest {published.MOST_ITERATIONS}.", results, ())
    maps = [(r, _steps_of(r)) for bits in ("64", "16") for leaf in ("4", "32") for r in fig5.all_done(bits=bits, leaf=leaf)]
    maps = [(r, steps) for r, steps in maps if steps is not None]
    if not maps:
        return Drawn("fig5", caption, None)
    columns = 2 if len(maps) > 1 else 1
    figure, axes = panels(columns, -(-len(maps) // columns), 4.0)
    for letter, ax, (r, steps) in zip("abcd", axes, maps):
        image = ax.imshow(steps / published.MOST_ITERATIONS, cmap=matplotlib.colormaps["inferno"], vmin=0, vmax=1)
        hit = steps[steps > 0]
        mean = number_text(float(hit.mean())) if hit.size else "0"
        panel_title(ax, f"({letter}) {r.labels['leaf']}³ leaves, {r.labels['bits']} bits\nmean of rays {mean}, most {int(steps.max())}")
        ax.set_axis_off()
    for ax in axes[len(maps):]:
        ax.set_axis_off()
    figure.colorbar(image, ax=axes, shrink=0.6, label=f"iterations / {published.MOST_ITERATIONS}")
    return Drawn("fig5", caption, figure)


def _steps_of(result: PointResult) -> np.ndarray | None:
    run = result.completed[0]
    if not run.pictures:
        return None
    return read_exr(run.folder / run.pictures[0]["file"])[0].steps


# Figure 6 -----------------------------------------------------------------------------------------------------


def figure6(fig6: Measurements) -> Drawn:
    results = fig6.all_done()
    datasets = _datasets(results)
    caption = _caption("Figure 6: by initial octree level, 4³ leaves, 64 bits, no early exit. Solid: bidirectional; dashed: top-down. "
                       "Left: mean frame time; right: samples plus node tests of a frame.", results, published.STAND_INS)
    if not results:
        return Drawn("fig6", caption, None)
    figure, (times, work) = panels(2, 1, 3.8)
    for i, dataset in enumerate(datasets):
        for traversal, line in (("bidirectional", "-"), ("top_down", (0, (4, 1.6)))):
            mine = [r for r in results if r.labels["dataset"] == dataset and r.labels["traversal"] == traversal]
            label = _dataset_title(dataset) if traversal == "bidirectional" else "_nolegend_"
            _draw_levels(times, mine, _PALETTE[i % len(_PALETTE)], line, label)
            _draw_levels(work, mine, _PALETTE[i % len(_PALETTE)], line, label, work_of)
    finish(times, "initial octree level", "mean frame time, ms")
    finish(work, "initial octree level", "samples + node tests")
    for ax in (times, work):
        ax.set_ylim(bottom=0)
    times.legend(fontsize=8, frameon=False)
    return Drawn("fig6", caption, figure)


# Figure 7 -----------------------------------------------------------------------------------------------------


def figure7(fig7: Measurements) -> Drawn:
    results = fig7.all_done()
    caption = _caption(f"Figure 7: frame times in stereo over two revolutions in {_SECONDS:g} s while the transfer function changes in "
                       f"every frame. Red: the budget of {published.TIME_BUDGET_MS} ms.", results, ("Manix",))
    if not results:
        return Drawn("fig7", caption, None)
    figure, (ax,) = panels(1, 1, 3.2)
    figure.set_size_inches(7.5, 3.2)
    for i, r in enumerate(results):
        phases, times = over_phases(r)
        ax.plot(_SECONDS * phases, times, color=_PALETTE[i % len(_PALETTE)], lw=1.2, label=r.technique)
    ax.axhline(published.TIME_BUDGET_MS, color="#c00000", ls="--", lw=1.2)
    ax.set_ylim(0, 1.1 * max(published.TIME_BUDGET_MS, *(float(over_phases(r)[1].max()) for r in results)))
    ax.set_xlim(0, _SECONDS)
    finish(ax, "time, s", "frame time, ms")
    ax.grid(True, color=FAINT)
    mean = ", ".join(number_text(r.statistics["mean_ms"]) for r in results)
    return Drawn("fig7", f"{caption} Mean frame time {mean} ms; updates of the transfer function take {_update_text(results)} of it.",
                 figure)


def _update_text(results: list[PointResult]) -> str:
    shares = []
    for r in results:
        update = np.concatenate([run.headline_values("update_ms") for run in r.completed])
        frame = np.concatenate([run.headline_values("frame_ms") for run in r.completed])
        shares.append(f"{100 * np.nanmean(update) / np.nanmean(frame):.2g} %")
    return ", ".join(shares)
