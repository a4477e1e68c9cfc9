"""python3 -m volmark_analysis paper bitfield_octree_2021."""

from __future__ import annotations

import argparse
from pathlib import Path

from ...errors import InputError
from ..claims_text import Wording, claims_markdown
from ..figures import captions_markdown
from ..grids import joined, to_csv, to_markdown, to_tex
from ..measurements import Measurements, load_measurements
from ..output import write_output
from . import published
from .chosen import chosen_grid, write_chosen
from .claims import Sources, claims_of
from .figures import figures_of
from .table1 import CSV_HEADER, csv_rows, ratios_grid, times_grid

_SCENARIOS = "configs/papers/bitfield_octree_2021"
_WORDING = Wording("Claims of the bitfield-octree paper (2021)", published.stand_in_text(published.DATASETS), "time",
                   "samples + node tests", "verdict in these", ("Samples and node tests are counted exactly: their ratio has no bounds.",))

_AXES = {"table1": ("dataset", "configuration", "method"), "search": ("dataset", "leaf", "bits", "initial_level"),
         "fig4": ("dataset", "leaf", "bits", "initial_level"), "fig5": ("leaf", "bits"),
         "fig6": ("dataset", "initial_level", "traversal"), "fig7": ()}


def add_paper(papers) -> None:
    sub = papers.add_parser("bitfield_octree_2021", formatter_class=argparse.RawDescriptionHelpFormatter,
                            help="Table 1, Figures 4 to 7 and the claims of the bitfield-octree paper",
                            description="Experiments of the scenarios configs/papers/bitfield_octree_2021/<name>.json. What is not given is\n"
                                        "\"not measured\" in the tables. Writes table1.md, .csv, .tex, claims.md, figures.md and the figures.")
    for name in _AXES:
        sub.add_argument(f"--{name}", type=Path, metavar="DIR", help=f"experiment of "
                         f"{'table1_search' if name == 'search' else name}.json")
    sub.add_argument("-o", "--output", type=Path, metavar="DIR", help="where tables, figures and claims go")
    sub.add_argument("--choose", type=Path, metavar="FILE", help="write the best parameters of --search into the scenario table1.json")
    sub.set_defaults(run=_run)


def _run(options) -> None:
    if options.output is None and options.choose is None:
        raise InputError("--output: missing, expected a folder (or --choose FILE)")
    if options.choose is not None and options.search is None:
        raise InputError("--choose: needs --search DIR")
    sources = {name: load_measurements(getattr(options, name), axes, _SCENARIOS) for name, axes in _AXES.items()}
    if options.choose is not None:
        print(f"{options.choose}: {write_chosen(sources['search'], options.choose)} cases have the best parameters of {options.search}")
    if options.output is not None:
        write_all(options.output, sources)


def write_all(folder: Path, sources: dict[str, Measurements]) -> None:
    """Raises InputError if the folder can't be written."""
    table = sources["table1"]
    grids = [times_grid(table), ratios_grid(table), chosen_grid(sources["search"])]
    drawn = figures_of(*(sources[name] for name in ("fig4", "fig5", "fig6", "fig7")))
    claims = claims_of(Sources(table, sources["search"], sources["fig4"], sources["fig6"]))
    texts = {"table1.md": joined(grids, to_markdown), "table1.tex": joined(grids, to_tex),
             "table1.csv": to_csv(CSV_HEADER, csv_rows(table)), "claims.md": claims_markdown(claims, _WORDING),
             "figures.md": captions_markdown("Figures of the bitfield-octree paper (2021)", drawn)}
    write_output(folder, texts, drawn)
