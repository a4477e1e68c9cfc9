"""What must agree between two builds for a comparison to mean something, and what only has to be said beside it."""

from __future__ import annotations

import json
from typing import Any, Iterable

import numpy as np

from ..errors import InputError
from ..load import Run
from ..points import device_of

# Different values here make every number incomparable.
_REFUSED = {"device": lambda run: _joined(device_of(run)), "machine": lambda run: _host(run, "name"),
            "processor": lambda run: _host(run, "cpu"), "kernel": lambda run: _host(run, "kernel")}
_LABELLED = {"governor": lambda run: _host(run, "governor"),
             "build type": lambda run: _dig(run.provenance, "build", "type"),
             "compiler": lambda run: _dig(run.provenance, "build", "compiler"),
             "compiler flags": lambda run: _dig(run.provenance, "build", "flags")}
_BUSY_SHARE = 0.05
"""Of frames that had competition for the CPU."""


def refuse_different(base: list[Run], candidate: list[Run], where: str) -> None:
    """Raises InputError if the runs of a point were made on different devices, machines or data. What either side
    doesn't know is not held against the other."""
    for what, value_of in _REFUSED.items():
        a, b = _values(base, value_of), _values(candidate, value_of)
        if len(a | b) > 1:
            raise InputError(f"{where}: can't be compared, different {what}: base {_text(a)}, candidate {_text(b)}")
    a, b = base[0], candidate[0]
    if a.point == b.point:
        return
    different = [f"{key} {_short(x)}, {_short(y)}" for key, x, y in _differences(_settings(a), _settings(b))]
    if different:
        raise InputError(f"{where}: can't be compared, different settings (base, candidate): {'; '.join(different[:3])}")
    if not _known_to_one(_settings(a), _settings(b)):
        raise InputError(f"{where}: can't be compared, the builds saw different data under equal settings")


def labels_of(base: list[Run], candidate: list[Run]) -> list[str]:
    """What differs, or was bad on both sides, without making the comparison meaningless."""
    labels = []
    for what, value_of in _LABELLED.items():
        a, b = _values(base, value_of), _values(candidate, value_of)
        if a != b:
            labels.append(f"different {what}: base {_text(a)}, candidate {_text(b)}")
    labels += _environment_labels(base, candidate)
    governors = _values(base + candidate, _LABELLED["governor"])
    if governors and governors != {"performance"}:
        labels.append(f"governor {_text(governors)}: the clock frequency may have changed meanwhile")
    for side, runs in (("base", base), ("candidate", candidate)):
        if any(_dig(run.provenance, "build", "type") not in (None, "Release") for run in runs):
            labels.append(f"{side} is not a Release build")
        if any(_dig(run.provenance, "program", "dirty") for run in runs):
            labels.append(f"{side} was built from uncommitted changes")
    one_sided = _known_to_one(_settings(base[0]), _settings(candidate[0]))
    if one_sided:
        labels.append(f"settings that only one build knows: {', '.join(one_sided)}")
    return labels


def load_label(runs: list[Run]) -> str | None:
    """Said of a machine that others used meanwhile."""
    causes = [run.headline.disturbed.to_numpy() for run in runs]
    frames = sum(map(len, causes))
    disturbed = sum(np.isin(c, ("", "0"), invert=True).sum() for c in causes)
    if disturbed <= _BUSY_SHARE * frames:
        return None
    return f"{100 * disturbed / frames:.0f} % of the frames had competition for the CPU"


def _settings(run: Run) -> dict[str, Any]:
    config = {key: value for key, value in run.config.items() if key != "measure"}
    return dict(_flat("", config))


def _flat(prefix: str, value: Any) -> Iterable[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _flat(f"{prefix}.{key}" if prefix else key, inner)
    else:
        yield prefix, value


def _differences(a: dict[str, Any], b: dict[str, Any]) -> list[tuple[str, Any, Any]]:
    return [(key, a[key], b[key]) for key in a if key in b and a[key] != b[key]]


def _known_to_one(a: dict[str, Any], b: dict[str, Any]) -> list[str]:
    return sorted(a.keys() ^ b.keys())


def _values(runs: list[Run], value_of) -> set[str]:
    return {str(value) for value in map(value_of, runs) if value not in (None, "")}


def _text(values: set[str]) -> str:
    return _short(" / ".join(sorted(values))) if values else "unknown"


def _short(value: Any) -> str:
    text = value if isinstance(value, str) else json.dumps(value)
    return text if len(text) <= 80 else text[:77] + "..."


def _environment_labels(base: list[Run], candidate: list[Run]) -> list[str]:
    """Of the variables that differ."""
    def value_of(name):
        return lambda run: (_dig(run.provenance, "environment") or {}).get(name, "unset")
    names = sorted({name for run in base + candidate for name in _dig(run.provenance, "environment") or {}})
    return [f"different environment {name}: base {_text(_values(base, value_of(name)))}, "
            f"candidate {_text(_values(candidate, value_of(name)))}" for name in names
            if _values(base, value_of(name)) != _values(candidate, value_of(name))]


def _host(run: Run, key: str) -> Any:
    return _dig(run.provenance, "host", key)


def _joined(device: tuple[str, str]) -> str:
    return " / ".join(part for part in device if part)


def _dig(value: Any, *keys: str) -> Any:
    for key in keys:
        if not isinstance(value, dict):
            return None
        value = value.get(key)
    return value
