"""What the paper says: numbers of its text and of Figure 1, and the sentences that are checked. Names are those of the
scenarios' labels. The curves of Figures 6 and 7 have no numbers in the text, so none are here."""

from __future__ import annotations

OURS, MARCHING, MESH, CUBES = "direct rasterization", "octree ray marching", "optimized mesh", "marching cubes"
METHODS = (OURS, MARCHING, MESH)
"""Of the paper. Marching cubes is not: it stands beside them where extraction counts."""
STATIC = ("CT head", "vertebra", "chameleon")
SUPERNOVA = "supernova"
DATASETS = (*STATIC, SUPERNOVA)
FULL_SIZE = (3840, 2160)

DRAW_MS = {"CT head": {OURS: 0.19, MARCHING: 1.54}, "vertebra": {OURS: 0.26, MARCHING: 1.95},
           "chameleon": {OURS: 1.26, MARCHING: 2.59}, SUPERNOVA: {OURS: 0.29, MARCHING: 1.41}}
"""Figure 1, at FULL_SIZE."""
SPEED_UP = {"CT head": 7.92, "vertebra": 7.64, "chameleon": 2.05, SUPERNOVA: 4.74}
"""Over ray marching at FULL_SIZE, sections 4.1.1 and 4.1.2; of the supernova the largest of all resolutions."""
MESH_GAIN = {"CT head": 1.61, "vertebra": 2.03, "chameleon": 1.85, SUPERNOVA: 2.1}
"""How much faster the mesh is, section 4.1.1."""
MESH_GAINS = (1.4, 2.1)
"""The same over all resolutions, caption of Figure 6."""
CROSSING_MEGAPIXELS = 2.7
"""From where on direct rasterization is faster on the chameleon, Figure 6 (c)."""
SWEEP = (0.2, 0.9)
"""Isovalues of Figure 7 (b)."""
LEVEL_AT = 0.4
"""Isovalue of the chameleon around which direct rasterization falls to the level of ray marching, section 4.1.2."""
STEREO_OVERHEAD = {OURS: (0.192, 0.368), MESH: (0.118, 0.462)}
"""Lowest and highest of the volumes, caption of Figure 8."""
STEREO_OVERHEAD_OF_MARCHING = 1.0

STAND_INS = {"CT head": "cranium_ct", SUPERNOVA: "blast_wave"}
REDUCED = ("vertebra", "chameleon")
"""Previews, unless the originals were fetched."""


def speed_up_of_figure1(dataset: str) -> float:
    """Of the two times."""
    return DRAW_MS[dataset][MARCHING] / DRAW_MS[dataset][OURS]


def rounded_speed_ups_of_figure1(dataset: str) -> tuple[float, float]:
    """Lowest and highest that times rounded to 0.01 ms allow."""
    half, ours, marching = 0.005, DRAW_MS[dataset][OURS], DRAW_MS[dataset][MARCHING]
    return (marching - half) / (ours + half), (marching + half) / (ours - half)


def stand_in_text(datasets=DATASETS) -> str:
    """For captions: which volumes stand for others."""
    parts = [f"{name} is {STAND_INS[name]}" for name in datasets if name in STAND_INS]
    reduced = [name for name in datasets if name in REDUCED]
    parts += [f"{' and '.join(reduced)} {'are' if len(reduced) > 1 else 'is'} reduced"] if reduced else []
    return f"Stand-ins: {', '.join(parts)}." if parts else ""
