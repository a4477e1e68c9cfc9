"""From a search: the best parameters of each octree and volume, and writing them into table1.json."""

from __future__ import annotations

import json
from pathlib import Path

from ...errors import InputError
from ...search.best import Best, best_of
from ...search.candidates import contests_of
from ..grids import TextGrid
from ..measurements import Measurements
from . import published
from .cells import TECHNIQUES, parameter_of
from .table1 import parameters_text

_PATH = "technique.parameters."


def best_points(search: Measurements) -> dict[tuple[str, str], Best]:
    """By dataset and method: the fastest on average, as in the paper."""
    if not search.results:
        return {}
    contests = contests_of(search.results, ["dataset", "technique"], "mean_ms", [])
    found = [(c.where["dataset"], TECHNIQUES.get(c.where["technique"]), best_of(c)) for c in contests]
    return {(dataset, method): best for dataset, method, best in found if best is not None and method in published.OCTREES}


def parameters_of(best: Best) -> dict[str, int]:
    values = {name: parameter_of(best.point, name) for name in ("leaf", "bits", "initial_level")}
    return {name: value for name, value in values.items() if value is not None}


def chosen_grid(search: Measurements) -> TextGrid:
    grid = TextGrid("bitfield_octree_2021_search", f"Best parameters, Marching Only. {published.stand_in_text(published.DATASETS)}",
                    ["dataset", "octree", "best", "mean, ms", "PSNR, dB", "can't be told from it", "paper"])
    found = best_points(search)
    for dataset in published.DATASETS:
        for octree in published.OCTREES:
            best = found.get((dataset, octree))
            paper = parameters_text(published.TABLE1[dataset].parameters[octree])
            if best is None:
                grid.rows.append([dataset, octree, "not measured", "", "", "", paper])
                continue
            time = best.contest.times[id(best.point)]
            psnr = best.point.errors.get("psnr_db")
            grid.rows.append([dataset, octree, parameters_text(parameters_of(best)), time.text,
                              "identical" if best.point.errors.get("identical") else "not measured" if psnr is None else f"{psnr:.1f}",
                              f"{len(best.ties)} of {len(best.contest.points) - 1}", paper])
    return grid


def write_chosen(search: Measurements, path: Path) -> int:
    """Puts the best parameters into the cases of table1.json. Returns how many cases got them. Raises InputError."""
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
        blocks = [(block["axes"]["dataset"]["values"], block["axes"]["method"]["values"]) for block in document["blocks"]]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: not the scenario of Table 1 ({error!r})") from None
    found, written = best_points(search), 0
    for datasets, methods in blocks:
        for case in methods:
            best = found.get((datasets[0]["label"], published.column_of(case["label"])))
            if best is not None:
                case["set"] |= {_PATH + name: value for name, value in parameters_of(best).items()}
                written += 1
    try:
        path.write_text(compact_json(document) + "\n", encoding="utf-8")
    except OSError as error:
        raise InputError(f"{path}: can't be written ({error.strerror or error})") from None
    return written


def compact_json(value, indent: int = 0, used: int = 0, width: int = 118) -> str:
    """Objects and lists on one line where they fit, as the shipped scenarios are written."""
    line = json.dumps(value, ensure_ascii=False)
    if not isinstance(value, (dict, list)) or (indent > 0 and indent + used + len(line) <= width):
        return line
    pad = " " * (indent + 2)
    if isinstance(value, dict):
        names = {key: json.dumps(key, ensure_ascii=False) + ": " for key in value}
        rows = [pad + names[key] + compact_json(one, indent + 2, len(names[key]), width) for key, one in value.items()]
    else:
        rows = [pad + compact_json(one, indent + 2, 1, width) for one in value]
    opening, closing = "{}" if isinstance(value, dict) else "[]"
    return opening + "\n" + ",\n".join(rows) + "\n" + " " * indent + closing
