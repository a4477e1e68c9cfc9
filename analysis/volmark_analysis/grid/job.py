"""One scenario with its options, and what the volmark program tells about it."""

from __future__ import annotations

import json
import shutil
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..errors import InputError

_BUILT = Path(__file__).resolve().parents[3] / "build" / "release" / "volmark"


@dataclass(frozen=True)
class PlannedPoint:
    """A line of `volmark expand`."""

    index: int
    labels: dict[str, str]
    group: str
    config: dict[str, Any]


@dataclass(frozen=True)
class Job:
    """All paths are absolute: machines that share the folders run the same commands."""

    program: Path
    config: Path
    results: Path
    scenario_options: tuple[str, ...]
    """--profile and --set: what the expansion depends on."""
    run_options: tuple[str, ...]

    def with_assignment(self, assignment: str) -> "Job":
        return replace(self, scenario_options=(*self.scenario_options, "--set", assignment))

    @property
    def folder(self) -> Path:
        """The experiment's; it may not be there yet."""
        try:
            return self.results / json.loads(self.config.read_text(encoding="utf-8"))["name"]
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise InputError(f"{self.config}: no scenario with a name ({error})") from None

    @property
    def has_begun(self) -> bool:
        """The program has opened the experiment."""
        return (self.folder / "experiment.json").is_file()

    def expand_command(self) -> list[str]:
        return [str(self.program), "expand", str(self.config), *self.scenario_options]

    def run_command(self) -> list[str]:
        """To be followed by --points."""
        return [str(self.program), "run", str(self.config), *self.scenario_options, "--results", str(self.results),
                *self.run_options, "--no-index"]

    def index_command(self) -> list[str]:
        return [str(self.program), "index", str(self.folder)]

    def expansion(self) -> str:
        """What `volmark expand` prints."""
        return _output_of(self.expand_command())

    def points(self) -> list[PlannedPoint]:
        points = []
        for line in self.expansion().splitlines():
            try:
                point = json.loads(line)
                points.append(PlannedPoint(point["index"], point["labels"], point["group"], point["config"]))
            except (ValueError, KeyError, TypeError):
                raise InputError(f"{self.program}: expand printed {line[:60]!r}, expected a point with index, labels, group "
                                 f"and config") from None
        return points

    def status(self) -> dict[str, Any]:
        """`volmark status`: counts of runs, and left_points."""
        return json.loads(_output_of([str(self.program), "status", str(self.folder), "--json"]))

    def write_index(self) -> None:
        _output_of(self.index_command())


def find_program(chosen: Path | None) -> Path:
    """`chosen`, else this checkout's, else that on the PATH."""
    if chosen is None:
        found = _BUILT if _BUILT.is_file() else shutil.which("volmark")
        if found is None:
            raise InputError(f"no volmark program: found neither {_BUILT} nor one on the PATH; build it, or use --program")
        return Path(found).resolve()
    if not chosen.is_file():
        raise InputError(f"--program: {chosen}: no such file")
    return chosen.resolve()


def _output_of(command: list[str]) -> str:
    """Standard output. Raises InputError with the program's own line if it failed."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", stdin=subprocess.DEVNULL)
    except OSError as error:
        raise InputError(f"{command[0]}: {error.strerror or error}") from None
    if done.returncode != 0:
        said = done.stderr.strip().splitlines()
        raise InputError(said[-1] if said else f"{' '.join(command[:2])}: exit code {done.returncode}")
    return done.stdout
