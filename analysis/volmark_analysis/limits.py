"""How much of a large experiment a report shows. Tables and heat maps hold everything; pictures, plots and lists are
limited, and the page says so wherever something is left out."""

from __future__ import annotations

MOST_PANELS = 4
"""Small multiples of a plot."""
MOST_BARS = 16
MOST_LINES = 8
MOST_COUNTER_PLOTS = 4
MOST_CARDS = 96
"""Captured pictures on the page; with more, only the worst frame of MOST_SETS x MOST_MEMBERS points is shown."""
MOST_SETS = 8
MOST_MEMBERS = 5
MOST_LINES_OF_TEXT = 40
MOST_COMPARISONS = 200
MOST_VALUES = 12


def evenly(items: list, most: int) -> list:
    """At most `most` items (2 or more): the first, the last and evenly spaced ones between, in their order."""
    if len(items) <= most:
        return items
    return [items[round(i * (len(items) - 1) / (most - 1))] for i in range(most)]


def first_of(texts: list[str], most: int, where: str) -> list[str]:
    """The first texts, and if some are left out one more that counts them and says where they are."""
    if len(texts) <= most:
        return texts
    return texts[:most] + [f"… and {len(texts) - most} more: {where}"]
