"""python3 -m volmark_analysis paper direct_rasterization."""

from __future__ import annotations

import argparse
from pathlib import Path

from ...errors import InputError
from ..claims_text import Wording, claims_csv, claims_markdown
from ..figures import captions_markdown
from ..grids import joined, to_csv, to_markdown, to_tex
from ..output import write_output
from . import published
from .claims import claims_of
from .figures import figures_of
from .points_csv import CSV_HEADER, csv_rows
from .sources import AXES, Sources, load_sources
from .tables import grids_of

_WORDING = Wording(
    "Claims of the paper on direct isosurface rasterization (2022)", published.stand_in_text(), "draw times", "frame times", "verdict in these",
    ("The paper's times are draw times, and so are the verdicts'. Frame times have the update, too: extracting the mesh, and what else a new "
     "isovalue or time step costs. They are given where these change in every frame.",
     "A published number that is of one size decides nothing at another one.",
     "Where the device is a CPU, each cell about a method that rasterizes says so: its verdict is about this device."))


def add_paper(papers) -> None:
    sub = papers.add_parser("direct_rasterization", formatter_class=argparse.RawDescriptionHelpFormatter,
                            help="Figures 1, 6, 7 and 8 and the claims of the paper on direct isosurface rasterization",
                            description="Experiments of the scenarios configs/papers/direct_rasterization/<name>.json, in any order; their\n"
                                        "names tell what they are. What is not given is \"not measured\". Writes tables.md, .tex,\n"
                                        "measured.csv, claims.md, .csv, figures.md and the figures.")
    sub.add_argument("folders", nargs="*", type=Path, metavar="FOLDER", help=f"experiments of {', '.join(AXES)}")
    sub.add_argument("-o", "--output", type=Path, metavar="DIR", help="where tables, figures and claims go")
    sub.set_defaults(run=_run)


def _run(options) -> None:
    if options.output is None:
        raise InputError("--output: missing, expected a folder")
    write_all(options.output, load_sources(options.folders))


def write_all(folder: Path, sources: Sources) -> None:
    """Raises InputError if the folder can't be written."""
    grids, claims, drawn = grids_of(sources), claims_of(sources), figures_of(sources)
    texts = {"tables.md": joined(grids, to_markdown), "tables.tex": joined(grids, to_tex),
             "measured.csv": to_csv(CSV_HEADER, csv_rows(sources)), "claims.md": claims_markdown(claims, _WORDING),
             "claims.csv": claims_csv(claims),
             "figures.md": captions_markdown("Figures of the paper on direct isosurface rasterization (2022)", drawn)}
    write_output(folder, texts, drawn)
