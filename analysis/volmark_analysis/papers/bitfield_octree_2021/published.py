"""What the paper says: Table 1, and the sentences that are checked. Names are those of the scenarios' labels."""

from __future__ import annotations

from dataclasses import dataclass

METHODS = ("none", "distance map", "boolean octree", "min-max octree", "bitfield octree")
"""Columns of Table 1, in its order."""
OCTREES = METHODS[2:]
BITFIELD, BITFIELD_VOXELS = "bitfield octree", "bitfield octree, voxels"
"""With the bins of all trilinear values (which changes no pixel), and with those of the voxels alone, which is the paper's."""
CONFIGURATIONS = ("marching only", "early exit", "shading", "lighting")
TITLES = {"marching only": "Marching Only", "early exit": "+ Early Exit", "shading": "+ Shading", "lighting": "+ Lighting"}
GENERATION = "generation"

STAND_INS = {"lungs": "chest_ct", "head MRI": "mri_ventricles", "Manix": "cranium_ct", "beetle": "stag_beetle"}
DATASETS = ("lungs", "head MRI", "aneurysm", "Manix", "beetle", "kingsnake")

TIME_BUDGET_MS = 11.1
"""Of a frame, figure 7."""
MOST_ITERATIONS = 1024
"""What the heat maps of figure 5 are normalised by."""
SLOWEST_PERCENTILE_LONGER = 0.27
"""Table 1's caption: the slowest 1 percentile of frames took on average 27 % longer."""
GENERATION_RATIOS = (2.5, 20.0)
"""Section 4.4: the distance map took 2.5 to 20 times as long as the octrees."""


@dataclass(frozen=True)
class Dataset:
    size: tuple[int, int, int]
    times_ms: dict[str, tuple[float, ...]]
    """By configuration, in the order of METHODS."""
    generation_ms: dict[str, float]
    parameters: dict[str, dict[str, int]]
    """The best ones, of the octrees."""


def _dataset(size, rows, generation, leaves, bits, levels) -> Dataset:
    parameters = {m: {"leaf": leaf, "initial_level": level} for m, leaf, level in zip(OCTREES, leaves, levels)}
    parameters[BITFIELD]["bits"] = bits
    return Dataset(size, dict(zip(CONFIGURATIONS, rows)), dict(zip(METHODS[1:], generation)), parameters)


TABLE1 = {
    "lungs": _dataset((512, 512, 690), [(12.05, 5.98, 7.32, 15.59, 7.91), (7.83, 2.76, 4.50, 10.16, 4.75),
                                        (12.47, 7.54, 8.20, 13.41, 8.52), (14.38, 8.21, 9.07, 15.14, 9.46)],
                      (59.2, 7.7, 7.1, 7.0), (2, 4, 2), 32, (5, 6, 5)),
    "head MRI": _dataset((512, 640, 184), [(10.90, 7.03, 9.81, 14.82, 11.28), (5.41, 1.51, 2.33, 3.11, 2.56),
                                           (7.66, 3.89, 4.37, 4.83, 4.59), (8.61, 4.34, 4.93, 5.57, 5.24)],
                         (39.6, 9.4, 7.9, 5.3), (2, 4, 2), 128, (3, 3, 3)),
    "aneurysm": _dataset((256, 256, 256), [(6.41, 0.94, 2.46, 2.47, 2.46), (6.32, 0.82, 2.22, 2.24, 2.24),
                                           (6.78, 1.18, 2.33, 2.34, 2.35), (7.36, 1.33, 2.54, 2.56, 2.57)],
                         (14.0, 5.2, 5.2, 5.2), (2, 2, 2), 32, (3, 3, 3)),
    "Manix": _dataset((512, 446, 459), [(9.17, 2.59, 4.27, 4.39, 4.35), (6.48, 0.92, 1.72, 1.74, 1.74),
                                        (7.81, 2.27, 2.59, 2.67, 2.63), (9.40, 2.51, 2.94, 3.00, 2.97)],
                      (54.6, 4.2, 3.5, 4.4), (2, 4, 2), 32, (3, 3, 3)),
    "beetle": _dataset((832, 832, 494), [(19.31, 2.07, 2.82, 2.87, 2.85), (17.20, 0.69, 1.28, 1.30, 1.29),
                                         (18.58, 1.29, 1.63, 1.65, 1.64), (22.49, 1.50, 1.91, 1.95, 1.93)],
                       (118.2, 12.0, 12.1, 9.8), (4, 4, 4), 32, (2, 2, 2)),
    "kingsnake": _dataset((1024, 1024, 795), [(23.82, 2.35, 3.26, 3.39, 3.45), (21.58, 1.29, 2.33, 2.39, 2.41),
                                              (23.38, 2.46, 2.96, 3.04, 3.06), (29.87, 2.75, 3.39, 3.45, 3.51)],
                          (350.4, 18.3, 23.5, 23.7), (2, 4, 4), 64, (3, 3, 3)),
}


def column_of(method: str) -> str:
    """The paper's column that a method stands in: both supports are its bitfield octree."""
    return BITFIELD if method == BITFIELD_VOXELS else method


def time_ms(dataset: str, configuration: str, method: str) -> float | None:
    row = TABLE1[dataset].times_ms.get(configuration)
    return None if row is None else row[METHODS.index(column_of(method))]


def time_ratio(dataset: str, configuration: str, a: str, b: str) -> float:
    """Time of `a` over time of `b`."""
    return time_ms(dataset, configuration, a) / time_ms(dataset, configuration, b)


def stand_in_text(datasets) -> str:
    """For captions: which volumes stand for others."""
    named = [f"{name} are" if name == "lungs" else f"{name} is" for name in datasets if name in STAND_INS]
    volumes = [STAND_INS[name] for name in datasets if name in STAND_INS]
    text = ", ".join(f"{name} {volume}" for name, volume in zip(named, volumes))
    return f"Stand-ins: {text}." if text else ""
