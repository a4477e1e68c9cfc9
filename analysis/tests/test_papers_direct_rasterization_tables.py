"""Tables, figures and scenarios of the paper on direct isosurface rasterization, from made-up experiments."""

import csv
import io
import json
from pathlib import Path

import pytest
from direct_rasterization_experiments import FULL, SIZES, SOFTWARE, as_published, by_size, everything, figure1, figure7b, figure8
from paper_experiments import Made, write_made
from volmark_analysis.__main__ import main
from volmark_analysis.papers.bitfield_octree_2021.chosen import compact_json
from volmark_analysis.papers.direct_rasterization import published
from volmark_analysis.papers.direct_rasterization.published import CUBES, MARCHING, MESH, OURS
from volmark_analysis.papers.direct_rasterization.sources import AXES, load_sources
from volmark_analysis.papers.direct_rasterization.tables import crossing_text

SCENARIOS = Path(__file__).parents[2] / "configs" / "papers" / "direct_rasterization"
FILES = {"tables.md", "tables.tex", "measured.csv", "claims.md", "claims.csv", "figures.md"}
FIGURES = ("fig6", "fig7a", "fig7b", "fig8")


def run(output, *folders):
    assert main(["paper", "direct_rasterization", *map(str, folders), "--output", str(output)]) == 0
    return output


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    root = tmp_path_factory.mktemp("paper")
    return run(root / "out", *everything(root))


def table(folder, start):
    text = (folder / "tables.md").read_text()
    (found,) = [part for part in text.split("\n**") if part.lstrip("*").startswith(start)]
    return found


def markdown_row(text, start):
    (line,) = [line for line in text.splitlines() if line.startswith(start)]
    return [cell.strip() for cell in line.strip("|").split("|")]


# Tables -------------------------------------------------------------------------------------------------------


def test_figure1_has_both_published_speed_ups(written):
    text = table(written, "Figure 1")
    assert markdown_row(text, "| CT head (cranium_ct)")[1:] == [
        "0.190 [0.190, 0.190], 40.0 dB; paper 0.19", "1.54 [1.54, 1.54], 40.0 dB; paper 1.54", "8.11 [8.11, 8.11]", "8.11 (7.87–8.35)", "7.92"]
    assert markdown_row(text, "| supernova (blast_wave)")[-2:] == ["4.86 (4.76–4.96)", "4.74"]
    assert "two speed-ups" in text and "Measured at 3840 × 2160 pixels." in text


def test_figure6_has_every_resolution_and_published_beside_measured(written):
    text = table(written, "Figure 6")
    assert len([line for line in text.splitlines() if " × " in line and line.startswith("|")]) == 3 * 2 * len(SIZES)
    row = markdown_row(text, "| vertebra | still | 3840 × 2160")
    assert row[4].endswith("; paper 0.26") and row[6].count("paper") == 0
    assert row[7] == "7.72 [7.72, 7.72]; paper 7.64" and row[8] == "2.01 [2.01, 2.01]; paper 2.03"
    assert "paper" not in "".join(markdown_row(text, "| vertebra | orbit | 3840 × 2160")[4:])
    assert "crosses 1: between 2.1 and 8.3 megapixels; paper: at 2.7 megapixels" in text


def test_figure7_has_draw_times_and_frame_times(written):
    text = table(written, "Figure 7 (a)")
    draw = markdown_row(text, "| 3840 × 2160 | draw times")
    frame = markdown_row(text, "| 3840 × 2160 | with update")
    assert draw[2].startswith("0.290 [") and draw[2].endswith("paper 0.29") and frame[2].startswith("0.300 [") and "paper" not in frame[2]
    assert frame[4].startswith("5.1") and frame[5].startswith("2.2")  # meshes are extracted
    assert draw[6] == "4.79 [4.79, 4.79]; paper 4.74" and float(frame[7].split()[0]) < 0.1
    text = table(written, "Figure 7 (b)")
    around = markdown_row(text, "| 0.35 to 0.45 | draw times")[6]
    assert around.startswith("1.00 [") and around.endswith("; paper about 1")
    assert markdown_row(text, "| 0.2 to 0.35 | draw times")[6].startswith("4.00 [4.00, 4.00]")
    assert markdown_row(text, "| 0.45 to 0.9 | with update")[6].startswith("3.73 [")


def test_figure8_has_overheads_in_percent(written):
    text = table(written, "Figure 8")
    rows = [[c.strip() for c in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("| chameleon")]
    assert [row[4].split(" [")[0] for row in rows] == ["30.0", "100", "25.0"] and all(row[4].endswith("] %") for row in rows)
    assert [row[5] for row in rows] == ["19.2 to 36.8 %", "about 100 %", "11.8 to 46.2 %"]


def test_a_smaller_size_is_no_published_size(tmp_path):
    small = (640, 360)
    out = run(tmp_path / "out", figure1(tmp_path / "1", small, ["CT head"]),
              by_size(tmp_path / "6a", "fig6a", as_published("CT head"), [(320, 180), small]))
    figure1_row = markdown_row(table(out, "Figure 1"), "| CT head")
    assert figure1_row[1].endswith("; paper 0.19") and "Measured at 640 × 360 pixels." in table(out, "Figure 1")
    text = table(out, "Figure 6")
    assert "paper" not in "".join(markdown_row(text, "| CT head (cranium_ct) | still | 640 × 360"))
    assert markdown_row(text, "| CT head (cranium_ct) | still | 3840 × 2160")[4:8] == [
        "not measured; paper 0.19", "not measured; paper 1.54", "not measured", "not measured; paper 7.92"]
    assert not any(r["published_draw_ms"] for r in csv.DictReader(io.StringIO((out / "measured.csv").read_text())) if r["width"])


def test_failed_points_say_why(tmp_path):
    out = run(tmp_path / "out", figure8(tmp_path / "8", {OURS: 1.3, MARCHING: 2.0, MESH: 1.25}, status="unsupported"))
    row = markdown_row(table(out, "Figure 8"), "| vertebra | direct")
    assert row[2:5] == ["unsupported: needs more memory", "unsupported: needs more memory", "not measured"]
    assert "fig8: not measured" in (out / "figures.md").read_text()


def test_crossings(tmp_path):
    def draw(name, gains):
        times = {round(w * h / 1e6, 3): gain for (w, h), gain in zip(SIZES, gains)}
        folder = by_size(tmp_path / name, "fig6c", lambda method, mp: (times[round(mp, 3)] if method == MARCHING else 1.0, 0.0))
        return load_sources([folder])["fig6c"].draw

    assert crossing_text(draw("up", (0.5, 1.5, 2.0))) == "between 0.52 and 2.1 megapixels"
    assert crossing_text(draw("twice", (0.5, 1.5, 0.8))) == "between 0.52 and 2.1 megapixels and between 2.1 and 8.3 megapixels"
    assert crossing_text(draw("below", (0.5, 0.6, 0.8))) == "nowhere from 0.52 to 8.3 megapixels, it is below 1"


def test_csv_has_every_point_in_both_measures(written):
    rows = list(csv.DictReader(io.StringIO((written / "measured.csv").read_text())))
    assert len(rows) == 8 + 6 * len(SIZES) * 3 + len(SIZES) * 4 + 4 + 4 * 2 * 3 and {r["status"] for r in rows} == {"completed"}
    row = next(r for r in rows if (r["figure"], r["method"], r["width"]) == ("fig7a", MESH, "3840"))
    assert float(row["frame_ms"]) == pytest.approx(float(row["draw_ms"]) + 5.0) and float(row["update_ms"]) == 5.0
    assert (row["dataset"], row["height"], row["device_type"]) == ("supernova", "2160", "discrete_gpu")
    assert (row["bounds"], row["psnr_db"]) == ("interval", "40")
    assert [r["published_draw_ms"] for r in rows[:2]] == ["0.19", "1.54"]


def test_tex_is_balanced(written):
    text = (written / "tables.tex").read_text()
    assert text.count(r"\begin{") == text.count(r"\end{") == 10
    for part in text.split(r"\begin{tabular}")[1:]:
        body = part.split(r"\end{tabular}")[0].splitlines()
        assert len({line.replace(r"\&", "").count("&") for line in body if line.endswith(r"\\")}) == 1


# Missing experiments ------------------------------------------------------------------------------------------


def test_without_anything_all_is_not_measured(tmp_path):
    out = run(tmp_path / "out")
    assert {path.name for path in out.iterdir()} == FILES
    assert "| held |" not in (out / "claims.md").read_text()
    rows = list(csv.DictReader(io.StringIO((out / "measured.csv").read_text())))
    assert {r["status"] for r in rows} == {"not measured"} and not any(r["draw_ms"] or r["frame_ms"] for r in rows)
    assert {r["figure"] for r in rows} == set(AXES)
    cells = [cell for line in (out / "tables.md").read_text().splitlines() if line.startswith("| ") for cell in line.split("|")]
    assert not any(" dB" in cell for cell in cells) and sum("not measured" in cell for cell in cells) > 60
    assert (out / "figures.md").read_text().count(": not measured") == len(FIGURES)


@pytest.mark.parametrize("arguments, text", [([], "--output: missing"), (["nowhere", "-o", "out"], "no such folder")])
def test_refusals_are_one_line(capsys, arguments, text):
    assert main(["paper", "direct_rasterization", *arguments]) == 2
    error = capsys.readouterr().err
    assert text in error and error.count("\n") == 1


def test_other_experiments_are_refused(tmp_path, capsys):
    other = write_made(tmp_path / "other", "other", ("method",), [Made({"method": OURS}, method=OURS, processes=1)])
    wrong_axes = write_made(tmp_path / "axes", "direct_rasterization_fig8", ("method",), [Made({"method": OURS}, method=OURS, processes=1)])
    no_sweep = write_made(tmp_path / "sweep", "direct_rasterization_fig7b", ("method",), [Made({"method": OURS}, method=OURS, processes=1)])
    no_draw = figure1(tmp_path / "draw", datasets=["CT head"], by_phase=lambda phase: 0.0)
    fig1 = figure1(tmp_path / "1", datasets=["CT head"])
    for folders, text in (([other], "found an experiment 'other'"), ([wrong_axes], "no label 'dataset'"), ([no_sweep], "isovalue_sweep"),
                          ([fig1, fig1], "a second experiment"), ([no_draw], "column draw_ms: a headline frame has no time above 0")):
        assert main(["paper", "direct_rasterization", *map(str, folders), "-o", str(tmp_path / "out")]) == 2
        error = capsys.readouterr().err
        assert text in error and error.count("\n") == 1


# Figures ------------------------------------------------------------------------------------------------------


def test_figures_are_drawn(written):
    for name in FIGURES:
        assert (written / f"{name}.png").stat().st_size > 5000 and b"</svg>" in (written / f"{name}.svg").read_bytes()
    captions = (written / "figures.md").read_text()
    assert "40.0 dB" in captions and "not measured" not in captions and "supernova is blast_wave" in captions


def test_figures_are_drawn_of_what_there_is(tmp_path):
    times = as_published("chameleon")
    folders = [by_size(tmp_path / "6c", "fig6c", lambda method, mp: None if method == MESH else times(method, mp), SIZES[:1], processes=1),
               by_size(tmp_path / "6b", "fig6b_orbit", as_published("vertebra"), processes=2, noise=0.1),
               by_size(tmp_path / "7a", "fig7a", as_published("supernova"), methods=(OURS, CUBES), processes=1, **SOFTWARE),
               figure7b(tmp_path / "7b", timed=True, processes=1, orbits=1),
               figure8(tmp_path / "8", {OURS: 0.9, MARCHING: 2.0, MESH: 1.25}, datasets=["vertebra"], processes=1, orbits=1)]
    out = run(tmp_path / "out", *folders)
    assert all((out / f"{name}.png").exists() for name in FIGURES)


# Scenarios ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("figure", AXES)
def test_scenarios_have_what_the_analysis_reads(figure):
    text = (SCENARIOS / f"{figure}.json").read_text()
    document = json.loads(text)
    assert compact_json(document) + "\n" == text
    (block,) = document["blocks"]
    assert document["name"] == f"direct_rasterization_{figure}" and set(AXES[figure]) == set(block["axes"])
    assert {"lavapipe", "smoke"} <= set(document["profiles"]) and document["set"]["shading.model"] == "gooch"
    methods = {case["label"]: case["set"]["technique.name"] for case in block["axes"]["method"]["values"]}
    names = {OURS: "mesh_shader_isosurface", MARCHING: "iso_octree", MESH: "optimized_mesh", CUBES: "marching_cubes"}
    assert methods == {m: names[m] for m in methods} and {OURS, MARCHING} <= set(methods)
    assert {case["label"] for case in block["axes"].get("dataset", {}).get("values", [])} in (set(), set(published.DATASETS))


def test_resolutions_are_those_of_the_paper_and_16_to_9():
    for path in SCENARIOS.glob("*.json"):
        document = json.loads(path.read_text())
        axis = document["blocks"][0]["axes"].get("resolution", {"values": [document["set"].get("resolution")]})
        assert tuple(axis["values"][-1]) == FULL
        lavapipe = document["profiles"]["lavapipe"]
        small = lavapipe.get("blocks", {}).get("0", {}).get("axes", {}).get("resolution", {"values": [lavapipe["set"].get("resolution")]})
        for width, height in axis["values"] + small["values"]:
            assert width * 9 == height * 16
        assert all(w * h <= lavapipe["limits"]["pixels"] == 640 * 360 for w, h in small["values"])


def test_unwritable_output_is_one_line(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main(["paper", "direct_rasterization", "-o", str(tmp_path / "file")]) == 2
    assert "can't be written" in capsys.readouterr().err
