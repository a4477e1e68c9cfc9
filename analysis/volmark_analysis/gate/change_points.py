"""Where a series of measurements changes its level.

E-divisive (Matteson and James: A Nonparametric Approach for Multiple Change Point Analysis of Multivariate Data, 2014):
split where the energy distance of both sides is largest, keep the split if shuffled series rarely reach it, go on inside
both parts. Exact quantities need no statistics: every step beyond a tolerance is a change.
"""

from __future__ import annotations

import numpy as np

SMALLEST_PART = 4
SIGNIFICANCE = 0.01
_SHUFFLES = 499


def change_points(values: np.ndarray, seed: int = 1) -> list[int]:
    """First index of every new level, in order."""
    values = np.asarray(values, float)
    rng = np.random.default_rng(seed)
    found, parts = [], [(0, len(values))]
    while parts:
        start, end = parts.pop()
        if end - start < 2 * SMALLEST_PART:
            continue
        distances = np.abs(values[start:end, None] - values[None, start:end])
        split, size = _best_split(distances)
        shuffled = sum(_best_split(_shuffled(distances, rng))[1] >= size for _ in range(_SHUFFLES))
        if (1 + shuffled) / (1 + _SHUFFLES) <= SIGNIFICANCE:
            found.append(start + split)
            parts += [(start, start + split), (start + split, end)]
    return sorted(found)


def _shuffled(distances: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    order = rng.permutation(len(distances))
    return distances[np.ix_(order, order)]


def _best_split(distances: np.ndarray) -> tuple[int, float]:
    """Where to split, and the scaled energy distance of both sides there."""
    n = len(distances)
    sums = np.zeros((n + 1, n + 1))
    sums[1:, 1:] = distances.cumsum(0).cumsum(1)
    splits = np.arange(SMALLEST_PART, n - SMALLEST_PART + 1)
    left, right = splits, n - splits
    within_left = sums[splits, splits]
    within_right = sums[n, n] - sums[splits, n] - sums[n, splits] + within_left
    between = sums[splits, n] - within_left
    energy = (2 * between / (left * right) - within_left / (left * np.maximum(left - 1, 1))
              - within_right / (right * np.maximum(right - 1, 1)))
    scaled = left * right / n * energy
    best = int(np.argmax(scaled))
    return int(splits[best]), float(scaled[best])


def steps(values: np.ndarray, tolerance: float) -> list[int]:
    """Indices at which an exact quantity differs from the one before by more than this share."""
    values = np.asarray(values, float)
    return [i for i in range(1, len(values)) if abs(values[i] - values[i - 1]) > tolerance * abs(values[i - 1])]
