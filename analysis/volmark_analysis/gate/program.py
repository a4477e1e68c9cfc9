"""Calls of the program: expansion, runs of both builds in turns, and instructions per frame."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

from ..errors import InputError
from .builds import MachineError
from .evidence import BASE, CANDIDATE

INSTRUCTIONS_PROFILE = "instructions"
"""A scenario's own profile of this name makes its points small enough to be counted."""
_COUNTING_DEVICE = "llvmpipe"
"""Runs shaders on the processor, whatever device the times are of."""
_FRAME_END = "volmark::Session::complete()"
"""The function that ends a frame: what callgrind counted is written out there."""


@dataclass
class Scenario:
    config: Path
    name: str
    points: list[dict]
    """{"index", "labels", "config"} of each."""
    has_instructions: bool


def read_scenario(program: Path, config: Path) -> Scenario:
    """Raises InputError."""
    try:
        document = json.loads(config.read_text(encoding="utf-8"))
        name, profiles = str(document["name"]), document.get("profiles", {})
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{config}: not a scenario ({error})") from None
    has_instructions = isinstance(profiles, dict) and INSTRUCTIONS_PROFILE in profiles
    return Scenario(config, name, expand(program, config), has_instructions)


def expand(program: Path, config: Path, profile: str = "") -> list[dict]:
    output = _checked([str(program), "expand", str(config), *(["--profile", profile] if profile else [])])
    return [json.loads(line) for line in output.splitlines() if line.startswith("{")]


def _checked(command: list[str]) -> str:
    done = _started(subprocess.run, command, capture_output=True, text=True)
    if done.returncode != 0:
        raise _error(command, done.returncode, done.stderr)
    return done.stdout


def _started(start, command: list[str], **options):
    try:
        return start(command, **options)
    except OSError as error:
        raise InputError(f"{command[0]}: can't be started ({error.strerror or error})") from None


def _error(command: list[str], code: int, text: str) -> Exception:
    lines = [line for line in text.splitlines() if line.strip()] or ["no message"]
    message = f"{' '.join(command[:3])}: exit code {code}: {lines[-1]}"
    return MachineError(message) if code == 3 else InputError(message)


def run(programs: dict[str, Path], scenario: Scenario, results: Path, replicates: int, device: str,
        points: list[int] | None = None, seed: int = 1) -> None:
    """Runs what is missing of the first `replicates` processes of each point and build; those that fail are rows of the
    experiment. Raises InputError and MachineError."""
    command = [str(_runner(programs)), "run", str(scenario.config), "--results", str(results), "--no-index",
               "--set", f"measure.replicates={replicates}", "--set", f"measure.seed={seed}"]
    for name, program in programs.items():
        command += ["--build", f"{name}={program}"]
    if points is not None:
        command += ["--points", ",".join(map(str, points))]
    if device:
        command += ["--device", device]
    results.mkdir(parents=True, exist_ok=True)
    log = results / f"{scenario.name}.log"
    with open(log, "a+", encoding="utf-8") as output:
        start = output.tell()
        done = _started(subprocess.run, command, stdout=output, stderr=subprocess.STDOUT)
        if done.returncode not in (0, 1):
            output.seek(start)
            raise _error(command, done.returncode, output.read())


def _runner(programs: dict[str, Path]) -> Path:
    """The candidate, or base where the candidate is a script: what a script sets would reach the workers of both."""
    is_script = [name for name, program in programs.items() if program.open("rb").read(2) == b"#!"]
    return programs[BASE] if is_script == [CANDIDATE] and BASE in programs else programs[CANDIDATE]


@dataclass
class Count:
    per_frame: float
    frames: list[int]
    """Of the last orbit, one by one."""


def kept_count(kept: Path | None, program: Path, scenario: Scenario, point: int, folder: Path, shaders: Path) -> Count:
    """count_instructions, or what it found before for the same program, scenario, drivers, processor and valgrind. Raises
    MachineError."""
    if kept is None or shutil.which("valgrind") is None:
        return count_instructions(program, scenario, point, folder, shaders)
    facts = [scenario.config.read_text(encoding="utf-8"), str(point), _checked([str(program), "device"]),
             _checked(["valgrind", "--version"]), _cpu_model()]
    path = kept / f"{hashlib.sha256(json.dumps(facts).encode()).hexdigest()[:32]}.json"
    try:
        frames = [int(n) for n in json.loads(path.read_text(encoding="utf-8"))]
        return Count(sum(frames) / len(frames), frames)
    except (OSError, ValueError, TypeError, ZeroDivisionError):
        pass  # counted for the first time, or a file that was cut
    count = count_instructions(program, scenario, point, folder, shaders)
    kept.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(count.frames) + "\n", encoding="utf-8")
    return count


def _cpu_model() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return ""
    return next((line for line in lines if line.startswith("model name")), "")


def count_instructions(program: Path, scenario: Scenario, point: int, folder: Path, shaders: Path,
                       environment: dict[str, str] | None = None) -> Count:
    """Instructions of a frame, shader code included: the frames of the last of two orbits, each counted from the end of
    the frame before to its own. `shaders` keeps compiled shaders. Raises MachineError with the reason if they can't be
    counted."""
    if shutil.which("valgrind") is None:
        raise MachineError("valgrind is not installed; run ci/bootstrap.sh")
    profile = INSTRUCTIONS_PROFILE if scenario.has_instructions else ""
    expanded = {p["index"]: p for p in expand(program, scenario.config, profile)}
    frames = expanded[point]["config"]["pacing"]["frames"]
    shutil.rmtree(folder, ignore_errors=True)
    for path in (folder, shaders):
        path.mkdir(parents=True, exist_ok=True)
    written = str(folder).replace("%", "%%")
    draw = [str(program), "draw", str(scenario.config), "--point", str(point), "--device", _COUNTING_DEVICE]
    draw += ["--profile", profile] if profile else []
    everything = {**os.environ, **(environment or {}), "LP_NUM_THREADS": "0",
                  "MESA_SHADER_CACHE_DIR": str(shaders.resolve())}
    # Compiling differs from process to process, and takes minutes under callgrind. valgrind without a tool shows the
    # driver the same processor, so what it compiles there is found by the run that counts.
    for options in (["--tool=none", *draw, "--orbits", "0"],
                    ["--tool=callgrind", f"--dump-after={_FRAME_END}", f"--callgrind-out-file={written}/counts.%p",
                     *draw, "--orbits", "2"]):
        command = ["valgrind", "--trace-children=yes", f"--log-file={written}/log.%p", *options]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", env=everything)
        if done.returncode != 0:
            raise MachineError(str(_error(draw, done.returncode, done.stderr)))
    totals = read_totals(folder)
    # The last part is what came after the last frame.
    if len(totals) < 2 * frames + 1:
        raise MachineError(f"{program}: {max(len(totals) - 1, 0)} of {2 * frames} frames were counted; has it the "
                           f"symbol {_FRAME_END}?")
    last = totals[-1 - frames:-1]
    return Count(sum(last) / frames, last)


def read_totals(folder: Path) -> list[int]:
    """Of the parts that callgrind wrote, in the order in which they ended."""
    parts = {}
    for path in folder.glob("counts.*"):
        text = path.read_text(encoding="utf-8", errors="replace")
        part, total = re.search(r"^part: (\d+)$", text, re.M), re.search(r"^totals: (\d+)", text, re.M)
        if part and total:
            parts[path.name.split(".")[1], int(part[1])] = int(total[1])
    # A wrapper script that starts the program instead of becoming it leaves parts of its own.
    by_process: dict[str, list[int]] = {}
    for (process, _), total in sorted(parts.items(), key=lambda item: item[0][1]):
        by_process.setdefault(process, []).append(total)
    return max(by_process.values(), key=len, default=[])
