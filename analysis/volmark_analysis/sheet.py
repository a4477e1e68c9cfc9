"""The picture sheet of a report: captured frames beside their reference, with maps of error and of iterations."""

from __future__ import annotations

import base64
from dataclasses import dataclass, field

import numpy as np

from . import pictures
from .columns import number_text
from .limits import MOST_CARDS, MOST_MEMBERS, MOST_SETS, evenly
from .load import Experiment
from .points import PointResult, common_text, groups_of, label_text, varying_axes

_PICTURE_BYTES = 6_500_000
"""Roughly what the pictures of a report may take."""
_WIDTHS = (512, 384, 288, 208, 144, 96)
_BYTES_PER_PIXEL = 1.7
_MAP_COLORS = 64


@dataclass
class ShownImage:
    name: str
    """Of point and part, for choosing one of a block."""
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
    note: str
    """What is left out."""
    blocks: list[PictureBlock]
    """The frame with the lowest PSNR first."""
    steps_scale: dict | None
    """Of the set's iteration maps."""


@dataclass
class _Members:
    """Points of a group that share their references, and the captured frames of each that are shown."""

    results: list[PointResult]
    all_results: int
    frames: set[tuple[int, int]] | None = None
    """Frame and view; None: all."""

    def rows_of(self, r: PointResult) -> list[dict]:
        return [p for p in r.completed[0].pictures if self.frames is None or (p["frame"], p["view"]) in self.frames]


def uri(kind: str, data: bytes) -> str:
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


def picture_sets(experiment: Experiment, results: list[PointResult]) -> tuple[list[PictureSet], str]:
    """Points of a group that share their references stand side by side. The first process' pictures are shown. Also
    says what is left out."""
    sets, note = _chosen(_members(results))
    widest = _affordable_width(sets)
    axes = varying_axes(results)
    return [_picture_set(experiment, members, axes, widest) for members in sets], note


def _members(results: list[PointResult]) -> list[_Members]:
    sets: dict[tuple, list[PointResult]] = {}
    for number, group in enumerate(groups_of(results)):
        for r in group:
            if r.completed and r.completed[0].pictures:
                references = tuple(str(p.get("reference_file") or "") for p in r.completed[0].pictures)
                sets.setdefault((number, references), []).append(r)
    return [_Members(members, len(members)) for members in sets.values()]


def _chosen(sets: list[_Members]) -> tuple[list[_Members], str]:
    """All, or of many: sets evenly spaced from the lowest to the highest PSNR, of each the points likewise, and of
    these the frame with the set's lowest PSNR."""
    if sum(len(m.rows_of(r)) for m in sets for r in m.results) <= MOST_CARDS:
        return sets, ""
    kept = evenly(sorted(sets, key=lambda m: min(map(_lowest_psnr, m.results))), MOST_SETS)
    for m in kept:
        m.results = evenly(sorted(m.results, key=_lowest_psnr), MOST_MEMBERS)
        worst = min((p for r in m.results for p in r.completed[0].pictures), key=_psnr_of)
        m.frames = {(worst["frame"], worst["view"])}
    shown, all_points = sum(len(m.results) for m in kept), sum(m.all_results for m in sets)
    return kept, (f"{shown} of {all_points} points are shown, from the lowest to the highest PSNR and evenly between, "
                  f"each with one frame: the one with the lowest PSNR of its group. All pictures are in runs/ as EXR.")


def _psnr_of(row: dict) -> float:
    return row["psnr_db"] if row.get("psnr_db") is not None else float("inf")


def _lowest_psnr(r: PointResult) -> float:
    return min(map(_psnr_of, r.completed[0].pictures))


def _affordable_width(sets: list[_Members]) -> int:
    for width in _WIDTHS:
        pixels = 0.0
        for m in sets:
            for r in m.results:
                size = r.completed[0].config.get("resolution")
                wide, high = size if isinstance(size, list) and len(size) == 2 else (512, 512)
                pixels += len(m.rows_of(r)) * 2 * min(width, wide) ** 2 * high / wide
        if pixels * _BYTES_PER_PIXEL * 4 / 3 < _PICTURE_BYTES:
            break
    return width


def _picture_set(experiment: Experiment, members: _Members, axes: list[str], widest: int) -> PictureSet:
    own_axes = varying_axes(members.results)
    captured = [(r, shown) for r in members.results
                for shown in pictures.captured_frames(experiment, r.completed[0], widest, members.rows_of(r))]
    most_steps = max((float(c.steps.max()) for _, c in captured if c.steps is not None), default=0.0)
    blocks: dict[tuple, PictureBlock] = {}
    for r, shown in captured:
        _add_card(blocks, r, own_axes, shown, most_steps)
    draws = members.results[0].completed[0].technique.get("draws", "")
    title = ", ".join(p for p in (common_text(members.results, axes), draws if draws != "both" else "") if p)
    note = "" if len(members.results) == members.all_results else \
        f"{len(members.results)} of {members.all_results} points, from the lowest to the highest PSNR."
    return PictureSet(title or "all points", note, sorted(blocks.values(), key=lambda b: b.lowest_psnr),
                      _steps_scale(most_steps) if most_steps > 0 else None)


def _add_card(blocks: dict[tuple, PictureBlock], r: PointResult, axes: list[str], captured, most_steps: float) -> None:
    row = captured.row
    key = (row["frame"], row["view"])
    name = label_text(r, axes)
    if key not in blocks:
        place = f"frame {row['frame']}" + (f", view {row['view']}" if _is_stereo(r) else "")
        place += f", {row['phase']:.0%} of the orbit".replace("%", " %") if row.get("phase") is not None else ""
        reference = None
        if captured.reference is not None:
            reference = ShownImage("reference", "", uri("image/png", pictures.png_of(captured.reference)),
                                   f"reference, {place}")
        blocks[key] = PictureBlock(place, reference)
    block = blocks[key]
    maps = {"colour error": captured.error, "depth error": captured.depth,
            "iterations": None if captured.steps is None or most_steps <= 0
            else pictures.steps_map(captured.steps, most_steps)}
    images = [ShownImage(name, "picture", uri("image/png", pictures.png_of(captured.frame)), f"{name}, {block.title}")]
    images += [ShownImage(f"{name}: {caption}", caption, uri("image/png", pictures.png_of(pixels, _MAP_COLORS)),
                          f"{caption} of {name}, {block.title}")
               for caption, pixels in maps.items() if pixels is not None]
    block.cards.append(PictureCard(name, _picture_note(r, row), images))
    block.lowest_psnr = min(block.lowest_psnr, _psnr_of(row))


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
    parts += [f"{title} {number_text(row[name])}" for name, title in (("ssim", "SSIM"), ("flip", "FLIP"))
              if row.get(name) is not None]
    if row.get("depth_p995_voxels") is not None:
        parts.append(f"depth p99.5 {number_text(row['depth_p995_voxels'])} voxels")
    for name in ("missed", "spurious"):
        if row.get(f"{name}_share"):
            parts.append(f"{name} {number_text(100 * row[f'{name}_share'], 2)} %")
    if r.history == "visible" and row.get("cumulative_ms") is not None:
        parts.append(f"after {number_text(row['cumulative_ms'])} ms of frames")
    return ", ".join(parts)


def bar_uri(kind: str) -> str:
    return uri("image/png", pictures.png_of(pictures.scale_bar(kind)))


def _steps_scale(most: float) -> dict:
    return {"uri": bar_uri("steps"),
            "ticks": [("0", 0.0), (number_text(most / 2), 50.0), (number_text(most), 100.0)]}


def scales() -> dict:
    """Colour bars of the maps that are the same in every report, and the colours with a meaning of their own."""
    def scale(kind, limits, ticks):
        low, high = np.log10(limits)
        return {"uri": bar_uri(kind),
                "ticks": [(text, round(100 * (np.log10(value) - low) / (high - low), 2)) for value, text in ticks]}

    return {"error": scale("error", pictures.COLOR_ERROR_RANGE,
                           [(1e-3, "0.1 %"), (1 / 255, "1/255"), (1e-1, "10 %"), (1.0, "100 %")]),
            "depth": scale("depth", pictures.DEPTH_ERROR_RANGE,
                           [(1e-3, "0.001"), (1e-2, "0.01"), (0.1, "0.1"), (1.0, "1"), (10.0, "10 voxels")]),
            "missed": "#%02x%02x%02x" % pictures.MISSED, "spurious": "#%02x%02x%02x" % pictures.SPURIOUS,
            "nothing": "#%02x%02x%02x" % pictures.NOTHING}
