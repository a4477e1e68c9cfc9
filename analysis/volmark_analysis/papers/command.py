"""python3 -m volmark_analysis paper."""

from __future__ import annotations

from .bitfield_octree_2021 import command as bitfield_octree_2021
from .direct_rasterization import command as direct_rasterization

_PAPERS = (bitfield_octree_2021, direct_rasterization)


def add_command(commands) -> None:
    paper = commands.add_parser("paper", help="a paper's tables, figures and claims, published beside measured")
    papers = paper.add_subparsers(required=True, metavar="PAPER")
    for module in _PAPERS:
        module.add_paper(papers)
