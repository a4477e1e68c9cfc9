"""python3 -m volmark_analysis: reports, tables, plots, comparisons and exports from an experiment folder."""

from __future__ import annotations

import argparse
import gc
import os
import sys
from pathlib import Path

from . import comparisons, export, microbenchmarks, plots, report, tables
from .errors import InputError
from .gate import command as gate
from .grid import command as grid
from .load import load_experiment
from .papers import command as papers
from .points import point_results
from .search import command as search

_EPILOG = """examples:
  python3 -m volmark_analysis report results/quick
  python3 -m volmark_analysis table results/quick --format tex > quick.tex
  python3 -m volmark_analysis table results/quick --columns technique,step,mean_ms,psnr_db,counter.samples
  python3 -m volmark_analysis plots results/quick
  python3 -m volmark_analysis compare results/quick --a technique=iso_raymarch --b technique=iso_octree
  python3 -m volmark_analysis compare results/quick --a step=0.5 --b step=1.0
  python3 -m volmark_analysis export results/quick --format github-action-benchmark -o benchmark.json
  python3 -m volmark_analysis bench new.json --old old.json
  python3 -m volmark_analysis gate --base origin/main
  python3 -m volmark_analysis paper bitfield_octree_2021 --table1 results/bitfield_octree_2021_table1 -o results/paper
  python3 -m volmark_analysis paper direct_rasterization results/direct_rasterization_fig1 -o results/paper

DIR is an experiment folder: the one with experiment.json and runs/. Unusable input gives one line and exit code 2.
The statistics are defined in harness/README.md, section 6, and at the end of every report."""


def main(arguments: list[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    # Documents of a thousand runs hold few cycles: by default the collector would search them over and over.
    gc.set_threshold(50_000, 20, 100)
    try:
        return options.run(options) or 0
    except InputError as error:
        print(f"volmark_analysis: {error}", file=sys.stderr)
        return 2
    except BrokenPipeError:  # `| head`
        sys.stderr.close()
        return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python3 -m volmark_analysis", description=__doc__, epilog=_EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def command(name, run, text, more=""):
        sub = commands.add_parser(name, help=text, description=f"{text}. {more}".strip(),
                                  formatter_class=argparse.RawDescriptionHelpFormatter)
        sub.add_argument("folder", metavar="DIR", type=Path, help="experiment folder, e.g. results/quick")
        sub.set_defaults(run=run)
        return sub

    sub = command("report", _report, "write report.html, tables/ and plots/ into the experiment folder",
                  "The page is one file without references to others: it can be mailed or published as it is.")
    sub.add_argument("-o", "--output", type=Path, metavar="FILE", help="where the page goes (default: DIR/report.html)")
    _add_low1(sub)
    sub = command("table", _table, "print the results, one row per point",
                  "A time always comes with an error: psnr_db is added beside it if you choose none.")
    sub.add_argument("--format", choices=tuple(tables.WRITERS), default="md",
                     help="Markdown, LaTeX (booktabs) or CSV (default: md)")
    sub.add_argument("--columns", metavar="NAME,NAME...",
                     help="labels, statistics, errors, counter.<name>, pass.<name>; a wrong name lists all")
    _add_low1(sub)
    command("plots", _plots, "write plots/ (svg and png) into the experiment folder")
    sub = command("compare", _compare, "ratio of frame times of two selections, pose by pose",
                  "Results of A and B are paired when they agree on all labels that neither selection names.")
    for side in ("a", "b"):
        sub.add_argument(f"--{side}", action="append", required=True, metavar="LABEL=VALUE",
                         help="may be repeated, or joined by commas")
    sub = command("export", _export, "write the results in the format of another tool",
                  "github-action-benchmark: customSmallerIsBetter JSON. bencher: Bencher Metric Format JSON.\n"
                  "presentmon: a CSV row per frame, with the columns that exist without a window.")
    sub.add_argument("--format", choices=tuple(export.WRITERS), required=True)
    sub.add_argument("-o", "--output", type=Path, metavar="FILE", help="where it goes (default: standard output)")
    sub = commands.add_parser("bench", help="print microbenchmarks of volmark_bench, alone or beside older ones")
    sub.add_argument("file", metavar="FILE", type=Path,
                     help="volmark_bench --benchmark_out=FILE --benchmark_out_format=json --benchmark_repetitions=5")
    sub.add_argument("--old", metavar="FILE", type=Path, help="the same of another build: adds the ratio of the medians")
    sub.set_defaults(run=_bench)
    gate.add_command(commands)
    grid.add_command(commands)
    search.add_commands(commands)
    papers.add_command(commands)
    return parser


def _add_low1(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--low1", choices=tuple(tables.LOW1_NAMES), default="low1_avg_ms",
                     help="which statistic of slow frames is shown (default: low1_avg_ms)")


def _load(options):
    experiment = load_experiment(options.folder)
    return experiment, point_results(experiment)


def _report(options) -> None:
    experiment, results = _load(options)
    path = options.output or experiment.folder / "report.html"
    report.write_report(experiment, results, path, options.low1)
    print(path)


def _table(options) -> None:
    experiment, results = _load(options)
    columns = [c.strip() for c in options.columns.split(",")] if options.columns else None
    table = tables.results_table(experiment, results, options.low1, columns)
    sys.stdout.write(tables.WRITERS[options.format](table))


def _plots(options) -> None:
    experiment, results = _load(options)
    folder = experiment.folder / "plots"
    try:
        names = plots.write_plots(folder, results)
    except OSError as error:
        raise InputError(f"{error.filename or folder}: can't be written ({error.strerror or error})") from None
    if not names:
        raise InputError(f"{experiment.folder}: no run completed, nothing to plot")
    for name in names:
        print(folder / f"{name}.svg")


def _compare(options) -> None:
    _, results = _load(options)
    a = comparisons.parse_selection(options.a, results, "--a")
    b = comparisons.parse_selection(options.b, results, "--b")
    sys.stdout.write(comparisons.to_markdown(comparisons.selection_comparisons(results, a, b)))


def _export(options) -> None:
    experiment, results = _load(options)
    text = export.WRITERS[options.format](experiment, results)
    if options.output is None:
        sys.stdout.write(text)
        return
    staged = options.output.with_name(options.output.name + ".part")
    try:
        staged.write_text(text, encoding="utf-8")
        os.replace(staged, options.output)
    except OSError as error:
        raise InputError(f"{error.filename or options.output}: can't be written ({error.strerror or error})") from None


def _bench(options) -> None:
    old = microbenchmarks.read_benchmarks(options.old) if options.old else None
    sys.stdout.write(microbenchmarks.to_markdown(microbenchmarks.read_benchmarks(options.file), old))


if __name__ == "__main__":
    sys.exit(main())
