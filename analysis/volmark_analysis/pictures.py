"""Pictures of captured frames as a reader sees them: frame, reference, and maps of colour error, depth error and
iterations."""

from __future__ import annotations

import io
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image

from .errors import InputError
from .exr import Picture, read_exr
from .load import Experiment, Run

# Both maps run over fixed decades, the same in every report, so that pictures can be compared.
COLOR_ERROR_RANGE = (1e-3, 1.0)
"""Share of the display range; 1/255 is one step of an 8-bit display."""
DEPTH_ERROR_RANGE = (1e-3, 10.0)
"""Voxels."""
MISSED, SPURIOUS, NOTHING = (213, 94, 0), (86, 180, 233), (128, 128, 128)
MAPS = {"error": "magma", "depth": "viridis", "steps": "cividis", "grid": "cividis"}
"""Perceptually uniform."""


@dataclass
class CapturedFrame:
    """What is shown of one picture; 8-bit sRGB arrays of one size, None where there is nothing to show."""

    row: dict
    frame: np.ndarray
    reference: np.ndarray | None = None
    error: np.ndarray | None = None
    depth: np.ndarray | None = None
    steps: np.ndarray | None = None
    """Iterations per ray, not yet a picture: the scale is that of all pictures shown together, see steps_map()."""


def captured_frames(experiment: Experiment, run: Run, widest: int | None = None,
                    rows: list[dict] | None = None) -> list[CapturedFrame]:
    """The captured pictures of a run (or only those of `rows`), at most `widest` pixels wide."""
    background = background_of(run)
    return [_captured(experiment, run, row, background, widest) for row in (run.pictures if rows is None else rows)]


def background_of(run: Run) -> np.ndarray:
    """Linear Rec.709 colour behind the pictures, as the metrics used it."""
    pictures = run.config.get("pictures")
    value = pictures.get("background") if isinstance(pictures, dict) else None
    return np.array(value if isinstance(value, list) and len(value) == 3 else (0.0, 0.0, 0.0), float)


def _captured(experiment: Experiment, run: Run, row: dict, background, widest) -> CapturedFrame:
    picture = _view(run.folder / row["file"], row["view"])
    factor = 1 if widest is None else -(-picture.color.shape[1] // widest)
    shown = CapturedFrame(row, to_display(_shrunk(over(picture.color, background), factor)))
    if picture.steps is not None:
        shown.steps = _shrunk(np.nan_to_num(picture.steps), factor)
    name = row.get("reference_file")
    if not name:
        return shown
    reference = _view(experiment.folder / name, row["view"])
    if reference.color.shape != picture.color.shape:
        raise InputError(f"{experiment.folder / name}: found {_size(reference)}, expected {_size(picture)} as in "
                         f"{run.folder / row['file']}")
    shown.reference = to_display(_shrunk(over(reference.color, background), factor))
    error = color_error(picture.color, reference.color, background)
    shown.error = map_colors(_worst(error, factor), COLOR_ERROR_RANGE, MAPS["error"])
    if picture.distance is not None and reference.distance is not None and row.get("depth_p995_voxels") is not None:
        shown.depth = _depth_map(picture.distance, reference.distance, _voxel_of(picture, reference, row), factor)
    return shown


@lru_cache(maxsize=16)
def _views(path: Path) -> list[Picture]:
    return read_exr(path)


def _view(path: Path, view: int) -> Picture:
    views = _views(path)
    # A stereo file holds both views; otherwise each file holds one.
    index = view if len(views) > 1 else 0
    if not 0 <= index < len(views):
        raise InputError(f"{path}: no view {view}, found {len(views)}")
    return views[index]


def _size(picture: Picture) -> str:
    height, width = picture.color.shape[:2]
    return f"{width} x {height} pixels"


def over(color: np.ndarray, background: np.ndarray) -> np.ndarray:
    """Premultiplied colour over a background; linear."""
    return color[..., :3] + (1.0 - color[..., 3:]) * background


def srgb(linear: np.ndarray) -> np.ndarray:
    """sRGB encoding of linear values, clamped to [0,1]."""
    clamped = np.clip(np.nan_to_num(linear), 0.0, 1.0)
    return np.where(clamped <= 0.0031308, 12.92 * clamped, 1.055 * clamped ** (1 / 2.4) - 0.055)


def to_display(linear: np.ndarray) -> np.ndarray:
    return np.rint(255 * srgb(linear)).astype(np.uint8)


def color_error(picture: np.ndarray, reference: np.ndarray, background: np.ndarray) -> np.ndarray:
    """Per pixel: root mean square over the channels of the difference as displayed. Its mean square is the MSE."""
    difference = srgb(over(picture, background)) - srgb(over(reference, background))
    return np.sqrt(np.mean(difference**2, axis=-1))


def map_colors(values: np.ndarray, limits: tuple[float, float], name: str) -> np.ndarray:
    """Logarithmic between the limits; values below are drawn as the lowest."""
    low, high = np.log10(limits)
    with np.errstate(divide="ignore"):
        return _colored((np.log10(np.maximum(values, 0)) - low) / (high - low), name)


def _colored(place: np.ndarray, name: str) -> np.ndarray:
    return np.rint(255 * matplotlib.colormaps[name](np.clip(place, 0, 1))[..., :3]).astype(np.uint8)


def steps_map(steps: np.ndarray, most: float) -> np.ndarray:
    """Iterations per ray from 0 to `most`, linear."""
    return _colored(steps / most, MAPS["steps"])


def _voxel_of(picture: Picture, reference: Picture, row: dict) -> float:
    """World units per voxel: the row's mean depth error in voxels is that of these pictures in world units."""
    both = np.isfinite(picture.distance) & np.isfinite(reference.distance)
    mean = float(np.abs(picture.distance[both] - reference.distance[both]).mean()) if both.any() else 0.0
    voxels = row.get("depth_mean_voxels") or 0.0
    return mean / voxels if mean > 0 and voxels > 0 else 1.0


def _depth_map(distance: np.ndarray, reference: np.ndarray, voxel: float, factor: int) -> np.ndarray:
    hit, truth = np.isfinite(distance), np.isfinite(reference)
    both = hit & truth
    apart = np.zeros(distance.shape)
    apart[both] = np.abs(distance[both] - reference[both]) / voxel
    colors = map_colors(_worst(apart, factor), DEPTH_ERROR_RANGE, MAPS["depth"])
    colors[_worst(both, factor) == 0] = NOTHING
    colors[_worst(truth & ~hit, factor) > 0] = MISSED
    colors[_worst(hit & ~truth, factor) > 0] = SPURIOUS
    return colors


def _blocks(values: np.ndarray, factor: int) -> np.ndarray:
    """Pixels grouped into factor x factor blocks; the border is repeated to fill the last ones."""
    rows, columns = (-n % factor for n in values.shape[:2])
    padded = np.pad(values, [(0, rows), (0, columns)] + [(0, 0)] * (values.ndim - 2), mode="edge")
    height, width = padded.shape[0] // factor, padded.shape[1] // factor
    return padded.reshape(height, factor, width, factor, *values.shape[2:])


def _shrunk(values: np.ndarray, factor: int) -> np.ndarray:
    return values if factor == 1 else _blocks(values, factor).mean(axis=(1, 3))


def _worst(values: np.ndarray, factor: int) -> np.ndarray:
    """Shrunk so that a single wrong pixel stays visible."""
    return values if factor == 1 else _blocks(values, factor).max(axis=(1, 3))


def png_of(pixels: np.ndarray, colors: int | None = None) -> bytes:
    """`colors`: most colours of a palette, for maps; None keeps all."""
    image = Image.fromarray(pixels)
    if colors is not None:
        image = image.quantize(colors, dither=Image.Dither.NONE)
    out = io.BytesIO()
    image.save(out, format="PNG", optimize=True)
    return out.getvalue()


def scale_bar(kind: str) -> np.ndarray:
    """The colours of one of MAPS from its lowest to its highest value, one row."""
    return _colored(np.linspace(0, 1, 256)[None, :], MAPS[kind])
