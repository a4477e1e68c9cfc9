"""report.html: one file that holds everything, to be read by a person."""

from __future__ import annotations

import base64
import hashlib
import json
import os
from importlib import resources
from pathlib import Path
from typing import Sequence

import jinja2
import markupsafe
import numpy as np

from . import __version__, comparisons, heatmaps, plots, sheet, statistics, summary, tables
from .beside import Beside
from .columns import all_columns
from .errors import InputError
from .limits import MOST_COMPARISONS, MOST_LINES_OF_TEXT, MOST_VALUES, first_of
from .load import Experiment
from .pivots import WRITERS as PIVOT_WRITERS
from .pivots import pivot_of
from .points import PointResult, device_of, label_text, varying_axes
from .search.front_plot import front_plot, write_front_plot
from .search.objective import DEFAULT_OBJECTIVE
from .search.pareto import Front, front_table, parameter_fronts


def write_report(experiment: Experiment, results: list[PointResult], path: Path, low1: str = "low1_avg_ms") -> None:
    """Writes report.html and, in the experiment folder, tables/ and plots/. Raises InputError."""
    staged = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        staged.touch()  # a target that can't be written is found before the work
        found = comparisons.technique_comparisons(results)
        fronts = parameter_fronts(results)

        def write_files() -> None:
            write_tables(experiment.folder / "tables", experiment, results, found, fronts, low1)
            plots.write_plots(experiment.folder / "plots", results)
            if fronts:
                write_front_plot(experiment.folder / "plots", front_plot(fronts, DEFAULT_OBJECTIVE), results)

        with Beside(write_files):
            html = render(experiment, results, found, low1, fronts)
        staged.write_text(html, encoding="utf-8")
        os.replace(staged, path)
    except OSError as error:
        raise InputError(f"{error.filename or path}: can't be written ({error.strerror or error})") from None
    except InputError:
        staged.unlink()
        raise


def write_tables(folder: Path, experiment: Experiment, results: list[PointResult], found: list[comparisons.Comparison],
                 fronts: list[Front], low1: str) -> None:
    """Results, work, pivot and comparison tables in all formats; results.csv has every column."""
    full = tables.Table("results", list(all_columns(results).values()), results, "", [])
    shown = tables.results_table(experiment, results, low1)
    work, pivot = tables.work_table(experiment, results), pivot_of(experiment, results)
    folder.mkdir(parents=True, exist_ok=True)
    for suffix, write in tables.WRITERS.items():
        (folder / f"results.{suffix}").write_text(write(full if suffix == "csv" else shown), encoding="utf-8")
        if fronts:
            (folder / f"pareto.{suffix}").write_text(
                write(front_table(experiment, results, fronts, DEFAULT_OBJECTIVE, suffix == "csv")), encoding="utf-8")
        if work is not None:
            (folder / f"work.{suffix}").write_text(write(work), encoding="utf-8")
        if pivot is not None:
            (folder / f"pivot.{suffix}").write_text(PIVOT_WRITERS[suffix](pivot), encoding="utf-8")
    if found:
        (folder / "comparisons.md").write_text(comparisons.to_markdown(found), encoding="utf-8")


def render(experiment: Experiment, results: list[PointResult], found: list[comparisons.Comparison],
           low1: str = "low1_avg_ms", fronts: Sequence[Front] = ()) -> str:
    """The page. `found`: the comparisons of techniques; `fronts`: of error against time."""
    environment = jinja2.Environment(loader=jinja2.FunctionLoader(_template), autoescape=True, trim_blocks=True,
                                     lstrip_blocks=True, undefined=jinja2.StrictUndefined)
    axes = varying_axes(results)
    work = tables.work_table(experiment, results)
    findings, by_scene = summary.findings(results, found)
    picture_sets, pictures_note = sheet.picture_sets(experiment, results)
    script = environment.get_template("report.js").render()
    # The browser runs this one script and loads nothing, whatever the data hold.
    script_hash = f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'"
    return environment.get_template("report.html").render(
        script=markupsafe.Markup(script), script_hash=script_hash,
        experiment=experiment, results=results, version=__version__, facts=_facts(experiment, results),
        findings=findings, findings_by_scene=first_of(by_scene, MOST_LINES_OF_TEXT, "the table has all points"),
        failures=first_of(summary.failures(results), MOST_LINES_OF_TEXT, "the table has all points"),
        warnings=first_of(summary.warnings(experiment, results), MOST_LINES_OF_TEXT, "the runs' run.json have them"),
        comparisons=[_comparison_row(c) for c in found[:MOST_COMPARISONS]], comparison_count=len(found),
        comparison_note=comparisons.explanation(), table=_shown_table(tables.results_table(experiment, results, low1)),
        work=None if work is None else _shown_table(work), grid=heatmaps.grid_of(results),
        best=_best_section(experiment, results, fronts) if fronts else None, map_bar=sheet.bar_uri("grid"),
        plots=_shown_plots(results), picture_sets=picture_sets, pictures_note=pictures_note, scales=sheet.scales(), techniques=_techniques(results),
        provenance=_provenance(results, axes), scenario=json.dumps(experiment.scenario, indent=1),
        definitions=_definitions())


def _template(name: str) -> str:
    return resources.files("volmark_analysis").joinpath("templates", name).read_text(encoding="utf-8")


def _facts(experiment: Experiment, results: list[PointResult]) -> list[tuple[str, str]]:
    """The line under the title."""
    done = [r for r in results if r.completed]
    runs = [run for r in results for run in r.completed + r.others]
    devices = list(dict.fromkeys(", driver ".join(p for p in device_of(run) if p) for run in runs))
    facts = [("Experiment", experiment.name), ("Profile", experiment.profile),
             ("Changed", ", ".join(experiment.assignments)), ("Device", "; ".join(d for d in devices if d)),
             ("Points", f"{len(done)} of {len(results)} with results"),
             ("Made", experiment.created.replace("T", " ").replace("Z", " UTC")),
             ("Program", " ".join(str(experiment.program.get(k, ""))[:12] for k in ("version", "commit")).strip())]
    return [(name, value) for name, value in facts if value]


def _shown_table(table: tables.Table) -> dict:
    """Cells with what they sort by."""
    rows = []
    for row in table.rows:
        cells, failure = tables.cells_of(table, row)
        keys = ["" if failure is not None else _sort_key(c.value(row)) for c in table.columns]
        rows.append({"cells": list(zip(cells, keys)), "failure": failure, "rest": len(table.columns) - len(cells)})
    numeric = [tables.is_numeric(table, c) for c in table.columns]
    return {"caption": table.caption, "columns": list(zip([c.title for c in table.columns], numeric)), "rows": rows,
            "notes": table.notes, "numeric": numeric}


def _sort_key(value) -> str:
    if isinstance(value, float):
        return "1e308" if np.isinf(value) else f"{value:.9g}"
    return "" if value is None else str(value)


def _comparison_row(c: comparisons.Comparison) -> dict:
    return {"where": c.where or "all", "sentence": comparisons.verdict(c)}


def _shown_plots(results: list[PointResult]) -> list[dict]:
    """One small figure per panel, so that it stays readable on a narrow screen; light and dark."""
    styles = plots.styles_of(results)
    return [_shown_plot(plot, styles) for plot in plots.plots_of(results)]


def _shown_plot(plot: plots.Plot, styles) -> dict:
    figures = []
    for panel in plot.panels:
        svg = plots.svg_of(plots.figure_of(plot, [panel], styles, titles=False))
        figures.append({"title": panel.title, "note": panel.note, "alt": f"{plot.title}: {panel.title}",
                        "light": sheet.uri("image/svg+xml", svg), "dark": sheet.uri("image/svg+xml", plots.in_dark(svg))})
    return {"title": plot.title, "explanation": plot.explanation, "note": plot.note, "figures": figures,
            "choice": plot.choice, "folded": plot.name.startswith("counter_")}


def _best_section(experiment: Experiment, results: list[PointResult], fronts: Sequence[Front]) -> dict:
    plot = plots.limited(front_plot(fronts, DEFAULT_OBJECTIVE))
    return {"table": _shown_table(front_table(experiment, results, fronts, DEFAULT_OBJECTIVE, full=False)),
            "plot": _shown_plot(plot, plots.styles_of(results))}


# Techniques, provenance ---------------------------------------------------------------------------------------


def _techniques(results: list[PointResult]) -> list[dict]:
    shown = []
    styles = plots.styles_of(results)
    for name in dict.fromkeys(r.technique for r in results):
        mine = [r for r in results if r.technique == name]
        described = [run.technique for r in mine for run in r.completed + r.others if run.technique]
        parameters: dict[str, dict[str, None]] = {}
        for r in mine:
            technique = r.any_run.config.get("technique") if r.any_run else None
            values = technique.get("parameters") if isinstance(technique, dict) else None
            for key, value in (values or {}).items():
                parameters.setdefault(key, {})[value if isinstance(value, str) else json.dumps(value)] = None
        shown.append({"name": name, "color": styles[id(mine[0])].color, "info": _NO_INFO | (described[0] if described else {}),
                      "parameters": {k: ", ".join(_shortened(list(v))) for k, v in parameters.items()}})
    return shown


def _shortened(values: list[str]) -> list[str]:
    return values if len(values) <= MOST_VALUES else values[:MOST_VALUES] + [f"… ({len(values)} values)"]


_NO_INFO = {"summary": "", "paper": "", "section": "", "draws": "", "history": "", "deterministic": None, "passes": [],
            "generation": [], "counters": []}


def _provenance(results: list[PointResult], axes: list[str]) -> list[dict]:
    """Equal provenance is shown once, with the points it belongs to. What changes from run to run, and the host's name,
    stay in run.json: a report may be published."""
    blocks: dict[str, dict] = {}
    for r in results:
        for run in (r.completed + r.others)[:1]:
            flat = {k: v for k, v in _flat(run.provenance).items() if not _is_left_out(k)}
            block = blocks.setdefault(json.dumps(flat, sort_keys=True), {"facts": flat, "points": []})
            block["points"].append(label_text(r, axes))
    shown = [b for b in blocks.values() if b["facts"]]
    for block in shown:
        block["points"] = first_of(block["points"], 3, "the table has all points")
    return shown


def _is_left_out(key: str) -> bool:
    if key == "host.name":
        return True
    words = key.lower().replace(".", "_").split("_")
    return bool({"started", "load", "available", "frequency"} & set(words))


def _flat(value, prefix: str = "") -> dict[str, str]:
    if not isinstance(value, dict):
        return {prefix: value if isinstance(value, str) else json.dumps(value)}
    flat: dict[str, str] = {}
    for key, inner in value.items():
        flat |= _flat(inner, f"{prefix}.{key}" if prefix else str(key))
    return flat


def _definitions() -> list[tuple[str, str]]:
    band = f"percentiles {statistics.POSE_BAND[0]:g} to {statistics.POSE_BAND[1]:g} over poses"
    return [
        ("frame time, mean_ms", "Mean over the headline frames of frame_ms: the technique's own work, update plus draw. GPU "
         "time between stamps plus host passes; host techniques are host wall time."),
        ("median_ms, p99_ms", "Percentiles 50 and 99, linear between order statistics."),
        ("1 % low, low1_avg_ms", "Mean of the slowest 1 % of frames (rounded up)."),
        ("low1_integral_ms", "The slowest frames until they cover 1 % of the total time: the last one's time."),
        ("fps", "1000 / mean_ms."),
        ("clock_mean_ms", "1 / mean(1/t): what an orbit driven by the clock would have shown."),
        ("insufficient_frames", f"Fewer than {statistics.POSES_FOR_LOW1} distinct poses: the slowest 1 % are too few."),
        ("disturbed", "Frames with involuntary context switches, CPU pressure or stolen time. None is dropped."),
        ("stamps_ratio", "Total of orbits that stamp every pass over that of orbits that stamp only first and last."),
        ("ratio", f"Per pose: mean log time of one over the other; shown are the median and the {band}."),
        ("interval", f"{100 * statistics.CONFIDENCE:.0f} %: processes resampled, then their orbits, poses fixed. With fewer "
         f"than {statistics.REPLICATES_FOR_INTERVAL} processes only the spread is shown."),
        ("PSNR", "Of the pictures over the background, clamped, sRGB-encoded, peak 1; the lowest captured picture counts."),
        ("SSIM, FLIP", "Of the same pictures: structural similarity (1: equal; the lowest picture counts) and FLIP, what "
         "an eye sees when it flips between both (0: equal; the highest picture counts). Only where they were measured."),
        ("depth error", "Distance along the view direction between picture and reference where both hit, in voxels."),
        ("missed, spurious", "Pixels that only the reference, or only the technique, hits; share of the reference's hits."),
        ("iterations", "Steps that a pixel's ray took, as the technique counts them in the EXR channel steps."),
        ("generation", "Host time to build the technique's structures before the first frame; median of the processes."),
        ("memory", "Bytes of device memory (host memory of a host technique) that the technique uses."),
    ]
