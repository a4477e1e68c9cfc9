import json
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from gate_folders import make_side, write_gate
from hostile import HOSTILE
from volmark_analysis.__main__ import main
from volmark_analysis.gate import history
from volmark_analysis.gate.evidence import read_evidence
from volmark_analysis.gate.rules import Rules
from volmark_analysis.gate.verdicts import judge


def write_history(path, instructions, cpu_ms, device="llvmpipe", name="point"):
    lines = [{"format": history.FORMAT, "version": 1, "created": "2025-01-01T00:00:00Z", "outcome": "same", "device": device,
              "base": {"name": "main", "commit": ""}, "candidate": {"name": f"build {i}", "commit": f"{i:040x}"[::-1]},
              "points": [{"scenario": "ci", "point": name, "outcome": "same", "instructions": n, "mse": 1e-4, "cpu_ms": t, "wall_ms": t,
                          "ratios": {}}]} for i, (n, t) in enumerate(zip(instructions, cpu_ms))]
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return path


def test_verdicts_come_back_as_they_were(tmp_path):
    folder = write_gate(tmp_path / "gate", {("ci", "dvr"): (make_side(), make_side(instructions=11e6))}, pairs=3)
    evidence = read_evidence(folder)
    verdict = judge(evidence, Rules())
    for _ in range(2):
        history.append(tmp_path / "new" / "history.jsonl", history.line_of(verdict, evidence.base, evidence.candidate, "now"))
    entries = history.read_history(tmp_path / "new" / "history.jsonl")
    assert len(entries) == 2 and entries[0] == entries[1]
    point = entries[0]["points"][0]
    assert (point["instructions"], point["outcome"], point["mse"]) == (11e6, "regressed", 1e-4)
    assert point["cpu_ms"] == pytest.approx(18, rel=0.5) and len(point["ratios"]["cpu"]) == 3
    assert entries[0]["candidate"]["commit"] == "c" * 40


def test_changes_are_found_in_both_quantities(tmp_path):
    rng = np.random.default_rng(2)
    cpu = np.concatenate([rng.normal(10, 0.1, 12), rng.normal(11, 0.1, 12)])
    instructions = np.where(np.arange(24) < 7, 1e8, 1.002e8) + rng.normal(0, 200, 24)
    path = write_history(tmp_path / "history.jsonl", instructions, cpu)
    found = {s.quantity: s.changes for s in history.series_of(history.read_history(path), 5e-4)}
    assert found == {"instructions": [7], "cpu_ms": [12]}


def test_plots_and_changes_are_written(tmp_path, capsys):
    path = write_history(tmp_path / "history.jsonl", [1e8] * 6 + [1.2e8] * 6, [10.0] * 12)
    assert main(["gate", "history", str(path), "-o", str(tmp_path / "plots")]) == 0
    printed = capsys.readouterr().out
    assert "instructions +20.00 %" in printed and "6000000" in printed  # the commit's beginning
    assert ElementTree.parse(tmp_path / "plots" / "history.svg").getroot().tag.endswith("svg")
    assert (tmp_path / "plots" / "history.png").read_bytes().startswith(b"\x89PNG")


def test_equal_histories_give_equal_bytes(tmp_path):
    path = write_history(tmp_path / "history.jsonl", [1e8] * 3, [10.0] * 3)
    entries = history.read_history(path)
    first = [p.read_bytes() for p in history.write_plot(tmp_path, entries, 5e-4)]
    assert [p.read_bytes() for p in history.write_plot(tmp_path, entries, 5e-4)] == first


def test_times_stand_beside_the_error_of_their_pictures(tmp_path, monkeypatch):
    titles = []
    monkeypatch.setattr("matplotlib.axes.Axes.set_title", lambda self, text, **more: titles.append(text))
    entries = history.read_history(write_history(tmp_path / "history.jsonl", [1e8] * 3, [10.0] * 3))
    entries[2]["points"][0]["mse"] = 1e-3
    history.write_plot(tmp_path, entries, 5e-4)
    assert [t.endswith("pictures 30.0 dB to 40.0 dB") for t in titles] == [True, True]
    for entry in entries:
        del entry["points"][0]["mse"]
    history.write_plot(tmp_path, entries, 5e-4)
    assert titles[-1].endswith("error not measured")


def test_devices_are_not_mixed(tmp_path, monkeypatch):
    entries = history.read_history(write_history(tmp_path / "a", [1e8] * 4, [10.0] * 4))
    entries += history.read_history(write_history(tmp_path / "b", [5e8] * 2, [1.0] * 2, device="another"))
    drawn = []
    monkeypatch.setattr(history, "_draw", lambda ax, series, *more: drawn.append(list(series.values)))
    history.write_plot(tmp_path, entries, 5e-4)
    assert drawn == [[5e8] * 2, [1.0] * 2]


def test_hostile_names_are_text(tmp_path, capsys):
    path = write_history(tmp_path / "history.jsonl", [1e8] * 3, [10.0] * 3, device="".join(HOSTILE), name="".join(HOSTILE))
    assert main(["gate", "history", str(path)]) == 0
    assert b"<script" not in (tmp_path / "history.svg").read_bytes()


def test_a_line_that_was_cut_is_left_out(tmp_path):
    path = write_history(tmp_path / "history.jsonl", [1e8] * 3, [10.0] * 3)
    path.write_text(path.read_text()[:-30])
    assert len(history.read_history(path)) == 2


@pytest.mark.parametrize("text, words", [
    ("", "empty"), ("{}\n", "line 1"), ("[]\n", "line 1"), ("nonsense\n", "line 1"),
    ('{"format": "volmark.gate_history", "version": 9, "points": []}\n', "version 1"),
    ('{"format": "volmark.gate_history", "version": 1, "points": [1]}\n', "list of points"),
    ('{"format": "volmark.gate_history", "version": 1, "points": []}\n', "no verdict has")])
def test_other_files_are_one_line(tmp_path, text, words, capsys):
    path = tmp_path / "history.jsonl"
    path.write_text(text)
    assert main(["gate", "history", str(path)]) == 2
    error = capsys.readouterr().err
    assert words in error and error.count("\n") == 1
    assert main(["gate", "history", str(tmp_path / "missing")]) == 2
