"""The two builds: folders that hold a program, or revisions that are built once and kept."""

from __future__ import annotations

import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Callable

from ..errors import InputError
from .evidence import Side


class MachineError(Exception):
    """This machine lacks something: one line, exit code 3."""


@dataclass
class Build:
    side: Side
    program: Path
    counts: Path | None = None
    """Where counts of instructions are kept; None for a folder, whose program may change."""


def resolve(text: str, option: str, cache: Path, say: Callable[[str], None]) -> Build:
    """`text`: a folder with a program (a build folder or an installed prefix), or a revision of this repository."""
    folder = Path(text)
    if folder.is_dir():
        return Build(Side(text), program_in(folder, option))
    if folder.exists():
        raise InputError(f"{option}: {text} is a file, expected a folder with the program volmark, or a revision")
    commit = _commit(text)
    if commit is None:
        raise InputError(f"{option}: {text!r} is neither a folder nor a revision of the repository in {Path.cwd()}")
    return Build(Side(text, commit), _built(commit, cache, say), cache / f"{commit[:12]}.counts")


def program_in(folder: Path, option: str) -> Path:
    for place in (folder / "volmark", folder / "bin" / "volmark"):
        if place.is_file() and os.access(place, os.X_OK):
            return place.resolve()
    raise InputError(f"{option}: {folder}: no program volmark or bin/volmark there")


def _commit(revision: str) -> str | None:
    return _git(["rev-parse", "--verify", "--quiet", "--end-of-options", f"{revision}^{{commit}}"])


def _git(arguments: list[str]) -> str | None:
    try:
        done = subprocess.run(["git", *arguments], capture_output=True, text=True)
    except FileNotFoundError:
        raise MachineError("git is not installed; run ci/bootstrap.sh") from None
    return done.stdout.strip() if done.returncode == 0 else None


def _built(commit: str, cache: Path, say: Callable[[str], None]) -> Path:
    """The release preset in a work tree of its own, without tests."""
    source = (cache / commit[:12]).resolve()
    program, mark = source / "build" / "release" / "volmark", source / "build" / "complete"
    if mark.exists() and program.is_file():
        return program
    for tool in ("cmake", "ninja"):
        if shutil.which(tool) is None:
            raise MachineError(f"{tool} is not installed; run ci/bootstrap.sh")
    cache.mkdir(parents=True, exist_ok=True)
    log = cache.resolve() / f"{commit[:12]}.log"
    say(f"building {commit[:12]} (log: {log})")
    commands = [["cmake", "--preset", "release", "-DVOLMARK_TESTS=OFF"],
                ["cmake", "--build", "--preset", "release", "--parallel"]]
    with open(log, "w", encoding="utf-8") as output:
        if not (source / "CMakeLists.txt").exists():
            _logged(["git", "worktree", "prune"], None, output, commit, log)
            _logged(["git", "worktree", "add", "--force", "--detach", str(source), commit], None, output, commit, log)
        for command in commands:
            _logged(command, source, output, commit, log)
    mark.write_text(commit + "\n")
    return program


def _logged(command: list[str], folder: Path | None, output, commit: str, log: Path) -> None:
    output.write(f"$ {' '.join(command)}\n")
    output.flush()
    if subprocess.run(command, cwd=folder, stdout=output, stderr=subprocess.STDOUT).returncode != 0:
        raise InputError(f"{commit[:12]}: {command[0]} {command[1]} failed, see {log}")
