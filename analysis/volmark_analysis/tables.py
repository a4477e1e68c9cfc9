"""Result tables as Markdown, LaTeX (booktabs) and CSV."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from difflib import get_close_matches

from .columns import ABSENT, DAGGER, Column, all_columns, bounds_kind
from .errors import InputError
from .load import Experiment
from .points import PointResult, device_of
from .statistics import CONFIDENCE, POSES_FOR_LOW1

LOW1_NAMES = {"low1_avg_ms": "mean of the slowest 1 % of frames",
              "low1_integral_ms": "frame time reached by the slowest frames that cover 1 % of the time",
              "p99_ms": "99th percentile of frame times"}


@dataclass
class Table:
    name: str
    columns: list[Column]
    rows: list[PointResult]
    caption: str
    notes: list[str]

    def cell(self, row: PointResult, column: Column) -> str:
        value = column.value(row)
        return ABSENT if value is None or value == "" else column.text(row, value)


def results_table(experiment: Experiment, results: list[PointResult], low1: str = "low1_avg_ms",
                  columns: list[str] | None = None) -> Table:
    """One row per point. `columns`: names as in all_columns(), or None for the default choice."""
    known = all_columns(results)
    labels = [name for name, column in known.items() if column.is_label]
    if columns is None:
        names = labels + ["mean_ms", "psnr_db", "ssim", "flip", "depth_p995_voxels", "missed_spurious", low1, "fps",
                          "generation_ms", "memory_bytes"]
        chosen = [known[n] for n in names if n in labels + ["mean_ms", "psnr_db"] or _has_values(known[n], results)]
    else:
        chosen = [known[_known_name(n, known)] for n in columns]
        chosen = _with_error_beside_time(chosen, known)
        chosen = [c for c in chosen if c.is_label] + [c for c in chosen if not c.is_label]
        if not chosen[0].is_label:
            chosen = [known[n] for n in labels] + chosen
    return Table("results", chosen, results, caption_of(experiment, results), notes_of(results, chosen))


def work_table(experiment: Experiment, results: list[PointResult]) -> Table | None:
    """What each point did in a frame: counters and passes. None if nothing was counted."""
    known = all_columns(results)
    done = [r for r in results if r.completed]
    work = [c for n, c in known.items() if n.startswith(("counter.", "pass."))]
    if not work or not done:
        return None
    labels = [c for c in known.values() if c.is_label]
    caption = f"Work per frame, means over an orbit: counters, and times of passes from breakdown orbits. " \
              f"{caption_of(experiment, done)}"
    error = [known["psnr_db"]] if any(c.is_time for c in work) else []
    return Table("work", labels + error + work, done, caption, [])


def _has_values(column: Column, results: list[PointResult]) -> bool:
    return any(column.value(r) not in (None, "") for r in results)


def _known_name(name: str, known: dict[str, Column]) -> str:
    if name in known:
        return name
    near = get_close_matches(name, known, n=1)
    hint = f"; did you mean {near[0]}?" if near else ""
    raise InputError(f"--columns: no column {name!r}{hint} (allowed: {', '.join(known)})")


def _with_error_beside_time(columns: list[Column], known: dict[str, Column]) -> list[Column]:
    """A time is shown only beside the error of the picture it made."""
    if any(c.is_error for c in columns) or not any(c.is_time for c in columns):
        return columns
    first = next(i for i, c in enumerate(columns) if c.is_time)
    return columns[: first + 1] + [known["psnr_db"]] + columns[first + 1:]


def caption_of(experiment: Experiment, results: list[PointResult]) -> str:
    """Experiment, profile, device and driver, and how many frames were timed."""
    def join(values):
        return " and ".join(dict.fromkeys(v for v in values if v))

    runs = [run for r in results for run in r.completed]
    parts = [f'Experiment "{experiment.name}"' + (f", profile {experiment.profile}" if experiment.profile else "")]
    devices = join(f"{name}, driver {driver}" if driver else name for name, driver in map(device_of, runs))
    if devices:
        parts.append(devices)
    done = [r for r in results if r.completed]
    if done:
        parts.append(f"{_span(r.frames_per_orbit for r in done)} frames × {_span(r.orbits for r in done)} orbits × "
                     f"{_span(len(r.completed) for r in done)} processes")
    return "; ".join(parts) + "."


def _span(values) -> str:
    values = sorted(set(values))
    return str(values[0]) if len(values) == 1 else f"{values[0]}{ABSENT}{values[-1]}"


def notes_of(results: list[PointResult], columns: list[Column]) -> list[str]:
    """What a reader must know to read these columns."""
    names = {c.name for c in columns}
    done = [r for r in results if r.completed]
    notes = []
    if "mean_ms" in names and done:
        kinds = list(dict.fromkeys(k for k in map(bounds_kind, done) if k))
        meaning = {"interval": f"[ ] {100 * CONFIDENCE:.0f} % interval (processes, then orbits resampled)",
                   "spread of processes": "( ) lowest and highest mean of the processes, not an interval",
                   "spread of orbits": "( ) lowest and highest mean of the orbits of one process, not an interval"}
        notes.append("; ".join(["Frame time: mean of update and draw"] + [meaning[k] for k in kinds]) + ".")
    for name in names & set(LOW1_NAMES):
        notes.append(f"{'p99' if name == 'p99_ms' else '1 % low'} ({name}): {LOW1_NAMES[name]}.")
    if names & set(LOW1_NAMES) and any(r.insufficient_frames for r in done):
        notes.append(f"{DAGGER} from fewer than {POSES_FOR_LOW1} distinct poses: not a reliable tail.")
    if "psnr_db" in names and any("psnr_db" in r.errors for r in done):
        notes.append("PSNR: lowest of the captured pictures against the reference.")
    if names & {"ssim", "flip"}:
        notes.append("SSIM (1: equal), FLIP (0: equal): worst captured picture.")
    if names & {"depth_p995_voxels", "missed_spurious"}:
        notes.append("Depth error, missed and spurious pixels: worst captured picture; shares of the reference's hits.")
    return notes


def to_csv(table: Table) -> str:
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([c.name for c in table.columns])
    for row in table.rows:
        writer.writerow([_csv_value(c.value(row)) for c in table.columns])
    return out.getvalue()


def _csv_value(value):
    if value is None:
        return ""
    return f"{value:.9g}" if isinstance(value, float) else value


def failure_text(row: PointResult) -> str:
    return f"{row.status.replace('_', ' ')}: {row.reason}"


def cells_of(table: Table, row: PointResult) -> tuple[list[str], str | None]:
    """A row's cells; for a point without a result its labels alone, and why."""
    if row.completed or any(c.name in ("status", "reason") for c in table.columns):
        return [table.cell(row, c) for c in table.columns], None
    labels = [table.cell(row, c) for c in table.columns if c.is_label]
    return labels, failure_text(row) if len(labels) < len(table.columns) else None


def to_markdown(table: Table) -> str:
    def escape(text):
        return text.replace("|", "\\|")

    lines = [f"**{table.caption}**", "", "| " + " | ".join(escape(c.title) for c in table.columns) + " |"]
    lines.append("|" + "|".join(" ---: " if is_numeric(table, c) else " --- " for c in table.columns) + "|")
    for row in table.rows:
        cells, failure = cells_of(table, row)
        if failure is not None:
            cells += [failure] + [ABSENT] * (len(table.columns) - len(cells) - 1)
        lines.append("| " + " | ".join(escape(c) for c in cells) + " |")
    return "\n".join(lines + [""] + [f"- {note}" for note in table.notes]).rstrip() + "\n"


def is_numeric(table: Table, column: Column) -> bool:
    values = [column.value(r) for r in table.rows]
    return any(isinstance(v, (int, float)) for v in values) or column.name == "missed_spurious"


_TEX = {"\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}",
        "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": r"\textless{}", ">": r"\textgreater{}",
        DAGGER: r"$^\dagger$", ABSENT: "--", "×": r"$\times$", "|": r"\textbar{}", '"': "''"}


def tex_text(text: str) -> str:
    return "".join(_TEX.get(c, c) for c in text)


def to_tex(table: Table) -> str:
    alignment = "".join("r" if is_numeric(table, c) else "l" for c in table.columns)
    lines = [r"% needs \usepackage{booktabs}", r"\begin{table}", r"  \centering",
             f"  \\caption{{{tex_text(table.caption)}}}", f"  \\label{{tab:{table.name}}}",
             f"  \\begin{{tabular}}{{{alignment}}}", r"    \toprule",
             "    " + " & ".join(tex_text(c.title) for c in table.columns) + r" \\", r"    \midrule"]
    for row in table.rows:
        cells, failure = cells_of(table, row)
        cells = [tex_text(c) for c in cells]
        if failure is not None:
            cells.append(f"\\multicolumn{{{len(table.columns) - len(cells)}}}{{l}}{{{tex_text(failure)}}}")
        lines.append("    " + " & ".join(cells) + r" \\")
    lines += [r"    \bottomrule", r"  \end{tabular}"]
    lines += [f"  \\par\\footnotesize {tex_text(note)}" for note in table.notes]
    return "\n".join(lines + [r"\end{table}"]) + "\n"


WRITERS = {"md": to_markdown, "tex": to_tex, "csv": to_csv}
