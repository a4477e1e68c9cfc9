"""Stands for the program in tests of the gate: expands, runs and draws what files beside it say, without a GPU."""

import json
import os
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))


def side_of(program, technique):
    """What a build does is in a file beside its program: `only` of one technique, or of all."""
    import gate_folders
    changes = json.loads(Path(program).with_name("side.json").read_text())
    return gate_folders.make_side(**changes if changes.pop("only", technique) == technique else {})


def run(arguments, config):
    import gate_folders
    values = lambda option: [b for a, b in zip(arguments, arguments[1:]) if a == option]  # noqa: E731
    settings = dict(s.split("=") for s in values("--set"))
    programs = dict(b.split("=", 1) for b in values("--build"))
    chosen = [int(p) for p in values("--points")[0].split(",")] if values("--points") else range(len(config["points"]))
    points = {t: [side_of(programs[name], t) if name in programs else None for name in ("base", "candidate")]
              for t in (config["points"][i] for i in chosen)}
    folder = Path(values("--results")[0]) / config["name"]
    pairs, seed = int(settings["measure.replicates"]), int(settings["measure.seed"])
    gate_folders.write_experiment(folder, config["name"], points, pairs, seed)
    with open(Path(values("--results")[0]).parent / "calls", "a") as file:
        file.write(f"{folder.parent.name} {pairs} {','.join(map(str, chosen))} {seed}\n")
    return max(side is not None and side["status"] != "completed" for sides in points.values() for side in sides)


def main(program, arguments):
    if arguments[0] == "device":
        print("0: llvmpipe, driver", os.environ.get("FAKE_DRIVER", "1"))
        return 0
    config = json.loads(Path(arguments[1]).read_text())
    if arguments[0] == "expand":
        for index, technique in enumerate(config["points"]):
            frames = 2 if "--profile" in arguments else 4
            print(json.dumps({"index": index, "labels": {"technique": technique}, "config": {"pacing": {"frames": frames}}}))
        print(f"{len(config['points'])} points", file=sys.stderr)
        return 0
    if "exit" in config:
        print(f"volmark: {config['exit'][1]}", file=sys.stderr)
        return config["exit"][0]
    if arguments[0] == "run":
        return run(arguments, config)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
