"""Made-up experiments of papers' scenarios, to the formats of harness/README.md, section 7."""

import json
from dataclasses import dataclass, field
from typing import Callable

import numpy as np
from exr_writer import write_exr
from synthetic import digest, plain_statistics, write_csv

TECHNIQUES = {"none": "dvr_raymarch", "distance map": "dvr_distance_map", "boolean octree": "dvr_boolean_octree",
              "min-max octree": "dvr_minmax_octree", "bitfield octree": "dvr_bitfield_octree",
              "bitfield octree, voxels": "dvr_bitfield_octree",
              "direct rasterization": "mesh_shader_isosurface", "octree ray marching": "iso_octree",
              "optimized mesh": "optimized_mesh", "marching cubes": "marching_cubes"}
POSES = 6


@dataclass
class Made:
    """A point."""

    labels: dict
    ms: float = 10.0
    method: str = "bitfield octree"
    noise: float = 0.0
    """Relative, of every frame."""
    between: float = 0.0
    """The same of every process."""
    processes: int = 5
    orbits: int = 2
    samples: float = 1000.0
    node_tests: float = 100.0
    parameters: dict = field(default_factory=dict)
    generation_ms: float | None = None
    """Of the pass build_structure, once a run."""
    rebuilt_ms: float | None = None
    """The same in every breakdown frame."""
    slow: float = 1.0
    """How much longer the last pose takes."""
    status: str = "completed"
    steps: np.ndarray | None = None
    timed: bool = False
    poses: int = POSES
    update_ms: float | None = None
    """Beside `ms`, which then is the draw time alone; None: a hundredth of `ms` is its update."""
    by_phase: Callable[[float], float] = lambda phase: 1.0
    """Times `ms`."""
    config: dict = field(default_factory=dict)
    device_type: str = "discrete_gpu"


def write_made(folder, name, axes, points):
    """The folder, with all runs of `points`."""
    folder.mkdir(parents=True, exist_ok=True)
    listed = []
    for index, point in enumerate(points):
        labels = {"technique": TECHNIQUES[point.method], **point.labels}
        listed.append({"index": index, "labels": labels, "block": 0, "group": str(index)})
        for replicate in range(point.processes):
            _write_run(folder, point, listed[-1], replicate)
    (folder / "experiment.json").write_text(json.dumps({
        "format": "volmark.experiment", "version": 1, "name": name, "title": name, "description": "", "config_file": "x.json",
        "profile": "", "assignments": [], "created": "2024-05-06T07:08:09Z", "program": {}, "scenario": {},
        "axes": ["technique", *axes], "points": listed}))
    return folder


def _write_run(folder, point, listed, replicate):
    run = digest(listed["index"], replicate)
    run_folder = folder / "runs" / run[:2] / run
    run_folder.mkdir(parents=True)
    rng = np.random.default_rng(1000 * listed["index"] + replicate)
    rows = _frames(point, rng)
    done = point.status == "completed"
    document = {
        "format": "volmark.run", "version": 1, "run": run, "point": digest(listed["index"]), "replicate": replicate,
        "point_index": listed["index"], "group": listed["group"], "labels": listed["labels"], "status": point.status,
        "reason": "" if done else "needs more memory",
        "config": {"scene": "s", "technique": {"name": TECHNIQUES[point.method], "parameters": point.parameters}} | point.config,
        "technique": {"name": TECHNIQUES[point.method], "draws": "volume"}, "checks": [],
        "provenance": {"device": {"identity": "gpu", "name": "gpu", "type": point.device_type}, "started": f"2024-05-06T07:08:{replicate:02d}Z"}}
    if done:
        write_csv(run_folder / "frames.csv", "frames", rows, ["pass.build_structure"])
        times = [r["frame_ms"] for r in rows if r["orbit_kind"] == "headline"]
        statistics = {"frames": len(times), "frame": plain_statistics(times)}
        generation = [{"name": "upload", "host_ms": None, "gpu_ms": 99.0}]
        if point.generation_ms is not None:
            generation.append({"name": "build_structure", "host_ms": None, "gpu_ms": point.generation_ms * (1 + 0.001 * replicate)})
        counters = {"samples": point.samples} | ({} if point.method == "none" else {"node_tests": point.node_tests})
        pictures = [{"frame": 0, "phase": 0.0, "view": 0, "file": "frame_0000.exr", "mse": 1e-4, "psnr_db": 40.0, "identical": False}]
        document |= {"statistics": statistics, "generation": generation, "counters": counters, "pictures": pictures}
        if point.steps is not None:
            flat = np.zeros_like(point.steps, "<f2")
            write_exr(run_folder / "frame_0000.exr", {c: flat for c in "RGBA"} | {"steps": point.steps.astype("<f4")})
    (run_folder / "run.json").write_text(json.dumps(document))


def _frames(point, rng):
    rows, level = [], np.exp(rng.normal(0, point.between))
    kinds = [("headline", point.orbits)] + [("breakdown", 1)] * (point.rebuilt_ms is not None)
    for kind, orbits in kinds:
        for orbit in range(orbits):
            for frame in range(point.poses):
                phase = frame / point.poses + (0.01 * rng.random() if point.timed else 0.0)
                ms = point.ms * level * np.exp(rng.normal(0, point.noise)) * (point.slow if frame == point.poses - 1 else 1.0)
                ms *= point.by_phase(phase)
                update, draw = (0.01 * ms, 0.99 * ms) if point.update_ms is None else (point.update_ms, ms)
                ms = update + draw
                rows.append({"orbit_kind": kind, "orbit": orbit, "frame": frame, "phase": phase, "host_ms": ms, "interval_ms": ms,
                             "cpu_ms": ms, "update_ms": update, "draw_ms": draw, "frame_ms": ms, "gpu_ms": ms, "disturbed": "",
                             "pass.build_structure": point.rebuilt_ms * (1 + 0.001 * frame) if kind == "breakdown" else ""})
    return rows
