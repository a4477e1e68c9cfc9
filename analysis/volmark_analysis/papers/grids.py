"""Tables of text cells as Markdown, LaTeX (booktabs) and CSV."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, field
from typing import Callable

from ..tables import tex_text


@dataclass
class TextGrid:
    name: str
    caption: str
    header: list[str]
    rows: list[list[str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    rules: set[int] = field(default_factory=set)
    """Rows with a rule above them, in LaTeX."""


def to_markdown(grid: TextGrid) -> str:
    def line(cells):
        return "| " + " | ".join(c.replace("|", "\\|") for c in cells) + " |"

    lines = [f"**{grid.caption}**", "", line(grid.header), "|" + " --- |" * len(grid.header)]
    lines += [line(row) for row in grid.rows]
    return "\n".join(lines + [""] + [f"- {note}" for note in grid.notes]).rstrip() + "\n"


def to_tex(grid: TextGrid) -> str:
    lines = [r"% needs \usepackage{booktabs}", r"\begin{table}", r"  \centering", f"  \\caption{{{tex_text(grid.caption)}}}",
             f"  \\label{{tab:{grid.name}}}", f"  \\begin{{tabular}}{{{'l' * len(grid.header)}}}", r"    \toprule",
             "    " + " & ".join(map(tex_text, grid.header)) + r" \\", r"    \midrule"]
    for i, row in enumerate(grid.rows):
        if i in grid.rules and i > 0:
            lines.append(r"    \midrule")
        lines.append("    " + " & ".join(map(tex_text, row)) + r" \\")
    lines += [r"    \bottomrule", r"  \end{tabular}"]
    lines += [f"  \\par\\footnotesize {tex_text(note)}" for note in grid.notes]
    return "\n".join(lines + [r"\end{table}"]) + "\n"


def joined(grids: list[TextGrid], writer: Callable[[TextGrid], str]) -> str:
    return "\n".join(map(writer, grids))


def to_csv(header: list[str], rows: list[dict]) -> str:
    """Numbers with nine digits, nothing for None."""
    out = io.StringIO()
    writer = csv.DictWriter(out, header, lineterminator="\n")
    writer.writeheader()
    for row in rows:
        writer.writerow({key: _csv_value(row.get(key)) for key in header})
    return out.getvalue()


def _csv_value(value):
    if value is None:
        return ""
    return f"{value:.9g}" if isinstance(value, float) else value
