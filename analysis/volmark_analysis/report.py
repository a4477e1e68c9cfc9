"""report.html: one file that holds everything, to be read by a person."""

from __future__ import annotations

import base64
import json
import os
from dataclasses import dataclass, field
from importlib import resources
from pathlib import Path

import jinja2
import numpy as np

from . import __version__, comparisons, pictures, plots, statistics, summary, tables
from .columns import all_columns, number_text
from .errors import InputError
from .load import Experiment
from .pivots import WRITERS as PIVOT_WRITERS
from .pivots import pivot_grid, pivot_of
from .points import PointResult, common_text, device_of, groups_of, label_text, varying_axes

_PICTURE_BYTES = 6_500_000
"""Roughly what the pictures of a report may take."""
_WIDTHS = (384, 288, 208, 144, 96)
_BYTES_PER_PIXEL = 1.7
_MAP_COLORS = 64


@dataclass
class ShownImage:
    caption: str
    uri: str
    alt: str


@dataclass
class PictureCard:
    """One point's picture of a captured frame, with its errors."""

    title: str
    note: str
    images: list[ShownImage]


@dataclass
class PictureBlock:
    """One captured frame: the reference, then every point that is judged by it."""

    title: str
    reference: ShownImage | None
    cards: list[PictureCard] = field(default_factory=list)
    lowest_psnr: float = float("inf")


@dataclass
class PictureSet:
    title: str
    blocks: list[PictureBlock]
    """The frame with the lowest PSNR first."""


def write_report(experiment: Experiment, results: list[PointResult], path: Path, low1: str = "low1_avg_ms") -> None:
    """Writes report.html and, in the experiment folder, tables/ and plots/. Raises InputError."""
    staged = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        staged.touch()  # a target that can't be written is found before the work
        html = render(experiment, results, low1)
        write_tables(experiment.folder / "tables", experiment, results, low1)
        plots.write_plots(experiment.folder / "plots", results)
        staged.write_text(html, encoding="utf-8")
        os.replace(staged, path)
    except OSError as error:
        raise InputError(f"{error.filename or path}: can't be written ({error.strerror or error})") from None
    except InputError:
        staged.unlink()
        raise


def write_tables(folder: Path, experiment: Experiment, results: list[PointResult], low1: str) -> None:
    """Results, work, pivot and comparison tables in all formats; results.csv has every column."""
    full = tables.Table("results", list(all_columns(results).values()), results, "", [])
    shown = tables.results_table(experiment, results, low1)
    work, pivot = tables.work_table(experiment, results), pivot_of(experiment, results)
    folder.mkdir(parents=True, exist_ok=True)
    for suffix, write in tables.WRITERS.items():
        (folder / f"results.{suffix}").write_text(write(full if suffix == "csv" else shown), encoding="utf-8")
        if work is not None:
            (folder / f"work.{suffix}").write_text(write(work), encoding="utf-8")
        if pivot is not None:
            (folder / f"pivot.{suffix}").write_text(PIVOT_WRITERS[suffix](pivot), encoding="utf-8")
    found = comparisons.technique_comparisons(results)
    if found:
        (folder / "comparisons.md").write_text(comparisons.to_markdown(found), encoding="utf-8")


def render(experiment: Experiment, results: list[PointResult], low1: str = "low1_avg_ms") -> str:
    environment = jinja2.Environment(loader=jinja2.FunctionLoader(_template), autoescape=True, trim_blocks=True,
                                     lstrip_blocks=True, undefined=jinja2.StrictUndefined)
    axes = varying_axes(results)
    work = tables.work_table(experiment, results)
    pivot = pivot_of(experiment, results) if len(axes) == 2 else None
    found, found_by_scene = summary.findings(results)
    picture_sets = _picture_sets(experiment, results, axes)
    return environment.get_template("report.html").render(
        experiment=experiment, results=results, version=__version__, facts=_facts(experiment, results),
        findings=found, findings_by_scene=found_by_scene, failures=summary.failures(results),
        warnings=summary.warnings(experiment, results),
        comparisons=[_comparison_row(c) for c in comparisons.technique_comparisons(results)],
        comparison_note=comparisons.explanation(), table=_shown_table(tables.results_table(experiment, results, low1)),
        work=None if work is None else _shown_table(work), pivot=None if pivot is None else pivot_grid(pivot),
        plots=_shown_plots(results), picture_sets=picture_sets,
        scales=_scales(), techniques=_techniques(results), provenance=_provenance(results, axes),
        scenario=json.dumps(experiment.scenario, indent=1), definitions=_definitions())


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
    styles, shown = plots.styles_of(results), []
    for plot in plots.plots_of(results):
        figures = []
        for panel in plot.panels:
            svg = plots.svg_of(plots.figure_of(plot, [panel], styles, titles=False))
            figures.append({"title": panel.title, "alt": f"{plot.title}: {panel.title}",
                            "light": _uri("image/svg+xml", svg), "dark": _uri("image/svg+xml", plots.in_dark(svg))})
        shown.append({"title": plot.title, "explanation": plot.explanation, "figures": figures,
                      "folded": plot.name.startswith("counter_")})
    return shown


def _uri(kind: str, data: bytes) -> str:
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


# Pictures -----------------------------------------------------------------------------------------------------


def _picture_sets(experiment: Experiment, results: list[PointResult], axes: list[str]) -> list[PictureSet]:
    """Points of a group that share their references stand side by side. The first process' pictures are shown."""
    widest = _affordable_width(results)
    sets: dict[tuple, list[PointResult]] = {}
    for number, group in enumerate(groups_of(results)):
        for r in group:
            if r.completed and r.completed[0].pictures:
                references = tuple(str(p.get("reference_file") or "") for p in r.completed[0].pictures)
                sets.setdefault((number, references), []).append(r)
    shown = []
    for members in sets.values():
        own_axes = varying_axes(members)
        blocks: dict[tuple, PictureBlock] = {}
        for r in members:
            for captured in pictures.captured_frames(experiment, r.completed[0], widest):
                _add_card(blocks, r, own_axes, captured)
        ordered = sorted(blocks.values(), key=lambda b: b.lowest_psnr)
        draws = members[0].completed[0].technique.get("draws", "")
        title = ", ".join(p for p in (common_text(members, axes), draws if draws != "both" else "") if p)
        shown.append(PictureSet(title or "all points", ordered))
    return shown


def _affordable_width(results: list[PointResult]) -> int:
    rows = [(r, row) for r in results if r.completed for row in r.completed[0].pictures]
    for width in _WIDTHS:
        pixels = 0.0
        for r, _ in rows:
            size = r.completed[0].config.get("resolution")
            wide, high = size if isinstance(size, list) and len(size) == 2 else (512, 512)
            pixels += 2 * min(width, wide) ** 2 * high / wide
        if pixels * _BYTES_PER_PIXEL * 4 / 3 < _PICTURE_BYTES:
            break
    return width


def _add_card(blocks: dict[tuple, PictureBlock], r: PointResult, axes: list[str], captured) -> None:
    row = captured.row
    key = (row["frame"], row["view"])
    name = label_text(r, axes)
    if key not in blocks:
        place = f"frame {row['frame']}" + (f", view {row['view']}" if _is_stereo(r) else "")
        place += f", {row['phase']:.0%} of the orbit".replace("%", " %") if row.get("phase") is not None else ""
        reference = None
        if captured.reference is not None:
            reference = ShownImage("", _uri("image/png", pictures.png_of(captured.reference)),
                                   f"reference, {place}")
        blocks[key] = PictureBlock(place, reference)
    block = blocks[key]
    images = [ShownImage("picture", _uri("image/png", pictures.png_of(captured.frame)), f"{name}, {block.title}")]
    for part, caption in (("error", "colour error"), ("depth", "depth error")):
        pixels = getattr(captured, part)
        if pixels is not None:
            images.append(ShownImage(caption, _uri("image/png", pictures.png_of(pixels, _MAP_COLORS)),
                                     f"{caption} of {name}, {block.title}"))
    block.cards.append(PictureCard(name, _picture_note(r, row), images))
    if row.get("psnr_db") is not None:
        block.lowest_psnr = min(block.lowest_psnr, row["psnr_db"])


def _is_stereo(r: PointResult) -> bool:
    return any(p["view"] for p in r.completed[0].pictures)


def _picture_note(r: PointResult, row: dict) -> str:
    parts = [f"{number_text(r.statistics['mean_ms'])} ms"]
    if row.get("psnr_db") is not None:
        parts.append(f"{row['psnr_db']:.1f} dB")
    elif row.get("identical"):
        parts.append("identical")
    else:
        parts.append("error not measured")
    if row.get("depth_p995_voxels") is not None:
        parts.append(f"depth p99.5 {number_text(row['depth_p995_voxels'])} voxels")
    for name in ("missed", "spurious"):
        if row.get(f"{name}_share"):
            parts.append(f"{name} {number_text(100 * row[f'{name}_share'], 2)} %")
    if r.history == "visible" and row.get("cumulative_ms") is not None:
        parts.append(f"after {number_text(row['cumulative_ms'])} ms of frames")
    return ", ".join(parts)


def _scales() -> dict:
    def scale(kind, limits, ticks):
        low, high = np.log10(limits)
        return {"uri": _uri("image/png", pictures.png_of(pictures.scale_bar(kind))),
                "ticks": [(text, round(100 * (np.log10(value) - low) / (high - low), 2)) for value, text in ticks]}

    return {"error": scale("error", pictures.COLOR_ERROR_RANGE,
                           [(1e-3, "0.1 %"), (1 / 255, "1/255"), (1e-1, "10 %"), (1.0, "100 %")]),
            "depth": scale("depth", pictures.DEPTH_ERROR_RANGE,
                           [(1e-3, "0.001"), (1e-2, "0.01"), (0.1, "0.1"), (1.0, "1"), (10.0, "10 voxels")]),
            "missed": "#%02x%02x%02x" % pictures.MISSED, "spurious": "#%02x%02x%02x" % pictures.SPURIOUS,
            "nothing": "#%02x%02x%02x" % pictures.NOTHING}


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
                      "parameters": {k: ", ".join(v) for k, v in parameters.items()}})
    return shown


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
    return [b for b in blocks.values() if b["facts"]]


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
        ("depth error", "Distance along the view direction between picture and reference where both hit, in voxels."),
        ("missed, spurious", "Pixels that only the reference, or only the technique, hits; share of the reference's hits."),
        ("generation", "Host time to build the technique's structures before the first frame; median of the processes."),
        ("memory", "Bytes of device memory (host memory of a host technique) that the technique uses."),
    ]
