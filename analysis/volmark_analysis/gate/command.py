"""python3 -m volmark_analysis gate: options, and what is printed."""

from __future__ import annotations

import argparse
import sys
from datetime import datetime, timezone
from pathlib import Path

from ..errors import InputError
from . import history
from .builds import MachineError, resolve
from .calibrating import Calibration, run_calibration
from .calibration import save
from .evidence import BASE, CANDIDATE
from .program import read_scenario
from .rules import CLOCKS, EXIT_CODES, INCONCLUSIVE, Rules
from .stages import Clock, Gate, judge_folder, measure, remember, store_baseline

_EPILOG = """examples:
  python3 -m volmark_analysis gate --base origin/main                        against the build in build/release
  python3 -m volmark_analysis gate --base v1.0 --candidate HEAD --minutes 20
  python3 -m volmark_analysis gate --base /opt/volmark --candidate build/release --accept-changes
  python3 -m volmark_analysis gate --candidate build/release --store-baseline results/baselines/main.json
  python3 -m volmark_analysis gate --base results/baselines/main.json        exact quantities alone, no times
  python3 -m volmark_analysis gate --judge results/gate/20250131-120000      again, with other rules
  python3 -m volmark_analysis gate calibrate
  python3 -m volmark_analysis gate history

Exit codes: 0 same or improved, 1 regressed, 2 bad input, 3 this machine lacks something, 4 inconclusive,
130 interrupted. How verdicts are made: analysis/README.md."""
_RESULTS = Path("results/gate")


def add_command(commands) -> None:
    gate = commands.add_parser("gate", help="judge whether a build got slower or wrong", epilog=_EPILOG,
                               description="Judge whether a build got slower or wrong, against another one.",
                               formatter_class=argparse.RawDescriptionHelpFormatter)
    gate.set_defaults(run=_caught(_gate))
    gate.add_argument("--base", metavar="REV|DIR|FILE.json", help="what to compare with: a revision (built once and kept), a "
                      "build folder or installed prefix, or a stored baseline")
    gate.add_argument("--candidate", metavar="REV|DIR", default="build/release", help="what is judged (default: build/release)")
    _add_common(gate)
    gate.add_argument("--minutes", type=_positive, default=10.0, help="how long it may take, builds not counted (default: 10); "
                      "decides the number of pairs")
    gate.add_argument("--pairs", type=_count, metavar="N", help="pairs of processes per point, whatever time that takes")
    gate.add_argument("--accept-changes", action="store_true", help="changed pictures, counters and more instructions are "
                      "meant; larger errors and slower times still fail")
    gate.add_argument("--allow-inconclusive", action="store_true", help="exit code 0 instead of 4")
    gate.add_argument("--output", type=Path, metavar="DIR", help="the verdict's folder (default: results/gate/<time>)")
    gate.add_argument("--store-baseline", type=Path, metavar="FILE.json", help="keep the candidate's exact quantities")
    gate.add_argument("--judge", type=Path, metavar="DIR", help="judge what an earlier gate left in DIR; runs nothing")
    actions = gate.add_subparsers(metavar="ACTION", title="actions")
    sub = actions.add_parser("calibrate", help="measure false alarms and the smallest slowdown that is found here",
                             description="Record A/A pairs and slowed ones, simulate gates from them, store the rates.")
    sub.set_defaults(run=_caught(_calibrate))
    sub.add_argument("--program", metavar="DIR|REV", default="build/release", help="default: build/release")
    _add_common(sub)
    sub.add_argument("--pairs", type=_count, default=60, metavar="N", help="to record of each kind (default: 60)")
    sub.add_argument("--slowdown", type=_positive, action="append", metavar="PERCENT", help="also recorded (default: 5)")
    sub.add_argument("--trials", type=_count, default=1000, metavar="N", help="simulated gates (default: 1000)")
    sub.add_argument("--load", type=int, default=0, metavar="N", help="busy processes beside (default: 0)")
    sub = actions.add_parser("history", help="plot the verdicts so far and mark where levels change",
                             description="Write history.svg and history.png, print the changes.")
    sub.set_defaults(run=_caught(_history))
    sub.add_argument("file", type=Path, nargs="?", default=_RESULTS / "history.jsonl", metavar="FILE",
                     help="default: results/gate/history.jsonl")
    sub.add_argument("-o", "--output", type=Path, metavar="DIR", help="where plots go (default: beside FILE)")


def _add_common(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--configs", type=Path, nargs="+", metavar="FILE", help="scenarios (default: configs/ci/*.json)")
    sub.add_argument("--margin", type=_positive, default=100 * Rules.margin, metavar="PERCENT",
                     help=f"times that differ by less are the same (default: {100 * Rules.margin:g})")
    sub.add_argument("--clocks", default=",".join(CLOCKS), metavar="NAME,NAME", help="cpu, wall or both; none: \"\"")
    sub.add_argument("--no-instructions", action="store_true", help="don't count instructions (valgrind)")
    sub.add_argument("--device", default="", help="index or part of the name (volmark device)")
    sub.add_argument("--results", type=Path, default=_RESULTS, metavar="DIR", help="verdicts, history, calibration, builds "
                     "(default: results/gate)")


def _positive(text: str) -> float:
    value = float(text)
    if not 0 < value < 1e6:
        raise argparse.ArgumentTypeError(f"found {text}, allowed: a number above 0")
    return value


def _count(text: str) -> int:
    value = int(text)
    if not 1 <= value <= 10000:
        raise argparse.ArgumentTypeError(f"found {text}, allowed: 1 to 10000")
    return value


def _caught(action):
    """Bad input is handled by the program's main; what the gate adds is here."""
    def run(options) -> int:
        try:
            return action(options)
        except MachineError as error:
            print(f"volmark_analysis: {error}", file=sys.stderr)
            return 3
        except KeyboardInterrupt:
            print("volmark_analysis: interrupted", file=sys.stderr)
            return 130
        except OSError as error:
            raise InputError(f"{error.filename or options.results}: {error.strerror or error}") from None
    return run


def _rules(options) -> Rules:
    clocks = tuple(c.strip() for c in options.clocks.split(",") if c.strip())
    for clock in clocks:
        if clock not in CLOCKS:
            raise InputError(f"--clocks: found {clock!r}, allowed: {', '.join(CLOCKS)}")
    return Rules(margin=options.margin / 100, clocks=clocks, accept_changes=getattr(options, "accept_changes", False))


def _gate(options) -> int:
    rules = _rules(options)
    baseline = Path(options.base) if options.base and options.base.endswith(".json") else None
    if options.judge:
        return _report(options, judge_folder(options.judge, rules, options.results / "calibration.json", baseline))
    if not options.base and not options.store_baseline:
        raise InputError("--base: missing, allowed: a revision, a build folder, an installed prefix or a stored baseline")
    clock = Clock(options.minutes)
    names = {BASE: options.base, CANDIDATE: options.candidate} if options.base and not baseline \
        else {CANDIDATE: options.candidate}
    builds = {name: resolve(text, f"--{name}", options.results / "builds", clock.say) for name, text in names.items()}
    clock = Clock(options.minutes)
    gate = Gate(builds, _scenarios(options, builds[CANDIDATE].program), _folder(options), clock, rules,
                shaders=options.results / "shaders", device=options.device, pairs=options.pairs,
                instructions=not options.no_instructions, baseline=baseline)
    measure(gate)
    judged = judge_folder(gate.folder, rules, options.results / "calibration.json", baseline, gate.notes, clock.spent)
    if BASE in builds or baseline:
        remember(judged, options.results / "history.jsonl")
    return _report(options, judged)


def _report(options, judged) -> int:
    if options.store_baseline:
        store_baseline(judged, options.store_baseline)
        print(f"stored {options.store_baseline}", file=sys.stderr)
        if not options.base:
            return 0
    sys.stdout.write(judged.markdown)
    if judged.verdict.outcome == INCONCLUSIVE and options.allow_inconclusive:
        return 0
    return EXIT_CODES[judged.verdict.outcome]


def _scenarios(options, program: Path) -> list:
    configs = options.configs or sorted(Path("configs/ci").glob("*.json"))
    if not configs:
        raise InputError("--configs: no file in configs/ci; run this from the repository's folder, or name scenarios")
    scenarios = [read_scenario(program, config) for config in configs]
    names = [s.name for s in scenarios]
    if len(set(names)) < len(names):
        raise InputError(f"--configs: two scenarios have one name ({', '.join(names)})")
    return scenarios


def _folder(options) -> Path:
    folder = options.output or options.results / datetime.now(timezone.utc).strftime("%Y%m%d-%H%M%S")
    if folder.exists() and any(folder.iterdir()):
        raise InputError(f"--output: {folder} is not empty")
    return folder


def _calibrate(options) -> int:
    rules, clock = _rules(options), Clock()
    build = resolve(options.program, "--program", options.results / "builds", clock.say)
    folder = options.results / datetime.now(timezone.utc).strftime("calibration-%Y%m%d-%H%M%S")
    task = Calibration(build, _scenarios(options, build.program), folder, clock, rules, pairs=options.pairs,
                       shares=[p / 100 for p in options.slowdown or [5.0]], trials=options.trials, load=options.load,
                       shaders=options.results / "shaders", device=options.device,
                       instructions=not options.no_instructions)
    document = run_calibration(task)
    save(folder / "calibration.json", document)
    save(options.results / "calibration.json", document)
    print(options.results / "calibration.json")
    return 0


def _history(options) -> int:
    entries = history.read_history(options.file)
    tolerance = Rules.instructions_tolerance
    for path in history.write_plot(options.output or options.file.parent, entries, tolerance):
        print(path)
    for line in history.changes_text(history.series_of(entries, tolerance), entries):
        print(line)
    return 0
