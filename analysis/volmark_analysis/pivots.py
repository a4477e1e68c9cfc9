"""Pivot tables: mean frame time and error by one or two axes."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass

from .columns import ABSENT, error_text, number_text
from .load import Experiment
from .points import PointResult, varying_axes
from .tables import caption_of, tex_text


@dataclass
class Pivot:
    row_axis: str
    column_axis: str
    """Empty if the points differ on one axis only."""
    rows: list[str]
    columns: list[str]
    cells: dict[tuple[str, str], str]
    caption: str


def pivot_of(experiment: Experiment, results: list[PointResult]) -> Pivot | None:
    """Mean frame time and PSNR by the axes on which points differ, if these are one or two."""
    axes = varying_axes(results)
    if not 1 <= len(axes) <= 2:
        return None
    row_axis, column_axis = axes[0], axes[1] if len(axes) == 2 else ""
    cells = {}
    for r in results:
        key = (r.labels.get(row_axis, ABSENT), r.labels.get(column_axis, ABSENT) if column_axis else "")
        if key in cells:
            return None
        cells[key] = (f"{number_text(r.statistics['mean_ms'])} ({error_text(r)})" if r.completed
                      else r.status.replace("_", " "))
    return Pivot(row_axis, column_axis, list(dict.fromkeys(k[0] for k in cells)), list(dict.fromkeys(k[1] for k in cells)),
                 cells, f"Mean frame time in ms (lowest PSNR). {caption_of(experiment, results)}")


def pivot_grid(pivot: Pivot) -> list[list[str]]:
    corner = f"{pivot.row_axis} \\ {pivot.column_axis}" if pivot.column_axis else pivot.row_axis
    head = [corner] + [c or "mean, ms (PSNR)" for c in pivot.columns]
    return [head] + [[r] + [pivot.cells.get((r, c), ABSENT) for c in pivot.columns] for r in pivot.rows]


def pivot_to_csv(pivot: Pivot) -> str:
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(pivot_grid(pivot))
    return out.getvalue()


def pivot_to_markdown(pivot: Pivot) -> str:
    head, *body = ([cell.replace("|", "\\|") for cell in row] for row in pivot_grid(pivot))
    lines = [f"**{pivot.caption}**", "", "| " + " | ".join(head) + " |",
             "| --- |" + " ---: |" * (len(head) - 1)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in body]) + "\n"


def pivot_to_tex(pivot: Pivot) -> str:
    head, *body = ([tex_text(cell) for cell in row] for row in pivot_grid(pivot))
    lines = [r"% needs \usepackage{booktabs}", r"\begin{table}", r"  \centering",
             f"  \\caption{{{tex_text(pivot.caption)}}}", r"  \label{tab:pivot}",
             f"  \\begin{{tabular}}{{l{'r' * (len(head) - 1)}}}", r"    \toprule",
             "    " + " & ".join(head) + r" \\", r"    \midrule"]
    lines += ["    " + " & ".join(row) + r" \\" for row in body]
    return "\n".join(lines + [r"    \bottomrule", r"  \end{tabular}", r"\end{table}"]) + "\n"


WRITERS = {"md": pivot_to_markdown, "tex": pivot_to_tex, "csv": pivot_to_csv}
