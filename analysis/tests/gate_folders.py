"""Verdict folders as a gate leaves them, made up: both builds' runs of small points with known times, counters, pictures."""

import csv
import hashlib
import json
import math

import numpy as np
from exr_writer import write_exr

FRAMES, ORBITS, SIZE = 4, 3, (12, 16)
DEVICE = "llvmpipe (LLVM 15) / llvmpipe / Mesa 25"


def make_side(**changes):
    """What a build does at a point. `cpu`, `wall`: times relative to the base's. `noise`: of a process's log time."""
    side = {"cpu": 1.0, "wall": 1.0, "noise": 0.002, "counters": {"samples": 9000.0, "rays": 120.0}, "picture": 0.5,
            "mse": 1e-4, "status": "completed", "reason": "", "instructions": 10e6, "checks": True, "config": {},
            "deterministic": True, "provenance": {}, "device": DEVICE, "governor": "performance", "disturbed": "",
            "statistical": 5.0, "repeats": True, "point_hash": "same"}
    unknown = changes.keys() - side.keys()
    assert not unknown, unknown
    return side | changes


def write_gate(folder, points, pairs=12, confirming=0, seed=1, title="A title", base="main", candidate="build/release"):
    """`points`: {(scenario, technique): (side of base, side of candidate)}."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "gate.json").write_text(json.dumps({
        "format": "volmark.gate", "version": 1, "base": {"name": base, "commit": "b" * 40, "source": "build"},
        "candidate": {"name": candidate, "commit": "c" * 40, "source": "build"}}))
    for stage, count in (("first", pairs), ("confirmation", confirming)):
        for scenario in dict.fromkeys(s for s, _ in points) if count else ():
            mine = {technique: sides for (s, technique), sides in points.items() if s == scenario}
            write_experiment(folder / stage / scenario, scenario, mine, count, seed + (stage == "confirmation"), title)
    counts = [{"scenario": s, "labels": {"technique": t}, "build": build, "per_frame": side["instructions"]}
              for (s, t), sides in points.items() for build, side in zip(("base", "candidate"), sides)
              if side and side["instructions"]]
    (folder / "instructions.json").write_text(json.dumps({"format": "volmark.instructions", "version": 1, "counts": counts}))
    return folder


def write_experiment(folder, name, points, pairs, seed=1, title="A title"):
    folder.mkdir(parents=True, exist_ok=True)
    listed = [{"index": i, "labels": {"technique": t}, "block": 0, "group": ""} for i, t in enumerate(points)]
    (folder / "experiment.json").write_text(json.dumps({
        "format": "volmark.experiment", "version": 1, "name": name, "title": title, "description": "", "config_file": "",
        "profile": "", "assignments": [], "created": "2024-05-06T07:08:09Z", "program": {}, "scenario": {},
        "axes": ["technique", "build"], "points": listed}))
    rng = np.random.default_rng([seed, *name.encode()])
    for index, (technique, sides) in enumerate(points.items()):
        for replicate in range(pairs):
            shared = math.exp(rng.normal(0, 0.2))  # what the machine did to both of a pair
            for build, side in zip(("base", "candidate"), sides):
                if side is not None:
                    _write_run(folder, index, technique, build, replicate, side, shared, rng)
    return folder


def _write_run(folder, index, technique, build, replicate, side, shared, rng):
    name = hashlib.md5(f"{technique} {build} {replicate}".encode()).hexdigest()
    run = folder / "runs" / name[:2] / name
    run.mkdir(parents=True, exist_ok=True)
    kinds = {"samples": "exact", "rays": "per_device", "luck": "statistical"}
    counters = side["counters"] | {"luck": side["statistical"]}
    if not side["repeats"]:
        counters["samples"] += replicate
    document = {
        "format": "volmark.run", "version": 1, "run": name, "point": side["point_hash"], "replicate": replicate,
        "point_index": index, "group": "", "labels": {"technique": technique, "build": build}, "status": side["status"],
        "reason": side["reason"], "config": {"scene": "noise", "pacing": {"frames": FRAMES}} | side["config"],
        "technique": {"name": technique, "deterministic": side["deterministic"],
                      "counters": [{"name": n, "kind": kinds.get(n, "exact"), "documentation": ""} for n in counters]},
        "checks": [{"name": "timed_frame_equals_replay", "passed": side["checks"], "detail": "it <b>differs</b>"}],
        "provenance": {"program": {"version": "0.1", "commit": "", "dirty": False}, "build": {"compiler": "GNU 12", "type": "Release"},
                       "host": {"name": "here", "cpu": "a processor", "kernel": "6.1", "governor": side["governor"]},
                       "environment": {}, "device": {"identity": side["device"], "name": side["device"]}} | side["provenance"]}
    if side["status"] == "completed":
        process = shared * math.exp(rng.normal(0, side["noise"]))
        times = process * np.exp(rng.normal(0, 0.002, (ORBITS, FRAMES)))
        rows = ["# volmark.frames 1",
                "orbit_kind,orbit,frame,phase,host_ms,interval_ms,cpu_ms,update_ms,draw_ms,frame_ms,gpu_ms,disturbed"]
        for orbit in range(ORBITS):
            for frame in range(FRAMES):
                wall, cpu = 10 * side["wall"] * times[orbit, frame], 18 * side["cpu"] * times[orbit, frame]
                rows.append(f"headline,{orbit},{frame},{frame / FRAMES},{wall},{wall},{cpu},0.1,{wall},{wall},,{side['disturbed']}")
        (run / "frames.csv").write_text("\n".join(rows) + "\n")
        with open(run / "counters.csv", "w", newline="") as file:
            file.write("# volmark.counters 1\n")
            rows = [[f, f / FRAMES, *(v + f for v in counters.values())] for f in range(FRAMES)]
            csv.writer(file).writerows([["frame", "phase", *counters], *rows])
        rgba = {c: np.full(SIZE, side["picture"] + (0 if side["repeats"] else replicate / 8), "<f2") for c in "RGBA"}
        write_exr(run / "frame.exr", rgba)
        document |= {
            "statistics": {"frame": dict.fromkeys(("mean_ms", "median_ms", "p99_ms", "low1_avg_ms", "low1_integral_ms",
                                                   "fps", "clock_mean_ms", "min_ms", "max_ms"), 1.0)},
            "counters": counters, "generation": [], "memory": {},
            "pictures": [{"frame": 0, "view": 0, "phase": 0.0, "file": "frame.exr", "reference": "cpu", "mse": side["mse"],
                          "identical": False, "ssim": 0.99}]}
    (run / "run.json").write_text(json.dumps(document))
