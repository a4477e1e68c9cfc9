#!/usr/bin/python3
"""Behaves like the volmark program towards grids: expand, run --points, status and index, with claims and atomic results.
A "run" sleeps. Everything a run does is also logged, line by line, for tests to look at.

The scenario is {"name", "scenes": [...], "techniques": [...], "steps": [...], "seconds": ..., "replicates": ...,
"fail": {"<point>": exit code, ...}}; "fail" makes `run` end with that exit code, after as many times as "failures" says."""

import hashlib
import json
import os
import sys
import time
from pathlib import Path


def main(command, *arguments):
    if command in ("status", "index"):
        return (status if command == "status" else index)(Path(arguments[0]))
    scenario = json.loads(Path(arguments[0]).read_text())
    rest = [a for a in arguments[1:] if a != "--no-index"]
    options = list(zip(rest[::2], rest[1::2]))
    for name, value in options:
        if name == "--set":
            key, text = value.split("=", 1)
            if key.split(".")[-1] not in scenario:
                print(f"{arguments[0]}: no setting {key}", file=sys.stderr)
                return 2
            scenario[key.split(".")[-1]] = json.loads(text)
    if command == "expand":
        for point in points_of(scenario):
            print(json.dumps(point))
        return 0
    options = dict(options)
    return run(scenario, numbers_of(options["--points"]), Path(options["--results"]))


def points_of(scenario):
    points = []
    for scene in scenario["scenes"]:
        for step in scenario["steps"]:
            for technique in scenario["techniques"]:
                labels = {"technique": technique, "scene": scene, "step": str(step)}
                points.append({"index": len(points), "labels": labels, "group": f"{scene},{step}",
                               "config": {"scene": scene, "technique": {"name": technique, "parameters": {"step": step}},
                                          "measure": {"interleave": scenario.get("interleave", 4)}}})
    return points


def numbers_of(text):
    numbers = set()
    for part in text.split(","):
        first, _, last = part.partition("-")
        numbers |= set(range(int(first), int(last or first) + 1))
    return numbers


def run(scenario, chosen, results):
    folder = results / scenario["name"]
    (folder / "runs").mkdir(parents=True, exist_ok=True)
    write(folder / "experiment.json", {"points": points_of(scenario), "replicates": scenario.get("replicates", 1)})
    code = fail(scenario, chosen, folder)
    if code:
        return code
    for replicate in range(scenario.get("replicates", 1)):
        for point in points_of(scenario):
            if point["index"] in chosen:
                measure(scenario, point, replicate, folder)
    return 0


def fail(scenario, chosen, folder):
    for point, code in scenario.get("fail", {}).items():
        if int(point) in chosen:
            log(folder, "failed", point)
            times = (folder / "log").read_text().splitlines().count(f"failed {point}")
            if times <= scenario["failures"]:
                print(f"point {point}: made to fail", file=sys.stderr)
                return code
    return 0


def measure(scenario, point, replicate, folder):
    name = hashlib.md5(f"{point['labels']} {replicate}".encode()).hexdigest()
    final, claim = folder / "runs" / name / "run.json", folder / "runs" / f"{name}.claim"
    if final.exists() or not take(claim):
        return
    if final.exists():
        claim.unlink()
        return
    # Interval, number of the run, the group of processes of the worker that started it.
    begin = time.time()
    log(folder, "begin", point["index"], replicate, os.getpgid(0), begin)
    time.sleep(scenario["seconds"])
    staged = folder / "runs" / f".{name}.{os.getpid()}"
    staged.mkdir()
    write(staged / "run.json", {"point_index": point["index"], "replicate": replicate, "labels": point["labels"]})
    if final.exists():
        log(folder, "twice", point["index"], replicate)
    os.rename(staged, final.parent)
    log(folder, "end", point["index"], replicate, os.getpgid(0), begin, time.time())
    claim.unlink()


def take(claim):
    try:
        file = os.open(claim, os.O_CREAT | os.O_EXCL | os.O_WRONLY)
    except FileExistsError:
        pid = claim.read_text() if claim.exists() else ""
        if pid and not Path(f"/proc/{pid}").exists():
            write(claim, int(pid) and os.getpid())
            return True
        return False
    os.write(file, str(os.getpid()).encode())
    os.close(file)
    return True


def log(folder, *words):
    with open(folder / "log", "a") as file:
        file.write(" ".join(map(str, words)) + "\n")


def write(path, document):
    staged = path.with_name(f".{path.name}.{os.getpid()}")
    staged.write_text(json.dumps(document))
    os.replace(staged, path)


def status(folder):
    experiment = json.loads((folder / "experiment.json").read_text())
    done = [json.loads(p.read_text()) for p in (folder / "runs").glob("[!.]*/run.json")]
    seen = {(run["point_index"], run["replicate"]) for run in done}
    wanted = [(p["index"], i) for p in experiment["points"] for i in range(experiment["replicates"])]
    left = [key for key in wanted if key not in seen]
    print(json.dumps({"format": "volmark.status", "version": 1, "planned": len(wanted), "completed": len(done), "running": 0,
                      "failed": 0, "unsupported": 0, "left": len(left), "seconds_left": None,
                      "left_points": sorted({index for index, _ in left})}))
    return 0


def index(folder):
    log(folder, "index")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
