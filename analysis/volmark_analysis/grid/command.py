"""python3 -m volmark_analysis grid."""

from __future__ import annotations

import argparse
import contextlib
import os
import signal
import sys
from pathlib import Path

from ..errors import InputError
from .batches import Batch, batches_of
from .dask_workers import LocalWorkers, Workers
from .hand_out import Lost, hand_out
from .job import Job, find_program
from .progress import Progress
from .slurm import MOST_TASKS, array_script

INTERRUPTED = 130
_ROUNDS = 2
"""Runs that other processes had claimed are looked at once more when all else is done."""

_MOST_NAMED = 10
"""Batches that were given up; beyond, they are counted."""

_DESCRIPTION = """Run a scenario on several workers: batches of points go to whoever is free. Without --scheduler, on
workers of this machine's own.
One worker measures one thing at a time; give it a device of its own, or timings disturb each other."""

_EPILOG = """examples:
  python3 -m volmark_analysis grid configs/quick/quick.json --profile lavapipe
  python3 -m volmark_analysis grid big.json --device 0 --device 1          two devices of this machine
  dask scheduler                                                           on one machine, then on each with a GPU:
  dask worker tcp://HOST:8786 --resources GPU=1 --nthreads 1
  python3 -m volmark_analysis grid big.json --scheduler tcp://HOST:8786
  python3 -m volmark_analysis grid big.json --slurm big.sh --sbatch=--gres=gpu:1 --sbatch=--time=8:00:00
  bash big.sh

Exit codes: 0 all done; 1 a run failed or points are left; 2 bad input; 130 interrupted. The same command goes on."""


def add_command(commands) -> None:
    sub = commands.add_parser("grid", help="run a scenario on several workers or machines", description=_DESCRIPTION,
                              epilog=_EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_scenario_options(sub)
    add_worker_options(sub)
    sub.add_argument("--slurm", type=Path, metavar="FILE", help="run nothing, write a Slurm array script")
    sub.add_argument("--tasks", type=count, default=MOST_TASKS, metavar="N",
                     help=f"most tasks of the array (default: one per batch, at most {MOST_TASKS})")
    sub.add_argument("--sbatch", action="append", default=[], metavar="OPTION",
                     help="an option for the script, as in --sbatch=--gres=gpu:1 (default: --exclusive)")
    sub.set_defaults(run=_grid)


def add_scenario_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("config", metavar="CONFIG", type=Path, help="scenario file (configs/*.json)")
    sub.add_argument("--profile", metavar="NAME", help="as for volmark run")
    sub.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="as for volmark run")
    sub.add_argument("--results", type=Path, default=Path("results"), metavar="DIR",
                     help="folder of experiments, seen by all machines (default: results)")
    sub.add_argument("--data", action="append", default=[], metavar="DIR", help="as for volmark run")
    sub.add_argument("--retry", choices=("failed",), help="failed: run again what did not complete")
    sub.add_argument("--program", type=Path, metavar="FILE",
                     help="volmark (default: this checkout's build/release/volmark, else the one on the PATH)")


def add_worker_options(sub: argparse.ArgumentParser) -> None:
    where = sub.add_mutually_exclusive_group()
    where.add_argument("--scheduler", metavar="ADDRESS", help="a Dask scheduler, as in tcp://HOST:8786")
    where.add_argument("--device", action="append", default=[], metavar="DEVICE",
                       help="a worker of its own for this device (volmark device); may be repeated")
    where.add_argument("--workers", type=count, default=1, metavar="N",
                       help="workers on this machine (default: 1); more than one share a device")


def count(text: str) -> int:
    if not text.isdigit() or int(text) == 0:
        raise argparse.ArgumentTypeError(f"found {text!r}, allowed: a whole number above 0")
    return int(text)


def job_of(options) -> Job:
    if not options.config.is_file():
        raise InputError(f"{options.config}: no such file")
    scenario = ["--profile", options.profile] if options.profile else []
    for assignment in options.set:
        scenario += ["--set", assignment]
    more = ["--retry", options.retry] if options.retry else []
    for folder in options.data:
        more += ["--data", os.path.abspath(folder)]
    return Job(find_program(options.program), options.config.resolve(), options.results.resolve(), tuple(scenario),
               tuple(more))


@contextlib.contextmanager
def workers_of(options):
    """Those that the options ask for. Stops them at the end, also after Ctrl-C or SIGTERM."""
    def interrupt(*_):
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    workers = None
    try:
        workers = Workers(options.scheduler) if options.scheduler else LocalWorkers(options.device or [""] * options.workers)
        yield workers
    finally:
        if workers is not None:
            workers.close()
        signal.signal(signal.SIGTERM, before)


def _grid(options) -> int:
    job = job_of(options)
    if options.slurm is not None:
        return _write_script(job, options)
    batches = batches_of(job.points())
    progress = Progress()
    try:
        with workers_of(options) as workers:
            lost = _run(workers, job, batches, progress)
    except KeyboardInterrupt:
        progress.say("interrupted: the same command goes on from here")
        return INTERRUPTED
    if job.has_begun:
        job.write_index()
    return _conclude(job, lost)


def _run(workers: Workers, job: Job, batches: list[Batch], progress: Progress) -> list[Lost]:
    lost: list[Lost] = []
    for _ in range(_ROUNDS):
        progress.start(sum(len(b.points) for b in batches))
        lost += hand_out(workers, job, batches, progress)
        if not job.has_begun:
            break
        given_up = {entry.batch for entry in lost}
        left = set(job.status()["left_points"])
        batches = [b for b in batches if b not in given_up and left & set(b.points)]
        if not batches:
            break
    return lost


def _conclude(job: Job, lost: list[Lost]) -> int:
    for entry in lost[:_MOST_NAMED]:
        print(f"  given up: points {', '.join(map(str, entry.batch.points))}: {entry.reason}", file=sys.stderr)
    if len(lost) > _MOST_NAMED:
        print(f"  and {len(lost) - _MOST_NAMED} more batches", file=sys.stderr)
    if not job.has_begun:
        print("nothing was run")
        return 1
    status = job.status()
    done = status["planned"] - status["left"] - status["running"]
    print(f"{done} of {status['planned']} runs done: {status['completed']} completed, {status['failed']} failed, "
          f"{status['unsupported']} unsupported" + (f"; {status['running']} under way elsewhere" if status["running"] else ""))
    print(f"report:  PYTHONPATH=analysis python3 -m volmark_analysis report {job.folder}")
    return 0 if status["left"] + status["running"] + status["failed"] == 0 else 1


def _write_script(job: Job, options) -> int:
    script = array_script(job, job.expansion(), batches_of(job.points()), options.tasks, options.sbatch, options.slurm)
    try:
        options.slurm.write_text(script, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{options.slurm}: can't be written ({error.strerror or error})") from None
    print(f"submit it with: bash {options.slurm}")
    return 0
