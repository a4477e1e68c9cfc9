"""Writes a realistic experiment to the formats of harness/README.md, section 7, without the code under test."""

import hashlib
import json
import math
import os
import statistics as stdlib
import sys
from itertools import product
from pathlib import Path

import numpy as np

from exr_writer import write_exr

FRAMES, ORBITS, WIDTH, HEIGHT = 24, 3, 96, 72
SCENES = {"nested_ellipsoids": 5, "marschner_lobb": 1}  # replicates
BACKGROUND = [0.02, 0.02, 0.05]

TECHNIQUES = {
    "iso_raymarch": {
        "family": "raymarch", "draws": "isosurface", "history": "none", "deterministic": True,
        "summary": "Marches rays to the first crossing of the isosurface.",
        "paper": "Levoy: Display of Surfaces from Volume Data, 1988", "section": "3",
        "passes": [{"name": "march", "documentation": "One ray per pixel to the first crossing."},
                   {"name": "shade", "documentation": "Normals and light at the hits."}],
        "generation": [{"name": "upload", "documentation": "Copies the volume to a texture."}],
        "counters": [{"name": "samples", "kind": "per_device", "documentation": "Samples of the volume."},
                     {"name": "rays_hit", "kind": "per_device", "documentation": "Rays that hit the surface."}]},
    "dvr_raymarch": {
        "family": "raymarch", "draws": "volume", "history": "none", "deterministic": True,
        "summary": "Integrates emission and absorption along rays.",
        "paper": "Kruger, Westermann: Acceleration Techniques for GPU-based Volume Rendering, 2003", "section": "4",
        "passes": [{"name": "march", "documentation": "One ray per pixel, front to back."}],
        "generation": [{"name": "upload", "documentation": "Copies the volume to a texture."},
                       {"name": "preintegrate", "documentation": "Builds the table of slabs."}],
        "counters": [{"name": "samples", "kind": "per_device", "documentation": "Samples of the volume."}]},
    "dvr_temporal": {
        "family": "temporal", "draws": "volume", "history": "visible", "deterministic": False,
        "summary": "Accumulates jittered rays over frames.", "paper": "", "section": "",
        "passes": [{"name": "march", "documentation": "Few samples per ray."},
                   {"name": "resolve", "documentation": "Mixes with the last frame."}],
        "generation": [], "counters": [{"name": "samples", "kind": "statistical", "documentation": "Samples."}]},
}
BASE_MS = {"iso_raymarch": 9.0, "dvr_raymarch": 17.0, "dvr_temporal": 6.0}


def digest(*parts):
    return hashlib.md5("|".join(map(str, parts)).encode()).hexdigest()


def points():
    listed = []
    for scene in SCENES:
        for technique in ("iso_raymarch", "dvr_raymarch"):
            for step in ("0.5", "1.0"):
                listed.append(({"technique": technique, "scene": scene, "step": step}, 0))
        listed.append(({"technique": "dvr_temporal", "scene": scene}, 1))
    return [{"index": i, "labels": labels, "block": block, "group": f"scene={labels['scene']}"}
            for i, (labels, block) in enumerate(listed)]


def write_experiment(folder, all_failed=False):
    """The folder as volmark leaves it. Returns it."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "experiment.json").write_text(json.dumps({
        "format": "volmark.experiment", "version": 1, "name": "synthetic", "title": "Ray marching, made up",
        "description": "Two ray marchers and a temporal one on two analytic scenes; times & pictures are <invented>.",
        "config_file": "synthetic.json", "profile": "smoke", "assignments": ["resolution=[96,72]"],
        "created": "2024-05-06T07:08:09Z", "program": {"version": "0.1.0", "commit": "0123456789abcdef"},
        "scenario": {"volmark": 1, "name": "synthetic"}, "axes": ["technique", "scene", "step"], "points": points()}))
    rng = np.random.default_rng(7)
    for point in points():
        labels = point["labels"]
        for replicate in range(SCENES[labels["scene"]]):
            status, reason = "completed", ""
            if labels == {"technique": "dvr_raymarch", "scene": "marschner_lobb", "step": "0.5"} or all_failed:
                status, reason = "failed", "VK_ERROR_DEVICE_LOST in pass march | the driver reset the device"
            elif labels["technique"] == "dvr_temporal" and labels["scene"] == "marschner_lobb":
                status, reason = "unsupported", "needs 64-bit atomics, which the device lacks"
            write_run(folder, point, replicate, status, reason, rng)
    staged = folder / "runs" / "ab" / f".{'ab' * 16}.123"  # still being written
    staged.mkdir(parents=True, exist_ok=True)
    (staged / "run.json").write_text('{"format": "volm')
    (staged.parent / f"{'ab' * 16}.claim").write_text('{"format": "volmark.claim", "version": 1}')
    return folder


def write_run(folder, point, replicate, status, reason, rng):
    labels = point["labels"]
    technique = {"name": labels["technique"], "needs_gpu": True, "module_digest": digest(labels["technique"]), **TECHNIQUES[labels["technique"]]}
    step = float(labels.get("step", 1))
    point_hash = digest(sorted(labels.items()))
    run_hash = digest(point_hash, replicate)
    run_folder = folder / "runs" / run_hash[:2] / run_hash
    run_folder.mkdir(parents=True, exist_ok=True)
    document = {
        "format": "volmark.run", "version": 1, "run": run_hash, "point": point_hash, "replicate": replicate,
        "point_index": point["index"], "group": point["group"], "labels": labels, "status": status, "reason": reason,
        "config": {"scene": labels["scene"], "technique": {"name": labels["technique"], "parameters": {"step": step}},
                   "resolution": [WIDTH, HEIGHT], "pacing": {"mode": "frames", "frames": FRAMES, "orbits": ORBITS},
                   "measure": {"replicates": SCENES[labels["scene"]]},
                   "pictures": {"count": 2, "reference": "cpu", "background": BACKGROUND}},
        "technique": technique,
        "checks": [{"name": "timed_frame_equals_replay", "passed": True, "detail": ""}],
        "provenance": {
            "program": {"version": "0.1.0", "commit": "0123456789abcdef", "dirty": False, "digest": "b" * 32},
            "build": {"compiler": "GNU 12.2.0", "flags": "-O2", "type": "Release"}, "libraries": {"glm": "0.9.9.8"},
            "host": {"name": "secret-host", "cpu": "a processor", "usable_cores": 2, "load_average": [rng.random()]},
            "environment": {"LP_NUM_THREADS": "2"},
            "device": {"identity": "llvmpipe / llvmpipe / Mesa", "name": "llvmpipe (LLVM 15, 256 bits)",
                       "driver_name": "llvmpipe", "driver_info": "Mesa 25.0.7", "api_version": "1.4.305"},
            "started": "2024-05-06T07:08:10Z"}}
    if status == "completed":
        rows = frame_rows(labels, step, technique, rng)
        names = [p["name"] for p in technique["passes"]]
        write_csv(run_folder / "frames.csv", "frames", rows, [f"pass.{n}" for n in names])
        counters = counter_rows(technique, step)
        write_csv(run_folder / "counters.csv", "counters", counters)
        pictures = write_pictures(folder, run_folder, labels, step, technique)
        write_csv(run_folder / "pictures.csv", "pictures", pictures)
        document |= {
            "statistics": run_statistics(rows, names), "prepare_ms": 40.5, "first_frame_ms": 31.0,
            "generation": [{"name": g["name"], "host_ms": 3.5, "gpu_ms": 2.25} for g in technique["generation"]],
            "counters": {c["name"]: stdlib.fmean(r[c["name"]] for r in counters) for c in technique["counters"]},
            "memory": {"items": [{"name": "volume", "bytes": 2097152}], "total_bytes": 2097152,
                       "ledger_bytes": 2097152, "ledger_peak_bytes": 2200000},
            "pictures": pictures}
        if labels == {"technique": "iso_raymarch", "scene": "marschner_lobb", "step": "1.0"}:
            document["checks"].append({"name": "memory_equals_ledger", "passed": False,
                                       "detail": "technique says 2097152 bytes, ledger 2100000"})
    (run_folder / "run.json").write_text(json.dumps(document))


def frame_rows(labels, step, technique, rng):
    rows = []
    base = BASE_MS[labels["technique"]] * (1.3 if labels["scene"] == "marschner_lobb" else 1.0) / step**0.7
    process = math.exp(rng.normal(0, 0.02))
    for kind, orbits in (("warm_up", 1), ("headline", ORBITS), ("breakdown", 1)):
        for orbit in range(orbits):
            for frame in range(3 if kind == "warm_up" else FRAMES):
                phase = frame / FRAMES
                ms = base * process * (1 + 0.25 * math.sin(2 * math.pi * phase)) * math.exp(rng.normal(0, 0.03))
                disturbed = "switches" if rng.random() < 0.02 else ""
                ms *= 1.5 if disturbed else 1.0
                row = {"orbit_kind": kind, "orbit": orbit, "frame": frame, "phase": phase, "host_ms": ms + 0.4,
                       "interval_ms": ms + 0.5, "cpu_ms": 1.8 * ms, "update_ms": 0.1, "draw_ms": ms - 0.1,
                       "frame_ms": ms, "gpu_ms": ms, "disturbed": disturbed}
                shares = [0.8, 0.2] if len(technique["passes"]) == 2 else [1.0]
                for entry, share in zip(technique["passes"], shares):
                    row[f"pass.{entry['name']}"] = share * ms if kind == "breakdown" else ""
                rows.append(row)
    return rows


def counter_rows(technique, step):
    return [{"frame": f, "phase": f / FRAMES,
             **{c["name"]: round(90000 / step * (1 + 0.2 * math.sin(2 * math.pi * f / FRAMES)) / (i + 1))
                for i, c in enumerate(technique["counters"])}} for f in range(0, FRAMES, 3)]


def write_csv(path, name, rows, last=()):
    columns = [c for c in rows[0] if c not in last] + list(last)
    lines = [f"# volmark.{name} 1", ",".join(columns)]
    lines += [",".join("" if r[c] is None else str(r[c]) for c in columns) for r in rows]
    path.write_text("\n".join(lines) + "\n")


def plain_statistics(ms):
    """Section 6's definitions, spelled out in plain Python."""
    ordered = sorted(ms)
    place = 0.99 * (len(ms) - 1)
    below = math.floor(place)
    above = min(below + 1, len(ms) - 1)
    slowest = ordered[::-1][: math.ceil(len(ms) / 100)]
    total, covered = sum(ms), 0.0
    for integral in ordered[::-1]:
        covered += integral
        if covered >= 0.01 * total:
            break
    mean = math.fsum(ms) / len(ms)
    return {"count": len(ms), "mean_ms": mean, "median_ms": stdlib.median(ms),
            "p99_ms": ordered[below] + (place - below) * (ordered[above] - ordered[below]),
            "low1_avg_ms": sum(slowest) / len(slowest), "low1_integral_ms": integral, "fps": 1000 / mean,
            "clock_mean_ms": stdlib.harmonic_mean(ms), "min_ms": ordered[0], "max_ms": ordered[-1]}


def run_statistics(rows, passes):
    headline = [r for r in rows if r["orbit_kind"] == "headline"]
    breakdown = [r for r in rows if r["orbit_kind"] == "breakdown"]
    disturbed = sum(1 for r in headline if r["disturbed"])
    part = {name: plain_statistics([r[f"{name}_ms"] for r in headline])
            for name in ("frame", "host", "interval", "cpu", "update", "draw", "gpu")}
    times = {n: [r[f"pass.{n}"] for r in breakdown] for n in passes}
    ratio = stdlib.fmean(r["frame_ms"] for r in breakdown) / part["frame"]["mean_ms"]
    flags = ["insufficient_frames"] + ["stamps_ratio"] * (ratio > 1.03) + ["disturbed"] * (disturbed > 0)
    return {"frames": len(headline), "poses": FRAMES, "orbits": ORBITS, "flags": flags, **part,
            "passes": {n: {"mean_ms": stdlib.fmean(t), "median_ms": stdlib.median(t)} for n, t in times.items()},
            "stamps_ratio": ratio, "disturbed_frames": disturbed}


def sphere(scene, phase, step, surface):
    """A lit ball with ripples: colour (premultiplied, linear) and distance."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    u, v = (x + 0.5 - WIDTH / 2) / (HEIGHT / 2), (y + 0.5 - HEIGHT / 2) / (HEIGHT / 2)
    radius = 0.85 + 0.04 * np.sin(7 * np.arctan2(v, u) + 6 * phase)
    inside = u**2 + v**2 < radius**2
    z = np.sqrt(np.maximum(radius**2 - u**2 - v**2, 0))
    error = 0.02 * step * np.sin(40 * u * step) * np.sin(35 * v)
    light = np.clip(0.1 + 0.9 * (0.6 * z + 0.5 * u - 0.4 * v) + error, 0, 1)
    tint = np.array([0.9, 0.55, 0.3] if scene == "nested_ellipsoids" else [0.35, 0.6, 0.9])
    alpha = inside * (1.0 if surface else np.clip(z * 1.2, 0, 0.97))
    color = np.concatenate([light[..., None] * tint * alpha[..., None], alpha[..., None]], axis=-1)
    distance = np.where(inside, 300 - 60 * z + 20 * error, np.inf)
    return color.astype(np.float32), distance.astype(np.float32)


def write_pictures(folder, run_folder, labels, step, technique):
    rows = []
    surface = technique["draws"] == "isosurface"
    for frame in (0, FRAMES // 2):
        phase = frame / FRAMES
        color, distance = sphere(labels["scene"], phase, step, surface)
        truth, truth_distance = sphere(labels["scene"], phase, 0.0, surface)
        if surface:
            distance[HEIGHT // 2, 24], distance[2, 2] = np.inf, 300.0  # one missed and one spurious pixel
        name = digest("reference", labels["scene"], surface, phase)
        write_layers(folder / "references" / f"{name}.exr", truth, truth_distance if surface else None)
        # One technique counts its iterations and writes normals; the temporal one lacks the newer errors.
        more = iterations(phase, step) if labels["technique"] == "dvr_raymarch" else {}
        newer = {} if labels["technique"] == "dvr_temporal" else {"ssim": 1 - 0.01 * step, "flip": 0.03 * step}
        write_layers(run_folder / f"frame_{frame:04d}.exr", color, distance if surface else None, more)
        mse = plain_mse(color, truth)
        hit = np.isfinite(distance) & np.isfinite(truth_distance)
        apart = np.abs(distance[hit] - truth_distance[hit])
        depth = {"depth_mean_voxels": float(apart.mean()), "depth_p995_voxels": float(np.percentile(apart, 99.5)),
                 "depth_max_voxels": float(apart.max()), "missed_share": 3e-4, "spurious_share": 3e-4}
        rows.append({"frame": frame, "phase": phase, "view": 0, "file": f"frame_{frame:04d}.exr", "reference": "cpu",
                     "reference_file": f"references/{name}.exr", "mse": mse, "psnr_db": -10 * math.log10(mse),
                     "identical": False, **newer, **(depth if surface else dict.fromkeys(depth)),
                     "cumulative_ms": 12.5 * (frame + 1) if technique["history"] == "visible" else None})
    return rows


def encoded(color):
    over = color[..., :3] + (1 - color[..., 3:]) * np.array(BACKGROUND)
    over = np.clip(over.astype(float), 0, 1)
    return np.where(over <= 0.0031308, 12.92 * over, 1.055 * over ** (1 / 2.4) - 0.055)


def plain_mse(a, b):
    return float(np.mean((encoded(a) - encoded(b)) ** 2))


def iterations(phase, step):
    """Channels beside colour: steps of each ray and a normal."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH].astype("<f4")
    return {"steps": np.floor((x + y * (1 + phase)) / step).astype("<f4"), "N.X": 0 * x, "N.Y": 0 * x, "N.Z": 0 * x + 1}


def write_layers(path, color, distance, more=()):
    path.parent.mkdir(parents=True, exist_ok=True)
    channels = {n: np.ascontiguousarray(color[..., i]).astype("<f2") for i, n in enumerate("RGBA")} | dict(more)
    if distance is not None:
        channels["Z"] = distance.astype("<f4")
    write_exr(path, channels)


def write_grid(folder, runs=1000, frames=60):
    """A large experiment: `runs` points of one process each, on four axes. Pictures are links to a few files."""
    small = write_experiment(folder.with_name(folder.name + ".small"))
    templates = {}
    for path in small.glob("runs/*/[!.]*/run.json"):
        document = json.loads(path.read_text())
        if document["labels"]["scene"] == "nested_ellipsoids" and "step" in document["labels"]:
            templates.setdefault(document["labels"]["technique"], (path.parent, document))
    steps = max(1, runs // 100)
    values = product(sorted(templates), range(1, steps + 1), range(1, 11), range(1, 6))
    document = json.loads((small / "experiment.json").read_text()) | {
        "name": "grid", "axes": ["technique", "step", "size", "isovalue"], "points": []}
    for index, (technique, step, size, isovalue) in enumerate(values):
        labels = {"technique": technique, "step": str(step / 4), "size": str(32 * size), "isovalue": str(isovalue / 10)}
        group = f"step={step},size={size},isovalue={isovalue}"
        document["points"].append({"index": index, "labels": labels, "block": 0, "group": group})
        _write_grid_run(folder, small, *templates[technique], document["points"][-1], frames)
    (folder / "experiment.json").write_text(json.dumps(document))
    return folder


def _write_grid_run(folder, small, template_folder, template, point, frames):
    number, labels = point["index"], point["labels"]
    name = digest("grid", number)
    run_folder = folder / "runs" / name[:2] / name
    run_folder.mkdir(parents=True)
    (folder / "references").mkdir(exist_ok=True)
    base = 0.05 if labels["technique"] == "iso_raymarch" else 0.09
    ms = base * float(labels["size"]) / float(labels["step"]) ** 0.7
    rows = []
    for kind, orbits in (("headline", ORBITS), ("breakdown", 1)):
        for orbit, frame in product(range(orbits), range(frames)):
            time = ms * (1 + 0.2 * math.sin(6.28 * frame / frames) + 0.001 * ((7 * frame + 3 * orbit + number) % 11))
            row = dict(orbit_kind=kind, orbit=orbit, frame=frame, phase=frame / frames, host_ms=time, interval_ms=time,
                       cpu_ms=time, update_ms=0, draw_ms=time, frame_ms=time, gpu_ms=time, disturbed="")
            rows.append(row | {"pass.march": time if kind == "breakdown" else ""})
    write_csv(run_folder / "frames.csv", "frames", rows)
    os.link(template_folder / "counters.csv", run_folder / "counters.csv")
    pictures = []
    for picture in template["pictures"]:
        reference = f"references/{digest(point['group'], labels['technique'], picture['frame'])}.exr"
        os.link(small / picture["reference_file"], folder / reference)
        os.link(template_folder / picture["file"], run_folder / picture["file"])
        psnr = 60 - 12 * float(labels["step"]) - number % 7
        pictures.append(picture | {"reference_file": reference, "psnr_db": psnr, "mse": 10 ** (-psnr / 10)})
    (run_folder / "run.json").write_text(json.dumps(template | {
        "run": name, "point": digest("point", number), "point_index": number, "group": point["group"], "labels": labels,
        "pictures": pictures, "statistics": template["statistics"] | {"frames": ORBITS * frames, "poses": frames}}))


if __name__ == "__main__":  # python3 synthetic.py FOLDER [RUNS]: to measure a report of a large experiment
    print(write_grid(Path(sys.argv[1]), *map(int, sys.argv[2:])))
