"""Wilcoxon's signed-rank test, the interval that belongs to it, and Holm's adjustment.

Why not a bootstrap: with the 8 to 12 pairs that a gate can afford, resampled intervals cover too little, the
studentized one suffers from the outliers of a loaded machine, and neither can promise more than simulations show.
Base and candidate of a pair take turns in shuffled order, so without a difference between them every pair's log ratio
is as likely to be x as -x, whatever the load did to its size. That symmetry is all that this test needs: its levels
are exact for any number of pairs and any outliers.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np


@lru_cache
def _tail(count: int) -> np.ndarray:
    """P(W >= w) for w = 0, 1, ..., of W = sum of those of the ranks 1..count whose coin shows heads."""
    chances = np.ones(1)
    for rank in range(1, count + 1):
        chances = 0.5 * (np.pad(chances, (0, rank)) + np.pad(chances, (rank, 0)))
    return np.minimum(np.cumsum(chances[::-1])[::-1], 1.0)


@lru_cache
def _pairs(count: int) -> tuple[np.ndarray, np.ndarray]:
    return np.triu_indices(count)


class SignedRank:
    """Of at least one difference."""

    def __init__(self, differences: np.ndarray):
        values = np.asarray(differences, float)
        first, second = _pairs(len(values))
        # Means of all pairs of values, each with itself too: how many lie above x is W for differences - x.
        self._averages = np.sort(0.5 * (values[first] + values[second]))
        self._tail = _tail(len(values))

    @property
    def center(self) -> float:
        """Hodges and Lehmann's estimate."""
        return float(np.median(self._averages))

    def p_above(self, bound: float) -> float:
        """How likely at least this much evidence for a centre above `bound` is if the centre is at most `bound`."""
        return float(self._tail[len(self._averages) - np.searchsorted(self._averages, bound, side="right")])

    def p_below(self, bound: float) -> float:
        return float(self._tail[np.searchsorted(self._averages, bound, side="left")])

    def interval(self, confidence: float) -> tuple[float, float]:
        """Of the centre: the bounds that p_above and p_below don't reject, each at half of 1 - confidence. Infinite if
        there are too few differences to reject anything."""
        rejected = self._tail <= 0.5 * (1.0 - confidence)
        if not rejected.any():
            return -np.inf, np.inf
        cut = len(self._averages) - int(np.argmax(rejected))
        return float(self._averages[cut]), float(self._averages[-1 - cut])


def holm(chances: dict) -> dict:
    """Adjusted so that comparing each with a level keeps the chance of any false rejection below the level."""
    adjusted, largest = {}, 0.0
    for place, key in enumerate(sorted(chances, key=chances.get)):
        largest = max(largest, min(1.0, (len(chances) - place) * chances[key]))
        adjusted[key] = largest
    return adjusted
