"""measured.csv: every point of the experiments, in draw and in frame times; a row without numbers for what was not measured."""

from __future__ import annotations

import numpy as np

from ...points import PointResult
from ...search.objective import measured
from ..measurements import NOT_MEASURED, why_absent
from . import published
from .sources import Source, Sources, megapixels, size_of

CSV_HEADER = ["figure", "dataset", "method", "views", "width", "height", "megapixels", "status", "draw_ms", "draw_low_ms", "draw_high_ms",
              "frame_ms", "frame_low_ms", "frame_high_ms", "bounds", "update_ms", "psnr_db", "device", "device_type", "published_draw_ms"]
_DATASETS = {"fig6a": "CT head", "fig6b": "vertebra", "fig6c": "chameleon", "fig7a": published.SUPERNOVA, "fig7b": "chameleon"}


def csv_rows(sources: Sources) -> list[dict]:
    return [row for figure, source in sources.items() for row in _rows(figure, source)]


def _rows(figure: str, source: Source) -> list[dict]:
    if not source.draw.results and figure == "fig1":
        return [{"figure": figure, "dataset": d, "method": m, "status": NOT_MEASURED, "published_draw_ms": ms}
                for d in published.DATASETS for m, ms in published.DRAW_MS[d].items()]
    if not source.draw.results:
        return [{"figure": figure, "dataset": _DATASETS.get(figure.removesuffix("_orbit")), "status": NOT_MEASURED}]
    return [_row(figure, draw, frame) for draw, frame in zip(source.draw.results, source.frame.results)]


def _row(figure: str, draw: PointResult, frame: PointResult) -> dict:
    dataset = draw.labels.get("dataset") or _DATASETS[figure.removesuffix("_orbit")]
    row = {"figure": figure, "dataset": dataset, "method": draw.labels["method"], "views": draw.labels.get("views", "mono"),
           "status": why_absent(draw) or "completed"}
    if draw.any_run is not None:
        width, height = size_of(draw)
        row |= {"width": width, "height": height, "megapixels": megapixels((width, height))}
        if figure == "fig1" and (width, height) == published.FULL_SIZE:
            row["published_draw_ms"] = published.DRAW_MS[dataset].get(row["method"])
    return row | _times(draw, frame) if draw.completed else row


def _times(draw: PointResult, frame: PointResult) -> dict:
    times = {name: measured(r, "mean_ms") for name, r in (("draw", draw), ("frame", frame))}
    row = {f"{name}{end}_ms": value for name, t in times.items() for end, value in (("", t.value), ("_low", t.low), ("_high", t.high))}
    device = draw.completed[0].provenance.get("device") or {}
    return row | {"bounds": "interval" if times["draw"].is_interval else "spread",
                  "update_ms": float(np.nanmean(np.concatenate([run.headline_values("update_ms") for run in frame.completed]))),
                  "psnr_db": float("inf") if draw.errors.get("identical") else draw.errors.get("psnr_db"),
                  "device": device.get("name"), "device_type": device.get("type")}
