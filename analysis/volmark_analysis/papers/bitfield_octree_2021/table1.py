"""Table 1: times, chosen parameters, generation; and the ratios None/method in time and in work."""

from __future__ import annotations

from ...columns import number_text
from ...points import PointResult
from ...search.objective import measured, time_note
from ...tables import caption_of
from ..evidence import KINDS, time_ratio
from ..grids import TextGrid
from ..measurements import Measurements, time_text, why_absent
from . import published
from .cells import cell, done, generation_of, parameter_of
from .work import work_of, work_ratio

METHODS = (*published.METHODS, published.BITFIELD_VOXELS)
_TITLES = {"none": "None", "distance map": "Distance Map", "boolean octree": "Boolean Octree", "min-max octree": "Min-Max Octree",
           published.BITFIELD: "Bitfield Octree (cells)", published.BITFIELD_VOXELS: "Bitfield Octree (voxels)"}
_VOXELS_NOTE = ("Bitfield Octree (cells): bins of all interpolated values, which changes no pixel; (voxels): bins of the voxels alone, "
                "as in the paper, which may change pixels. Both stand beside the paper's one column.")


def times_grid(table: Measurements) -> TextGrid:
    grid = TextGrid("bitfield_octree_2021_table1", _caption("Table 1: mean frame times in ms", table),
                    ["dataset", "", *map(_TITLES.get, METHODS)])
    for dataset in published.DATASETS:
        grid.rules.add(len(grid.rows))
        for configuration in published.CONFIGURATIONS:
            grid.rows.append([_dataset_text(dataset), f"{published.TITLES[configuration]} [ms]"]
                             + [time_cell(table, dataset, configuration, m) for m in METHODS])
        grid.rows.append([_dataset_text(dataset), "Generation [ms]"] + [generation_cell(table, dataset, m) for m in METHODS])
        grid.rows.append([_dataset_text(dataset), "Parameters"] + [parameters_cell(table, dataset, m) for m in METHODS])
    times = {id(r): t for r in table.results if r.completed and (t := measured(r, "mean_ms")) is not None}
    grid.notes = [_VOXELS_NOTE]
    if times:
        grid.notes += [f"Beside each time the error of its picture (lowest PSNR). {time_note(times, 'mean_ms')}",
                       "Generation: median (lowest–highest) of the builds. Min-max and bitfield octrees are built once a run; the "
                       "distance map and the Boolean octree in every frame of a block whose transfer function is set anew each frame."]
    grid.notes.append("\"paper\": published for an AMD Radeon RX 6800 XT at 2160 x 2160 pixels, with the paper's own volumes.")
    return grid


def ratios_grid(table: Measurements) -> TextGrid:
    methods = METHODS[1:]
    grid = TextGrid("bitfield_octree_2021_ratios", _caption("Table 1 as ratios: None over method, above 1 the method is faster", table),
                    ["dataset", "", *map(_TITLES.get, methods)])
    for dataset in published.DATASETS:
        grid.rules.add(len(grid.rows))
        for configuration in published.CONFIGURATIONS:
            grid.rows.append([_dataset_text(dataset), published.TITLES[configuration]]
                             + [ratio_cell(table, dataset, configuration, m) for m in methods])
    grid.notes = ["time: of frame times, median over poses; work: of samples plus node tests, which are exact; paper: of the published "
                  "frame times.", *(f"{text}." for text in KINDS.values()), _VOXELS_NOTE]
    return grid


def _caption(title: str, table: Measurements) -> str:
    parts = [f"{title}, measured and published.", published.stand_in_text(published.DATASETS)]
    if table.experiment is not None:
        parts.append(caption_of(table.experiment, [r for r in table.results if r.completed]))
    return " ".join(parts)


def _dataset_text(dataset: str) -> str:
    stand_in = published.STAND_INS.get(dataset)
    return f"{dataset} ({stand_in})" if stand_in else dataset


def time_cell(table: Measurements, dataset: str, configuration: str, method: str) -> str:
    paper = f"paper {published.time_ms(dataset, configuration, method):.2f}"
    result = cell(table, dataset, configuration, method)
    return f"{why_absent(result) or time_text(result)}; {paper}"


def ratio_cell(table: Measurements, dataset: str, configuration: str, method: str) -> str:
    paper = f"paper {number_text(published.time_ratio(dataset, configuration, 'none', published.column_of(method)))}"
    none, result = done(table, dataset, configuration, "none"), done(table, dataset, configuration, method)
    if none is None or result is None:
        return f"not measured; {paper}"
    work = work_ratio(none, result)
    return f"time {time_ratio(none, result).text}, work {'not counted' if work is None else number_text(work)}; {paper}"


def generation_cell(table: Measurements, dataset: str, method: str) -> str:
    if method == "none":
        return ""
    found = generation_of(table, dataset, method)
    paper = published.TABLE1[dataset].generation_ms[published.column_of(method)]
    return f"{'not measured' if found is None else found.text}; paper {paper:.1f}"


def parameters_cell(table: Measurements, dataset: str, method: str) -> str:
    names = ("leaf", "bits", "initial_level", "texel")
    known = [r for c in published.CONFIGURATIONS if (r := cell(table, dataset, c, method)) is not None]
    texts = {parameters_text({n: parameter_of(r, n) for n in names}) for r in known} - {""}
    paper = published.TABLE1[dataset].parameters.get(published.column_of(method))
    if method == "none":
        return ""
    own = " or ".join(sorted(texts)) or "not measured"
    return f"{own}; paper {parameters_text(paper)}" if paper else own


def parameters_text(parameters: dict) -> str:
    words = {"leaf": "leaf {}³", "bits": "{} bits", "initial_level": "level {}", "texel": "texel {}"}
    return ", ".join(word.format(parameters[name]) for name, word in words.items() if parameters.get(name) is not None)


CSV_HEADER = ["dataset", "volume", "configuration", "method", "status", "mean_ms", "low_ms", "high_ms", "bounds", "published_ms",
              "psnr_db", "none_over_method_time", "time_low", "time_high", "time_bounds", "published_none_over_method",
              "none_over_method_work", "samples", "node_tests", "work", "leaf", "bits", "initial_level", "published_leaf",
              "published_bits", "published_initial_level", "generation_ms", "generation_low_ms", "generation_high_ms",
              "published_generation_ms"]


def csv_rows(table: Measurements) -> list[dict]:
    return [_csv_row(table, d, c, m) for d in published.DATASETS for c in published.CONFIGURATIONS for m in METHODS]


def _csv_row(table: Measurements, dataset: str, configuration: str, method: str) -> dict:
    column, known = published.column_of(method), published.TABLE1[dataset]
    parameters = known.parameters.get(column, {})
    row = {"dataset": dataset, "volume": published.STAND_INS.get(dataset, ""), "configuration": configuration, "method": method,
           "published_ms": published.time_ms(dataset, configuration, method),
           "published_none_over_method": published.time_ratio(dataset, configuration, "none", column),
           "published_generation_ms": known.generation_ms.get(column)}
    row |= {f"published_{name}": value for name, value in parameters.items()}
    if method != "none" and (built := generation_of(table, dataset, method)) is not None:
        row |= {"generation_ms": built.value, "generation_low_ms": built.low, "generation_high_ms": built.high}
    result = cell(table, dataset, configuration, method)
    if result is None or not result.completed:
        return row | {"status": why_absent(result)}
    return row | {"status": "completed"} | _measured_columns(table, result, dataset, configuration)


def _measured_columns(table: Measurements, result: PointResult, dataset: str, configuration: str) -> dict:
    time = measured(result, "mean_ms")
    row = {"mean_ms": time.value, "low_ms": time.low, "high_ms": time.high, "bounds": "interval" if time.is_interval else "spread",
           "psnr_db": float("inf") if result.errors.get("identical") else result.errors.get("psnr_db"),
           "samples": result.counters.get("samples"), "node_tests": result.counters.get("node_tests"), "work": work_of(result)}
    row |= {name: parameter_of(result, name) for name in ("leaf", "bits", "initial_level")}
    none = done(table, dataset, configuration, "none")
    if none is not None:
        ratio = time_ratio(none, result)
        row |= {"none_over_method_time": ratio.value, "time_low": ratio.low, "time_high": ratio.high, "time_bounds": ratio.kind,
                "none_over_method_work": work_ratio(none, result)}
    return row
