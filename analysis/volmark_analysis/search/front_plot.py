"""The plot of Pareto fronts, a panel for each contest."""

from __future__ import annotations

from pathlib import Path

from ..limits import evenly
from ..plots import (FAINT, GROUND, LOG_FROM_RATIO, TEXT, Panel, Plot, figure_of, finish, legend_above, plain_log_ticks,
                     styles_of, svg_of)
from ..points import PointResult, label_text, varying_axes
from .candidates import error_of
from .objective import HIGHER_IS_BETTER
from .pareto import DOMINATED, FRONT, UNDECIDED, Front, pictures_of

_MOST_NAMED = 10
_MOST_BOUNDS = 60
"""Of dominated points; of more, the bounds would hide the front's."""
_ABOVE_ALL = 8.0
"""dB: where identical pictures, which have no PSNR, are drawn above the others."""
_LEAST_RANGE = 4.0
"""dB of the axis."""
_NAMES = {"psnr_db": "lowest PSNR, dB", "ssim": "lowest SSIM (1: equal)", "flip": "highest FLIP (0: equal)",
          "depth_p995_voxels": "depth error p99.5, voxels", "mse": "highest mean square error"}


def front_plot(fronts: list[Front], objective: str) -> Plot:
    of_panel = {front.contest.title: front for front in fronts}
    better = "Higher" if HIGHER_IS_BETTER[fronts[0].error] else "Lower"
    panels = [Panel(title, front.contest.points,
                    [a for a in varying_axes(front.contest.points) if a not in front.contest.where])
              for title, front in of_panel.items()]
    return Plot("pareto", "Pareto front",
                f"{better} and further left is better. Full: points that no other beats in both, joined and numbered from the "
                f"fastest. Hollow: undecided by these measurements. Pale: beaten. Horizontal lines: bounds of the time; "
                f"vertical lines: from the worst to the best captured picture.", panels,
                lambda ax, panel, styles: _draw(ax, panel, styles, of_panel[panel.title], objective), lambda p: 3.4)


def write_front_plot(folder: Path, plot: Plot, results: list[PointResult]) -> list[Path]:
    figure = figure_of(plot, plot.panels, styles_of(results))
    folder.mkdir(parents=True, exist_ok=True)
    svg, png = folder / f"{plot.name}.svg", folder / f"{plot.name}.png"
    svg.write_bytes(svg_of(figure))
    figure.savefig(png, dpi=150, metadata={"Software": None})
    return [svg, png]


class _Heights:
    """Where errors are drawn."""

    def __init__(self, front: Front):
        self.error = front.error
        finite = [e for e in (error_of(r, front.error) for r in front.contest.points) if e < float("inf")]
        self.top = max(finite, default=50.0) + _ABOVE_ALL
        self.has_identical = len(finite) < len(front.contest.points)

    def of(self, r: PointResult) -> float:
        return min(error_of(r, self.error), self.top)

    def ends(self, r: PointResult) -> tuple[float, float]:
        """Worst and best captured picture."""
        sign = 1 if HIGHER_IS_BETTER[self.error] else -1
        pictures = pictures_of(r, self.error).values()
        return self.of(r), sign * min(max(best for _, best in pictures), self.top)


def _draw(ax, panel: Panel, styles, front: Front, objective: str) -> None:
    heights, times = _Heights(front), front.contest.times
    members, undecided, dominated = map(front.members, (FRONT, UNDECIDED, DOMINATED))
    for points, alpha, with_bounds in ((dominated, 0.25, len(dominated) <= _MOST_BOUNDS), (undecided, 0.8, True),
                                       (members, 1.0, True)):
        if not points:
            continue
        # Collections: a thousand artists would take longer than all other plots of a report.
        xs, ys = [times[id(r)].value for r in points], [heights.of(r) for r in points]
        colors = [styles[id(r)].color for r in points]
        ax.scatter(xs, ys, s=42 if points is members else 25, c=GROUND if points is undecided else colors, alpha=alpha, zorder=4,
                   edgecolors=GROUND if points is members else colors, linewidths=0 if points is dominated else 0.8)
        if with_bounds:
            ax.hlines(ys, *zip(*((times[id(r)].low, times[id(r)].high) for r in points)), colors, lw=1, alpha=alpha, zorder=2)
            ax.vlines(xs, *zip(*(heights.ends(r) for r in points)), colors, lw=1, alpha=alpha, zorder=2)
    ax.plot([times[id(r)].value for r in members], [heights.of(r) for r in members], color=TEXT, lw=1, zorder=3)
    numbered = evenly(list(enumerate(members, start=1)), _MOST_NAMED)
    for number, r in numbered:
        ax.annotate(str(number), (times[id(r)].value, heights.of(r)), xytext=(-4, 4), textcoords="offset points", ha="right",
                    fontsize=8, color=TEXT, zorder=5)
        ax.plot([], [], marker="o", ls="", color=styles[id(r)].color, label=f"{number}  {label_text(r, panel.axes)}")
    for points, name, look in ((undecided, UNDECIDED, {"mfc": GROUND}), (dominated, DOMINATED, {"alpha": 0.25})):
        if points:
            ax.plot([], [], marker="o", ls="", color=TEXT, label=f"{len(points)} {name}", **look)
    _axes(ax, [t for r in front.contest.points for t in (times[id(r)].low, times[id(r)].high)], heights)
    legend_above(ax, panel)
    finish(ax, objective.removesuffix("_ms").replace("_", " ") + " frame time, ms", _NAMES[front.error])


def _axes(ax, times: list[float], heights: _Heights) -> None:
    if max(times) > LOG_FROM_RATIO * min(times):
        ax.set_xscale("log")
        plain_log_ticks(ax.xaxis)
    else:
        ax.set_xlim(0, 1.1 * max(times))
    ax.margins(y=0.12)
    low, high = ax.get_ylim()
    if heights.error == "psnr_db" and high - low < _LEAST_RANGE:  # tenths of a dB would look like much
        ax.set_ylim(0.5 * (low + high - _LEAST_RANGE), 0.5 * (low + high + _LEAST_RANGE))
    if heights.has_identical:
        ax.axhline(heights.top, color=FAINT, lw=0.8, ls=":", zorder=0)
        ax.annotate("identical", (0.01, heights.top), xycoords=("axes fraction", "data"), xytext=(0, 3),
                    textcoords="offset points", fontsize=8, color=TEXT)
