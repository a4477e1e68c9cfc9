"""python3 -m volmark_analysis best, pareto, halve."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from ..errors import InputError
from ..grid.command import INTERRUPTED, add_scenario_options, add_worker_options, count, job_of, workers_of
from ..grid.progress import Progress
from ..load import load_experiment
from ..points import point_results
from ..tables import WRITERS, Table
from .best import best_table
from .candidates import Limit, contests_of
from .front_plot import front_plot, write_front_plot
from .halving import Question, halve
from .objective import DEFAULT_OBJECTIVE, HIGHER_IS_BETTER, OBJECTIVES
from .pareto import front_of, front_table

_LIMITS = {"min_psnr": "psnr_db", "min_ssim": "ssim", "max_flip": "flip", "max_depth": "depth_p995_voxels"}


def add_commands(commands) -> None:
    best = _add(commands, "best", _best, "the fastest point of each scene, and its ties",
                "Of each scene (--per) the fastest point whose pictures are good enough. Points whose bounds overlap with the\n"
                "best's are named as ties: measure them with more processes (measure.replicates).")
    _add_folder(best)
    pareto = _add(commands, "pareto", _pareto, "the front of error against time, as table and plot",
                  "Points of each scene (--per) that no other beats in both time and error. Writes plots/pareto.svg and .png.")
    _add_folder(pareto)
    pareto.add_argument("--error", choices=tuple(HIGHER_IS_BETTER), default="psnr_db", help="default: psnr_db")
    halving = _add(commands, "halve", _halve, "find the best points of a large grid without measuring all of it well",
                   "Successive halving: every point is run by one process; of each scene (--per) the best 1/ETA by ETA processes,\n"
                   "and so on to --replicates. All in one experiment folder: the same command goes on, and so does volmark run.")
    add_scenario_options(halving)
    add_worker_options(halving)
    halving.add_argument("--eta", type=_at_least_two, default=3, metavar="N", help="default: 3")
    halving.add_argument("--replicates", type=count, default=9, metavar="N", help="processes per point at last (default: 9)")


def _add(commands, name: str, run, text: str, more: str) -> argparse.ArgumentParser:
    sub = commands.add_parser(name, help=text, description=more, formatter_class=argparse.RawDescriptionHelpFormatter)
    sub.add_argument("--per", default="scene", metavar="AXIS,AXIS...",
                     help="axes that are not searched over, as in scene,technique (default: scene)")
    sub.add_argument("--objective", choices=tuple(OBJECTIVES), default=DEFAULT_OBJECTIVE,
                     help=f"default: {DEFAULT_OBJECTIVE}, of frame_ms")
    for option, error in _LIMITS.items():
        sub.add_argument("--" + option.replace("_", "-"), type=float, metavar="X", help=f"limit of {error}, worst picture")
    sub.add_argument("--format", choices=tuple(WRITERS), default="md", help="default: md; csv has the bounds in columns")
    sub.set_defaults(run=run)
    return sub


def _add_folder(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("folder", metavar="DIR", type=Path, help="experiment folder, e.g. results/quick")


def _at_least_two(text: str) -> int:
    number = count(text)
    if number < 2:
        raise argparse.ArgumentTypeError(f"found {text!r}, allowed: a whole number above 1")
    return number


def _question(options) -> Question:
    limits = [Limit(error, getattr(options, option)) for option, error in _LIMITS.items()
              if getattr(options, option) is not None]
    return Question(options.objective, [axis.strip() for axis in options.per.split(",") if axis.strip()], limits)


def _contests(options):
    question, experiment = _question(options), load_experiment(options.folder)
    results = point_results(experiment)
    contests = contests_of(results, question.per, question.objective, question.limits, getattr(options, "error", None))
    return question, experiment, results, contests


def _print(options, table: Table) -> None:
    sys.stdout.write(WRITERS[options.format](table))


def _best(options) -> None:
    question, experiment, results, contests = _contests(options)
    _print(options, best_table(experiment, results, contests, question.objective, question.limits, options.format == "csv"))


def _pareto(options) -> None:
    question, experiment, results, contests = _contests(options)
    fronts = [front_of(contest, options.error) for contest in contests if contest.points]
    if not fronts:
        raise InputError(f"{experiment.folder}: no point with {question.objective} and {options.error}")
    _print(options, front_table(experiment, results, fronts, question.objective, options.format == "csv"))
    try:
        for path in write_front_plot(experiment.folder / "plots", front_plot(fronts, question.objective), results):
            print(path, file=sys.stderr)
    except OSError as error:
        raise InputError(f"{error.filename or experiment.folder}: can't be written ({error.strerror or error})") from None


def _halve(options) -> int:
    job, question, progress = job_of(options), _question(options), Progress()
    try:
        with workers_of(options) as workers:
            halved = halve(workers, job, question, options.eta, options.replicates, progress)
    except KeyboardInterrupt:
        progress.say("interrupted: the same command goes on from here")
        return INTERRUPTED
    job.write_index()
    results = [r for contest in halved.contests for r in contest.points]
    _print(options, best_table(halved.experiment, results, halved.contests, question.objective, question.limits,
                               options.format == "csv"))
    print(f"{halved.runs} runs; the full grid with {options.replicates} processes per point has {halved.full_runs}",
          file=sys.stderr)
    return 1 if halved.lost else 0
