"""An experiment folder in memory. The formats are those of harness/README.md, section 7, version 1."""

from __future__ import annotations

import csv
import io
import json
import math
from dataclasses import dataclass, field
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from .errors import DamagedFile, InputError

VERSION = 1
STATUSES = ("completed", "failed", "crashed", "timed_out", "unsupported", "out_of_memory")
STATISTICS = ("mean_ms", "median_ms", "p99_ms", "low1_avg_ms", "low1_integral_ms", "fps", "clock_mean_ms", "min_ms",
              "max_ms")
ORBIT_KINDS = ("warm_up", "headline", "breakdown")
_FRAME_TIMES = ("host_ms", "interval_ms", "cpu_ms", "update_ms", "draw_ms", "frame_ms", "gpu_ms")

_NUMBER = (int, float)
_NAMES = {dict: "an object", list: "a list", str: "text", bool: "true or false", int: "an integer",
          _NUMBER: "a number", type(None): "nothing"}


@dataclass
class Point:
    """One combination of a scenario's axes."""

    index: int
    labels: dict[str, str]
    block: int
    group: str


@dataclass
class Run:
    """One run.json. Parts that a run lacks are empty; `statistics` is empty unless it completed."""

    folder: Path
    run: str
    point: str
    replicate: int
    point_index: int | None
    """None: the point has left the scenario since."""
    group: str
    labels: dict[str, str]
    status: str
    reason: str
    config: dict[str, Any]
    technique: dict[str, Any]
    statistics: dict[str, Any]
    generation: list[dict[str, Any]]
    counters: dict[str, float]
    memory: dict[str, Any]
    pictures: list[dict[str, Any]]
    checks: list[dict[str, Any]]
    provenance: dict[str, Any]
    prepare_ms: float | None = None
    first_frame_ms: float | None = None

    @property
    def completed(self) -> bool:
        return self.status == "completed"

    @cached_property
    def columns(self) -> dict[str, np.ndarray]:
        """frames.csv by column: a value per drawn frame."""
        path = self.folder / "frames.csv"
        columns = read_csv(path, "frames", ["orbit_kind", "orbit", "frame", "phase", *_FRAME_TIMES, "disturbed"],
                           text=("orbit_kind", "disturbed"))
        kinds = columns["orbit_kind"]
        unknown = set(kinds) - set(ORBIT_KINDS)
        if unknown:
            raise InputError(f"{path}: column orbit_kind: found {sorted(unknown)[0]!r}, allowed: {', '.join(ORBIT_KINDS)}")
        if self.completed and "headline" not in kinds:
            raise InputError(f"{path}: no headline frames in a completed run")
        if not (columns["frame_ms"][kinds == "headline"] > 0).all():
            raise InputError(f"{path}: column frame_ms: a headline frame has no time above 0")
        return columns

    @cached_property
    def _is_headline(self) -> np.ndarray:
        return self.columns["orbit_kind"] == "headline"

    def headline_values(self, column: str) -> np.ndarray:
        """One column of the headline frames."""
        return self.columns[column][self._is_headline]

    @cached_property
    def frames(self) -> pd.DataFrame:
        """`columns` as a table. Making one takes longer than all arithmetic on a run's few frames: what a report needs of
        every run comes from the columns."""
        return pd.DataFrame(self.columns, copy=False)

    @property
    def headline(self) -> pd.DataFrame:
        return self.frames[self._is_headline]

    @cached_property
    def counter_rows(self) -> pd.DataFrame | None:
        """counters.csv: one row per counted frame; None if there is no such file."""
        path = self.folder / "counters.csv"
        return pd.DataFrame(read_csv(path, "counters", ["frame", "phase"])) if path.exists() else None


@dataclass
class Experiment:
    folder: Path
    name: str
    title: str
    description: str
    config_file: str
    profile: str
    assignments: list[str]
    created: str
    program: dict[str, Any]
    scenario: dict[str, Any]
    axes: list[str]
    points: list[Point]
    runs: list[Run]
    unfinished: list[Path] = field(default_factory=list)
    """Run folders without run.json: still being written, or left by a stopped program."""
    damaged: list[str] = field(default_factory=list)
    """One line for each run that is left out because its files are cut off or overwritten."""

    @property
    def current_runs(self) -> list[Run]:
        """Those whose point the scenario still has."""
        return [run for run in self.runs if run.point_index is not None]


def load_experiment(folder: str | Path) -> Experiment:
    """Reads experiment.json and every run.json; CSV files are read when used. Raises InputError."""
    folder = Path(folder)
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder; expected an experiment folder with experiment.json")
    path = folder / "experiment.json"
    if not path.is_file():
        raise InputError(f"{folder}: no experiment.json here{_nearby(folder)}")
    document = _read_json(path, "volmark.experiment")
    need = _Reader(path, document)
    points = []
    for i, _ in enumerate(need("points", list)):
        labels = need(f"points/{i}/labels", dict)
        points.append(Point(need(f"points/{i}/index", int), {k: str(v) for k, v in labels.items()},
                            need(f"points/{i}/block", int), need(f"points/{i}/group", str)))
    runs, unfinished, damaged = _load_runs(folder)
    if not any(run.point_index is not None for run in runs):
        if damaged:
            raise InputError(damaged[0])
        raise InputError(f"{folder}: no finished run (no runs/*/*/run.json); run the scenario first")
    return Experiment(
        folder=folder, name=need("name", str), title=need("title", str), description=need("description", str),
        config_file=need("config_file", str), profile=need("profile", str), created=need("created", str),
        assignments=[str(a) for a in need("assignments", list)], program=need("program", dict),
        scenario=need("scenario", dict), axes=[str(a) for a in need("axes", list)],
        points=sorted(points, key=lambda p: p.index), runs=runs, unfinished=unfinished,
        damaged=damaged)


def _nearby(folder: Path) -> str:
    """Names experiment folders inside `folder`, for someone who gave the folder above."""
    inside = sorted(p.parent.name for p in folder.glob("*/experiment.json"))
    return f"; experiments inside: {', '.join(inside[:5])}" if inside else ""


def _load_runs(folder: Path) -> tuple[list[Run], list[Path], list[str]]:
    runs, unfinished, damaged = [], [], []
    for run_folder in sorted(p for p in folder.glob("runs/*/*") if p.is_dir()):
        # Hidden folders are being written: their run.json doesn't count yet.
        if not run_folder.name.startswith(".") and (run_folder / "run.json").is_file():
            try:
                runs.append(_load_run(run_folder))
            except DamagedFile as error:
                damaged.append(str(error))
        else:
            unfinished.append(run_folder)
    runs.sort(key=lambda r: (-1 if r.point_index is None else r.point_index, r.replicate, r.run))
    return runs, unfinished, damaged


def _refuse_cut_frames(path: Path, headline_frames: int | None) -> None:
    """Counts rows without reading them: what is cut off, in a line or between two, has fewer than run.json says."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise DamagedFile(f"{path}: {error.strerror or error}, but run.json says that the run completed") from None
    rows = content.count(b"\nheadline,")
    if not content.endswith(b"\n") or (headline_frames is not None and rows < headline_frames):
        raise DamagedFile(f"{path}: cut off: found {rows} headline frames, expected {headline_frames}")


def _load_run(folder: Path) -> Run:
    path = folder / "run.json"
    document = _read_json(path, "volmark.run")
    need = _Reader(path, document)
    status = need("status", str)
    if status not in STATUSES:
        raise InputError(f"{path}: /status: found {status!r}, allowed: {', '.join(STATUSES)}")
    if status == "completed":
        for name in STATISTICS:
            need(f"statistics/frame/{name}", _NUMBER)
        need("technique/name", str)
        _refuse_cut_frames(folder / "frames.csv", document["statistics"].get("frames"))
    for i, _ in enumerate(document.get("pictures") or []):
        need(f"pictures/{i}/frame", int)
        need(f"pictures/{i}/view", int)
        need(f"pictures/{i}/file", str)
    return Run(
        folder=folder, run=need("run", str), point=need("point", str), replicate=need("replicate", int),
        point_index=None if document.get("point_index", 0) is None else need("point_index", int), group=need("group", str),
        labels={k: str(v) for k, v in need("labels", dict).items()}, status=status, reason=need("reason", str),
        config=need("config", dict), technique=need.optional("technique", dict),
        statistics=need.optional("statistics", dict), generation=need.optional("generation", list),
        counters={k: v for k, v in need.optional("counters", dict).items() if v is not None},
        memory=need.optional("memory", dict), pictures=need.optional("pictures", list),
        checks=need.optional("checks", list), provenance=need.optional("provenance", dict),
        prepare_ms=document.get("prepare_ms"), first_frame_ms=document.get("first_frame_ms"))


class _Reader:
    """Reads values at JSON pointers and says in one line what is wrong with them."""

    def __init__(self, path: Path, document: dict):
        self.path, self.document = path, document

    def __call__(self, pointer: str, kind) -> Any:
        value: Any = self.document
        for key in pointer.split("/"):
            if isinstance(value, list):
                value = value[int(key)]
            elif isinstance(value, dict) and key in value:
                value = value[key]
            else:
                raise InputError(f"{self.path}: /{pointer}: missing, expected {_NAMES[kind]}")
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            raise InputError(f"{self.path}: /{pointer}: found {json.dumps(value)[:60]}, expected {_NAMES[kind]}")
        return value

    def optional(self, key: str, kind) -> Any:
        """The value, or an empty one if it is absent or null."""
        return kind() if self.document.get(key) is None else self(key, kind)


def _read_json(path: Path, name: str) -> dict:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise DamagedFile(f"{path}: not JSON ({error})") from None
    if not isinstance(document, dict):
        raise DamagedFile(f"{path}: found {json.dumps(document)[:40]}, expected an object")
    if document.get("format") != name:
        raise InputError(f"{path}: /format: found {json.dumps(document.get('format'))}, allowed: \"{name}\"")
    if document.get("version") != VERSION:
        raise InputError(f"{path}: /version: found {json.dumps(document.get('version'))}, allowed: {VERSION}")
    return document


def read_csv(path: Path, name: str, columns: list[str], text: tuple[str, ...] = ()) -> dict[str, np.ndarray]:
    """A CSV file of volmark by column: `columns` must be there, all but `text` columns must be numbers (empty fields
    become NaN). Raises InputError."""
    try:
        text_of_file = path.read_bytes().decode("utf-8")
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not a table ({error})") from None
    first, _, table = text_of_file.partition("\n")
    expected = f"# volmark.{name} {VERSION}"
    if first.rstrip("\r") != expected:
        raise InputError(f"{path}: line 1: found {first[:60]!r}, allowed: {expected!r}")
    names, fields_of = _columns(path, table)
    for column in columns:
        if column not in names:
            raise InputError(f"{path}: no column {column!r}, found: {', '.join(names)}")
    return {column: np.array(fields, dtype=object) if column in text else _numbers(path, column, fields)
            for column, fields in zip(names, fields_of)}


def _columns(path: Path, table: str) -> tuple[list[str], list[list[str]]]:
    """Names and fields of each column."""
    if not table.strip():
        raise InputError(f"{path}: not a table (no line with the columns)")
    # Neither pandas' reader nor a list per row: with a thousand small files, setting up the one and collecting the
    # others would take most of a report's time.
    if '"' in table or "\r" in table:
        try:
            rows = list(csv.reader(io.StringIO(table, newline="")))
        except csv.Error as error:
            raise InputError(f"{path}: not a table ({error})") from None
        widths = [len(row) for row in rows]
        fields = list(chain.from_iterable(rows))
    else:
        lines = table.removesuffix("\n").split("\n")
        widths = [line.count(",") + 1 for line in lines]
        fields = ",".join(lines).split(",")
    count = widths[0]
    if widths.count(count) < len(widths):
        line, width = next((i, w) for i, w in enumerate(widths, start=2) if w != count)
        raise InputError(f"{path}: not a table (line {line} has {width} fields, expected {count})")
    return fields[:count], [fields[count + i::count] for i in range(count)]


def _numbers(path: Path, column: str, fields: list[str]) -> np.ndarray:
    try:
        return np.array(list(map(float, fields)))
    except ValueError:  # an empty field, or no number
        pass
    try:
        return np.array([float(field) if field else math.nan for field in fields])
    except ValueError:
        line, wrong = next((i, field) for i, field in enumerate(fields, start=3) if field and not _is_number(field))
        raise InputError(f"{path}: line {line}, column {column}: found {wrong!r}, expected a number") from None


def _is_number(field: str) -> bool:
    try:
        float(field)
    except ValueError:
        return False
    return True
