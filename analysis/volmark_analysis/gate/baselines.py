"""Stored baselines: what repeats exactly, of one commit on one driver. Times are not in them: a time that was measured on
another day says nothing about today's machine."""

from __future__ import annotations

import json
import os
from pathlib import Path

from ..errors import InputError
from .evidence import CANDIDATE, VERSION, Evidence, Side, read_document
from .exact import Exact

FORMAT = "volmark.baseline"


def write_baseline(path: Path, exact: dict[str, Exact], device: str, side: Side, created: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    document = {"format": FORMAT, "version": VERSION, "name": side.name, "commit": side.commit, "created": created,
                "device": device, "points": {key: e.to_json() for key, e in exact.items()}}
    staged = path.with_name(path.name + ".part")
    staged.write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    os.replace(staged, path)


def read_baseline(path: Path, evidence: Evidence) -> dict[str, Exact]:
    """By point. Raises InputError, also if the evidence was made on another device or driver: counters, pictures and
    instructions depend on it."""
    document = read_document(path, FORMAT)
    try:
        stored = {str(key): Exact.from_json(e) for key, e in document["points"].items()}
        device, name, commit = (str(document[key]) for key in ("device", "name", "commit"))
    except (KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{path}: damaged ({type(error).__name__}: {error})") from None
    runs = [run for point in evidence.points for run in point.completed(CANDIDATE)]
    found = {str(run.provenance.get("device", {}).get("identity", "")) for run in runs}
    if found - {device}:
        raise InputError(f"{path}: stored on {device!r}, found {sorted(found)[0]!r}; store it again on this driver")
    evidence.base = Side(name, commit, "baseline")
    return stored
