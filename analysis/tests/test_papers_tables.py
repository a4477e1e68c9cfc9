"""Table 1, figures and chosen parameters of the bitfield-octree paper from made-up experiments."""

import csv
import io
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from paper_experiments import Made, write_made
from volmark_analysis.__main__ import main
from volmark_analysis.papers.bitfield_octree_2021 import published
from volmark_analysis.papers.bitfield_octree_2021.chosen import compact_json

SOURCE = Path(__file__).parents[2]
SCENARIOS = SOURCE / "configs" / "papers" / "bitfield_octree_2021"
TABLE_AXES = ("dataset", "configuration", "method")


def small_table(folder):
    def cell(d, c, m, ms, **more):
        return Made({"dataset": d, "configuration": c, "method": m}, ms, m, **{"processes": 1, "orbits": 1, "node_tests": 0} | more)

    return write_made(folder, "table1", TABLE_AXES, [
        cell("lungs", "early exit", "none", 30.0, samples=4000.0),
        cell("lungs", "early exit", "bitfield octree", 10.0, samples=900.0, node_tests=100.0, generation_ms=7.5,
             parameters={"leaf": 2, "bits": 32, "initial_level": 4}),
        cell("lungs", "early exit", "min-max octree", 20.0, status="out_of_memory"),
        cell("lungs", "generation", "distance map", 99.0, rebuilt_ms=40.0),
        cell("Manix", "marching only", "none", 8.0, processes=5, orbits=2, noise=0.01),
        cell("Manix", "marching only", "distance map", 2.0, processes=5, orbits=2, noise=0.01)])


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    root = tmp_path_factory.mktemp("paper")
    assert main(["paper", "bitfield_octree_2021", "--table1", str(small_table(root / "table1")), "--output", str(root / "out")]) == 0
    return root / "out"


def markdown_row(text, start):
    (line,) = [line for line in text.splitlines() if line.startswith(start)]
    return [cell.strip() for cell in line.strip("|").split("|")]


def test_cells_hold_measured_error_and_published(written):
    times = (written / "table1.md").read_text().split("**Table 1 as ratios")[0]
    row = markdown_row(times, "| lungs (chest_ct) | + Early Exit")
    assert row[2] == "30.0, 40.0 dB; paper 7.83" and row[6] == "10.0, 40.0 dB; paper 4.75"
    assert row[3] == "not measured; paper 2.76" and row[5] == "out of memory: needs more memory; paper 10.16"
    assert row[7] == "not measured; paper 4.75"
    assert "[" in markdown_row(times, "| Manix (cranium_ct) | Marching Only")[2]  # five processes: an interval
    assert set(c.split(";")[0] for c in markdown_row(times, "| beetle (stag_beetle) | Marching Only")[2:]) == {"not measured"}


def test_generation_and_parameters(written):
    text = (written / "table1.md").read_text()
    row = markdown_row(text, "| lungs (chest_ct) | Generation")
    assert row[2] == "" and row[3].startswith("40.1 (40.0–40.2); paper 59.2") and row[6] == "7.50; paper 7.0"
    assert row[4] == "not measured; paper 7.7"
    row = markdown_row(text, "| lungs (chest_ct) | Parameters")
    assert row[6] == "leaf 2³, 32 bits, level 4; paper leaf 2³, 32 bits, level 5" and row[4] == "not measured; paper leaf 2³, level 5"


def test_ratios_in_time_and_in_work(written):
    ratios = (written / "table1.md").read_text().split("**Table 1 as ratios")[1]
    row = markdown_row(ratios, "| lungs (chest_ct) | + Early Exit")
    assert row[5] == f"time 3.00 (3.00–3.00), work 4.00; paper {7.83 / 4.75:.2f}"
    assert row[2] == f"not measured; paper {7.83 / 2.76:.2f}"


def test_every_caption_names_the_stand_ins(written):
    for name in ("table1.md", "table1.tex", "claims.md"):
        text = (written / name).read_text().replace(r"\_", "_")
        captions = [line for line in text.splitlines() if line.startswith("**") or r"\caption" in line]
        assert len(captions) >= 3
        for caption in captions:
            assert all(f"{volume}" in caption for volume in published.STAND_INS.values()), caption


def test_csv_has_every_cell_with_all_digits(written):
    rows = list(csv.DictReader(io.StringIO((written / "table1.csv").read_text())))
    assert len(rows) == 6 * 4 * 6
    by_cell = {(r["dataset"], r["configuration"], r["method"]): r for r in rows}
    row = by_cell["lungs", "early exit", "bitfield octree"]
    assert (float(row["mean_ms"]), float(row["published_ms"]), float(row["none_over_method_work"])) == (10.0, 4.75, 4.0)
    assert (row["leaf"], row["published_leaf"], row["published_initial_level"]) == ("2", "2", "5")
    assert by_cell["lungs", "lighting", "none"]["status"] == "not measured" and by_cell["lungs", "lighting", "none"]["published_ms"] == "14.38"
    assert by_cell["beetle", "shading", "none"]["status"] == "not measured" and by_cell["beetle", "shading", "none"]["mean_ms"] == ""


def test_tex_is_balanced(written):
    text = (written / "table1.tex").read_text()
    assert text.count(r"\begin{") == text.count(r"\end{") == 6
    for table in text.split(r"\begin{tabular}")[1:]:
        body = table.split(r"\end{tabular}")[0].splitlines()
        assert len({line.replace(r"\&", "").count("&") for line in body if line.endswith(r"\\")}) == 1


def test_without_anything_all_is_not_measured(tmp_path):
    assert main(["paper", "bitfield_octree_2021", "--output", str(tmp_path / "out")]) == 0
    claims = (tmp_path / "out" / "claims.md").read_text()
    assert "| held |" not in claims and claims.count("not measured") > 20
    assert (tmp_path / "out" / "figures.md").read_text().count("not measured") >= 5
    assert not list((tmp_path / "out").glob("*.svg"))


@pytest.mark.parametrize("arguments, text", [
    ([], "--output: missing"), (["--choose", "x.json"], "--choose: needs --search"),
    (["--table1", "nowhere", "-o", "out"], "no such folder")])
def test_refusals_are_one_line(capsys, arguments, text):
    assert main(["paper", "bitfield_octree_2021", *arguments]) == 2
    error = capsys.readouterr().err
    assert text in error and error.count("\n") == 1


def test_another_experiment_is_refused(tmp_path, capsys):
    folder = write_made(tmp_path / "x", "x", ("step",), [Made({"step": "1"}, processes=1)])
    assert main(["paper", "bitfield_octree_2021", "--fig6", str(folder), "-o", str(tmp_path / "out")]) == 2
    assert "no label 'dataset'" in capsys.readouterr().err


# Figures ------------------------------------------------------------------------------------------------------


def test_figures_are_drawn_of_what_there_is(tmp_path):
    few = {"processes": 1, "orbits": 2}
    fig4 = write_made(tmp_path / "4", "fig4", ("dataset", "leaf", "bits", "initial_level"), [
        Made({"dataset": d, "leaf": leaf, "bits": "32", "initial_level": level}, 3.0, **few)
        for d in ("aneurysm", "Manix") for leaf in ("2", "4") for level in ("0", "1") if (d, leaf) != ("Manix", "4")])
    steps = np.arange(48.0).reshape(6, 8) * 20
    fig5 = write_made(tmp_path / "5", "fig5", ("leaf", "bits"), [
        Made({"leaf": leaf, "bits": bits}, steps=steps, **few) for leaf, bits in (("4", "64"), ("32", "64"), ("4", "16"))])
    fig6 = write_made(tmp_path / "6", "fig6", ("dataset", "initial_level", "traversal"), [
        Made({"dataset": "lungs", "initial_level": str(level), "traversal": t}, **few) for level in range(3)
        for t in ("bidirectional", "top_down")])
    fig7 = write_made(tmp_path / "7", "fig7", (), [Made({}, timed=True, **few)])
    out = tmp_path / "out"
    assert main(["paper", "bitfield_octree_2021", "--fig4", str(fig4), "--fig5", str(fig5), "--fig6", str(fig6), "--fig7", str(fig7),
                 "-o", str(out)]) == 0
    for name in ("fig4", "fig4_levels", "fig5", "fig6", "fig7"):
        assert (out / f"{name}.png").stat().st_size > 5000 and b"</svg>" in (out / f"{name}.svg").read_bytes()
    captions = (out / "figures.md").read_text()
    assert "Manix is cranium_ct" in captions and "40.0 dB" in captions and "not measured" not in captions


# Chosen parameters --------------------------------------------------------------------------------------------


def test_the_best_parameters_go_into_the_scenario(tmp_path, capsys):
    axes = ("dataset", "octree", "leaf", "bits", "initial_level")
    points = [Made({"dataset": "Manix", "leaf": str(leaf), "bits": "64", "initial_level": str(level)}, 5.0 + abs(leaf - 8) + level,
                   processes=1, parameters={"leaf": leaf, "bits": 64, "initial_level": level}) for leaf in (2, 8) for level in (1, 2)]
    points += [Made({"dataset": "Manix", "octree": "x", "leaf": "16", "initial_level": "2"}, 3.0, "min-max octree", processes=1,
                    parameters={"leaf": 16, "initial_level": 2})]
    search = write_made(tmp_path / "search", "search", axes, points)
    scenario = Path(shutil.copy(SCENARIOS / "table1.json", tmp_path / "table1.json"))
    before = json.loads(scenario.read_text())
    assert main(["paper", "bitfield_octree_2021", "--search", str(search), "--choose", str(scenario), "-o", str(tmp_path / "out")]) == 0
    assert "3 cases" in capsys.readouterr().out  # both supports and the min-max octree
    after = json.loads(scenario.read_text())
    for old, new in zip(before["blocks"], after["blocks"]):
        manix = old["axes"]["dataset"]["values"][0]["label"] == "Manix"
        for was, case in zip(old["axes"]["method"]["values"], new["axes"]["method"]["values"]):
            values = {key.removeprefix("technique.parameters."): value for key, value in case["set"].items()}
            if manix and case["label"].startswith("bitfield"):
                assert (values["leaf"], values["bits"], values["initial_level"]) == (8, 64, 1)
            elif manix and case["label"] == "min-max octree":
                assert (values["leaf"], values["initial_level"]) == (16, 2)
            else:
                assert case == was
    text = (tmp_path / "out" / "table1.md").read_text()
    assert "leaf 8³, 64 bits, level 1" in text


def test_shipped_scenarios_are_written_as_the_tool_writes_them():
    text = (SCENARIOS / "table1.json").read_text()
    assert compact_json(json.loads(text)) + "\n" == text


# Scenarios ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["table1_search", "table1", "fig4", "fig5", "fig6", "fig7"])
def test_scenarios_have_the_axes_that_the_analysis_reads(name):
    from volmark_analysis.papers.bitfield_octree_2021.command import _AXES

    document = json.loads((SCENARIOS / f"{name}.json").read_text())
    axes = {axis for block in document["blocks"] for axis in block.get("axes", {})}
    assert set(_AXES["search" if name == "table1_search" else name]) <= axes
    labels = {case["label"] for block in document["blocks"] for case in block.get("axes", {}).get("dataset", {}).get("values", [])}
    assert labels <= set(published.DATASETS) and {"lavapipe", "smoke"} <= set(document["profiles"])


def test_table1_has_all_volumes_methods_and_configurations():
    blocks = json.loads((SCENARIOS / "table1.json").read_text())["blocks"]
    cells = {(d["label"], c["label"], m["label"]) for block in blocks for d in block["axes"]["dataset"]["values"]
             for c in block["axes"]["configuration"]["values"] for m in block["axes"]["method"]["values"]}
    methods = (*published.METHODS, published.BITFIELD_VOXELS)
    wanted = {(d, c, m) for d in published.DATASETS for c in published.CONFIGURATIONS for m in methods}
    wanted |= {(d, published.GENERATION, m) for d in published.DATASETS for m in ("distance map", "boolean octree")}
    assert cells == wanted
