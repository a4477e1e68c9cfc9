import csv
import io
import json

import jsonschema
import pytest
from volmark_analysis.__main__ import main
from volmark_analysis.load import load_experiment
from volmark_analysis.points import point_results

# The documented shapes: github-action-benchmark's README (customSmallerIsBetter) and Bencher's bmf.json.
GITHUB = {"type": "array", "minItems": 1, "items": {
    "type": "object", "required": ["name", "unit", "value"], "additionalProperties": False,
    "properties": {"name": {"type": "string"}, "unit": {"type": "string"}, "value": {"type": "number"},
                   "range": {"type": "string"}, "extra": {"type": "string"}}}}
BENCHER = {"type": "object", "minProperties": 1, "additionalProperties": {
    "type": "object", "additionalProperties": {
        "type": "object", "required": ["value"], "additionalProperties": False,
        "properties": {name: {"type": "number"} for name in ("value", "lower_value", "upper_value")}}}}
NAME = "synthetic/technique:iso_raymarch/scene:nested_ellipsoids/step:0.5"


def exported(capsys, folder, form):
    assert main(["export", str(folder), "--format", form]) == 0
    return capsys.readouterr().out


@pytest.fixture
def first(experiment_folder):
    return point_results(load_experiment(experiment_folder))[0]


def test_github_action_benchmark(experiment_folder, capsys, first):
    entries = json.loads(exported(capsys, experiment_folder, "github-action-benchmark"))
    jsonschema.validate(entries, GITHUB)
    by_name = {entry["name"]: entry for entry in entries}
    assert len(by_name) == len(entries) == 8 * 2 + 7  # mean_ms and mse of 8 completed points; FLIP of all but one
    time = by_name[f"{NAME} mean_ms"]
    assert time["value"] == pytest.approx(first.statistics["mean_ms"]) and time["unit"] == "ms"
    assert time["range"].startswith("± ") and " dB" in time["extra"]
    assert by_name[f"{NAME} mse"]["value"] == first.errors["mse"]


def test_bencher(experiment_folder, capsys, first):
    document = json.loads(exported(capsys, experiment_folder, "bencher"))
    jsonschema.validate(document, BENCHER)
    assert len(document) == 8 and all("mse" in measures for measures in document.values())
    latency = document[NAME]["latency"]
    assert latency["value"] == pytest.approx(1e6 * first.statistics["mean_ms"])  # nanoseconds
    assert latency["lower_value"] <= latency["value"] <= latency["upper_value"]
    assert {len(name) <= 64 and name == name.lower() for m in document.values() for name in m} == {True}


def test_presentmon(experiment_folder, capsys, first):
    rows = list(csv.DictReader(io.StringIO(exported(capsys, experiment_folder, "presentmon"))))
    assert list(rows[0]) == ["Application", "TimeInSeconds", "msBetweenPresents", "msGPUActive"]
    for run in first.completed:
        mine = [r for r in rows if r["Application"] == f"{NAME} process {run.replicate}"]
        assert [float(r["msBetweenPresents"]) for r in mine] == pytest.approx(list(run.headline.interval_ms), abs=1e-6)
        times = [float(r["TimeInSeconds"]) for r in mine]
        assert times == sorted(times) and times[-1] == pytest.approx(run.headline.interval_ms.sum() / 1000)


def test_presentmon_leaves_out_what_a_frame_lacks(fresh_folder, capsys):
    for path in fresh_folder.glob("runs/*/[!.]*/frames.csv"):
        head, columns, *lines = path.read_text().splitlines()
        names = columns.split(",")
        cells = [dict(zip(names, line.split(","))) for line in lines]
        for cell in cells:
            cell["gpu_ms"] = ""  # a host technique
            if cell["frame"] == "0":
                cell["interval_ms"] = ""  # the first of an orbit
        path.write_text("\n".join([head, columns] + [",".join(cell.values()) for cell in cells]) + "\n")
    runs = [r for r in load_experiment(fresh_folder).runs if r.completed]
    rows = list(csv.DictReader(io.StringIO(exported(capsys, fresh_folder, "presentmon"))))
    assert list(rows[0]) == ["Application", "TimeInSeconds", "msBetweenPresents"]
    assert len(rows) == sum((r.headline.frame > 0).sum() for r in runs)


def test_only_the_last_build_of_a_point_is_exported(fresh_folder, capsys):
    before = json.loads(exported(capsys, fresh_folder, "bencher"))
    for path in list(fresh_folder.glob("runs/*/[!.]*/run.json")):
        document = json.loads(path.read_text())
        if document["labels"].get("technique") == "iso_raymarch" and document["status"] == "completed":
            newer = path.parent.with_name(path.parent.name[::-1])
            newer.mkdir()
            for file in path.parent.iterdir():
                (newer / file.name).write_bytes(file.read_bytes())
            document["run"] = newer.name
            document["provenance"]["program"]["digest"] = "c" * 32
            document["provenance"]["started"] = "2025-01-01T00:00:00Z"
            document["memory"]["total_bytes"] = 5
            (newer / "run.json").write_text(json.dumps(document))
    after = json.loads(exported(capsys, fresh_folder, "bencher"))
    assert after.keys() == before.keys()
    assert after[NAME]["memory-bytes"]["value"] == 5 != before[NAME]["memory-bytes"]["value"]


def test_output_file_is_whole_or_absent(experiment_folder, tmp_path, capsys):
    target = tmp_path / "bench.json"
    assert main(["export", str(experiment_folder), "--format", "bencher", "-o", str(target)]) == 0
    assert json.loads(target.read_text()) and [p.name for p in tmp_path.iterdir()] == ["bench.json"]
    assert main(["export", str(experiment_folder), "--format", "bencher", "-o", str(tmp_path / "no" / "b.json")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_nothing_to_export(tmp_path, capsys):
    import synthetic
    folder = synthetic.write_experiment(tmp_path / "failed", all_failed=True)
    assert main(["export", str(folder), "--format", "presentmon"]) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and "nothing to export" in captured.err and captured.err.count("\n") == 1
