"""What figures of papers share: panels, captions, and writing them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from ..plots import GROUND, TEXT, svg_of
from ..points import PointResult


@dataclass
class Drawn:
    name: str
    caption: str
    figure: Figure | None
    """None: nothing was measured."""


def write_figures(folder: Path, drawn: list[Drawn]) -> list[str]:
    """svg and png. Returns the names of the files."""
    names = []
    for one in drawn:
        if one.figure is not None:
            (folder / f"{one.name}.svg").write_bytes(svg_of(one.figure))
            one.figure.savefig(folder / f"{one.name}.png", dpi=150, metadata={"Software": None})
            names += [f"{one.name}.svg", f"{one.name}.png"]
    return names


def captions_markdown(title: str, drawn: list[Drawn]) -> str:
    parts = [f"# {title}", ""]
    for one in drawn:
        parts += [f"![{one.name}]({one.name}.svg)" if one.figure is not None else f"{one.name}: not measured", "", one.caption, ""]
    return "\n".join(parts)


def caption_text(text: str, results: list[PointResult], stand_ins: str) -> str:
    """What is shown, stand-ins, and the error of the pictures whose times are shown."""
    psnr = [r.errors["psnr_db"] for r in results if "psnr_db" in r.errors]
    error = f"Lowest PSNR of the pictures: {min(psnr):.1f} dB." if psnr else "Errors of the pictures: not measured or identical."
    return " ".join(part for part in (text, stand_ins, error if results else "") if part)


def panels(columns: int, rows: int = 1, height: float = 3.0) -> tuple[Figure, list]:
    """The axes row by row."""
    figure = Figure(figsize=(4.4 * columns, height * rows), layout="constrained")
    figure.patch.set_facecolor(GROUND)
    return figure, list(figure.subplots(rows, columns, squeeze=False).ravel())


def panel_title(ax, text: str) -> None:
    ax.set_title(text, loc="left", fontsize=10, fontweight="bold", color=TEXT)


def over_phases(result: PointResult) -> tuple[np.ndarray, np.ndarray]:
    """Phases and times: the median over orbits, or of timed pacing every frame of the first process."""
    matrices = result.orbit_matrices
    if matrices is not None:
        return result.phases, np.median(np.concatenate(matrices), axis=0)
    rows = result.completed[0].headline.sort_values("phase")
    return rows.phase.to_numpy(), rows.frame_ms.to_numpy()
