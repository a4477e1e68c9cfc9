import json
import shutil

import pytest
import synthetic
from volmark_analysis.__main__ import main
from volmark_analysis.load import load_experiment, read_csv
from volmark_analysis.points import point_results
from volmark_analysis.report import render


def run_files(folder, status="completed"):
    return [p for p in sorted(folder.glob("runs/*/[!.]*/run.json")) if json.loads(p.read_text())["status"] == status]


def edit(path, change):
    document = json.loads(path.read_text())
    change(document)
    path.write_text(json.dumps(document))


def refused(capsys, folder, *texts):
    """Exit code 2 and one line on stderr with all texts; nothing on stdout."""
    assert main(["table", str(folder)]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1 and err.startswith("volmark_analysis: ")
    for text in texts:
        assert text in err, err


def test_everything_is_there(experiment_folder):
    experiment = load_experiment(experiment_folder)
    assert experiment.name == "synthetic" and experiment.axes == ["technique", "scene", "step"]
    assert len(experiment.points) == 10 and len(experiment.runs) == 5 * 5 + 5
    assert len(experiment.unfinished) == 1
    results = point_results(experiment)
    assert [r.point_index for r in results] == list(range(10))
    assert [r.status for r in results] == ["completed"] * 7 + ["failed", "completed", "unsupported"]
    assert "VK_ERROR_DEVICE_LOST" in results[7].reason
    assert results[0].statistics["count"] == 5 * 3 * 24 and results[0].poses == 24
    assert results[4].history == "visible"
    assert results[6].failed_checks[0]["name"] == "memory_equals_ledger"


def test_points_without_a_run_are_kept(fresh_folder):
    for path in run_files(fresh_folder):
        if json.loads(path.read_text())["point_index"] == 3:
            shutil.rmtree(path.parent)
    result = point_results(load_experiment(fresh_folder))[3]
    assert result.status == "not_run" and result.technique == "dvr_raymarch"


def test_a_failed_replicate_stays_with_its_point(fresh_folder):
    path = next(p for p in run_files(fresh_folder) if json.loads(p.read_text())["point_index"] == 0)
    edit(path, lambda d: d.update(status="crashed", reason="signal 11", provenance={}))
    result = point_results(load_experiment(fresh_folder))[0]
    assert len(result.completed) == 4 and [r.status for r in result.others] == ["crashed"]
    assert result.interval is None and result.spread is not None


def test_two_devices_get_a_label(fresh_folder):
    for path in run_files(fresh_folder):
        if json.loads(path.read_text())["replicate"] == 0:
            edit(path, lambda d: d["provenance"]["device"].update(name="another"))
    results = point_results(load_experiment(fresh_folder))
    assert {r.labels.get("device") for r in results if r.completed} == {"another", "llvmpipe (LLVM 15, 256 bits)"}


def test_runs_of_points_that_left_the_scenario_are_left_out(fresh_folder):
    path = run_files(fresh_folder)[0]
    edit(path, lambda d: d.update(point_index=None))
    experiment = load_experiment(fresh_folder)
    assert len(experiment.current_runs) == len(experiment.runs) - 1


def test_missing_folder(tmp_path, capsys):
    refused(capsys, tmp_path / "nowhere", "nowhere", "no such folder")


def test_folder_above_is_explained(fresh_folder, capsys):
    refused(capsys, fresh_folder.parent, "no experiment.json", "experiments inside: synthetic")


def test_empty_experiment(fresh_folder, capsys):
    shutil.rmtree(fresh_folder / "runs")
    refused(capsys, fresh_folder, "no finished run")


@pytest.mark.parametrize("name", ["experiment.json", "run.json"])
@pytest.mark.parametrize("change, texts", [
    (lambda d: d.update(version=2), ["/version: found 2, allowed: 1"]),
    (lambda d: d.update(format="other"), ['/format: found "other"', "allowed: \"volmark."]),
    (lambda d: d.pop("format"), ["/format: found null"]),
])
def test_foreign_formats(fresh_folder, capsys, name, change, texts):
    path = fresh_folder / name if name == "experiment.json" else run_files(fresh_folder)[0]
    edit(path, change)
    refused(capsys, fresh_folder, str(path), *texts)


@pytest.mark.parametrize("change, text", [
    (lambda d: d.update(status="done"), "/status: found 'done', allowed: completed, failed"),
    (lambda d: d.pop("labels"), "/labels: missing, expected an object"),
    (lambda d: d.update(replicate="0"), '/replicate: found "0", expected an integer'),
    (lambda d: d.update(replicate=True), "/replicate: found true, expected an integer"),
    (lambda d: d["statistics"]["frame"].pop("fps"), "/statistics/frame/fps: missing, expected a number"),
    (lambda d: d["statistics"].update(frame=None), "/statistics/frame/mean_ms: missing"),
    (lambda d: d["pictures"][1].pop("file"), "/pictures/1/file: missing"),
])
def test_malformed_runs(fresh_folder, capsys, change, text):
    path = run_files(fresh_folder)[0]
    edit(path, change)
    refused(capsys, fresh_folder, str(path), text)


@pytest.mark.parametrize("content", ["", "{", "[]", "\x00", '{"format": "volmark.run"'])
def test_a_damaged_run_json_costs_its_own_run_alone(fresh_folder, content):
    before = load_experiment(fresh_folder)
    path = run_files(fresh_folder)[0]
    path.write_text(content)
    left_out_and_named(fresh_folder, before, path)


@pytest.mark.parametrize("cut", [
    lambda content: content[:-3],
    lambda content: content[:len(content) // 3],
    lambda content: content[:content.rindex(b"\nheadline,") + 1],
    lambda content: b""])
def test_a_cut_off_table_costs_its_own_run_alone(fresh_folder, cut):
    before = load_experiment(fresh_folder)
    path = next(run.folder for run in before.runs if run.completed) / "frames.csv"
    path.write_bytes(cut(path.read_bytes()))
    left_out_and_named(fresh_folder, before, path)


def test_a_missing_table_costs_its_own_run_alone(fresh_folder):
    before = load_experiment(fresh_folder)
    path = next(run.folder for run in before.runs if run.completed) / "frames.csv"
    path.unlink()
    left_out_and_named(fresh_folder, before, path)


def left_out_and_named(folder, before, path):
    after = load_experiment(folder)
    assert len(after.runs) == len(before.runs) - 1 and len(after.damaged) == 1
    assert path.parent not in [run.folder for run in after.runs]
    assert str(path) in after.damaged[0]
    page = render(after, point_results(after), [])
    assert "damaged files" in page and path.parent.name in page


def test_nothing_but_damaged_runs_is_one_line(fresh_folder, capsys):
    for path in fresh_folder.glob("runs/*/*/run.json"):
        path.write_text("{")
    refused(capsys, fresh_folder, "run.json: not JSON")


@pytest.mark.parametrize("change, text", [
    (lambda t: t.replace("# volmark.frames 1", "# volmark.frames 2"), "allowed: '# volmark.frames 1'"),
    (lambda t: t.replace("frame_ms,", "frame,"), "no column 'frame_ms'"),
    (lambda t: t.replace("headline,0,0,0.0,", "headline,0,0,zero,"), "column phase: found 'zero', expected a number"),
    (lambda t: t.replace("warm_up,", "warm,"), "column orbit_kind: found 'warm', allowed: warm_up, headline"),
    (lambda t: t + "1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16,17\n", "not a table"),
])
def test_malformed_frames(fresh_folder, capsys, change, text):
    # The run that is read first, so that the others need not be.
    path = load_experiment(fresh_folder).runs[0].folder / "frames.csv"
    path.write_text(change(path.read_text()))
    refused(capsys, fresh_folder, str(path), text)


def test_absent_optional_parts_are_fine(fresh_folder):
    for path in run_files(fresh_folder):
        def strip(d):
            for key in ("generation", "counters", "memory", "checks", "provenance", "prepare_ms", "first_frame_ms"):
                d.pop(key)
            d["pictures"] = []
            d["technique"] = {"name": d["technique"]["name"]}
            d["config"] = {"scene": d["config"]["scene"]}
            d["statistics"] = {"frame": d["statistics"]["frame"]}
        edit(path, strip)
        (path.parent / "counters.csv").unlink()
        rows = path.parent / "frames.csv"
        lines = rows.read_text().splitlines()
        rows.write_text("\n".join(",".join(line.split(",")[:12]) if i else line for i, line in enumerate(lines)) + "\n")
    experiment = load_experiment(fresh_folder)
    assert "not measured" in render(experiment, point_results(experiment), [])


def test_all_failed(tmp_path, capsys):
    folder = synthetic.write_experiment(tmp_path / "failed", all_failed=True)
    assert main(["report", str(folder)]) == 0
    text = (folder / "report.html").read_text()
    assert "No run completed" in text and text.count("VK_ERROR_DEVICE_LOST") >= 10
    assert main(["table", str(folder)]) == 0
    assert main(["table", str(folder), "--format", "tex"]) == 0
    capsys.readouterr()
    assert main(["plots", str(folder)]) == 2
    assert "nothing to plot" in capsys.readouterr().err


@pytest.mark.parametrize("change", [
    lambda line: '"' + line.replace(",", '","') + '"\n',
    lambda line: line + "\r\n"])
def test_tables_read_alike_however_they_are_written(experiment_folder, tmp_path, change):
    path = next(experiment_folder.glob("runs/*/[!.]*/frames.csv"))
    head, *lines = path.read_text().splitlines()
    (tmp_path / "frames.csv").write_bytes((head + "\n" + "".join(map(change, lines))).encode())
    plain, changed = (read_csv(p, "frames", [], text=("orbit_kind", "disturbed")) for p in (path, tmp_path / "frames.csv"))
    assert list(plain) == list(changed) and len(plain["frame"]) > 24
    for name, values in plain.items():
        assert [str(v) for v in values] == [str(v) for v in changed[name]]
