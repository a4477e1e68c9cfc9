"""Results of points with chosen times and errors, without files."""

from pathlib import Path

import numpy as np
from volmark_analysis.load import Run
from volmark_analysis.points import PointResult


def made_run(processes_orbits, pictures, draws, device, started, replicate):
    rows = [(orbit, frame, time) for orbit, times in enumerate(processes_orbits) for frame, time in enumerate(times)]
    orbits, frames, times = (np.array(column, float) for column in zip(*rows))
    run = Run(folder=Path("/nowhere"), run=f"{replicate}", point="", replicate=replicate, point_index=0, group="", labels={},
              status="completed", reason="", config={"scene": "s"}, technique={"name": "t", "draws": draws}, statistics={},
              generation=[], counters={}, memory={}, pictures=pictures, checks=[],
              provenance={"device": {"identity": device, "name": device}, "started": started})
    run.__dict__["columns"] = {
        "orbit_kind": np.array(["headline"] * len(rows), object), "orbit": orbits, "frame": frames, "phase": frames / 1000,
        "frame_ms": times, "host_ms": times + 1, "cpu_ms": 2 * times, "gpu_ms": np.full(len(rows), np.nan),
        "disturbed": np.array([""] * len(rows), object)}
    return run


def made_point(index, processes, psnr=(40.0,), *, labels=None, draws="volume", device="gpu", started="2024", replicas=None):
    """`processes`: per process, per orbit, its frame times. `psnr`: of each captured picture, inf where identical;
    `replicas`: the same of each process, where they differ."""
    def pictures(values):
        return [{"frame": i, "view": 0, "file": "x.exr", "mse": 0.0 if v == np.inf else 10 ** (-v / 10), "flip": 1 / (1 + v),
                 "psnr_db": None if v == np.inf else v, "identical": v == np.inf} for i, v in enumerate(values)]

    labels = {"technique": "t", "step": str(index), **(labels or {})}
    runs = [made_run(orbits, pictures(replicas[i] if replicas else psnr), draws, device, started, i)
            for i, orbits in enumerate(processes)]
    return PointResult(labels, index, "", runs)


def noisy(rng, ms, processes=3, orbits=2, frames=6, between=0.03, within=0.01):
    return [[ms * np.exp(rng.normal(0, within, frames) + level) for _ in range(orbits)]
            for level in rng.normal(0, between, processes)]
