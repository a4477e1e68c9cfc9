import csv
import io
import json
import re

import pytest
from volmark_analysis.__main__ import main
from volmark_analysis.columns import bytes_text, count_text, number_text
from volmark_analysis.comparisons import technique_comparisons
from volmark_analysis.load import load_experiment
from volmark_analysis.pivots import pivot_of, pivot_to_csv, pivot_to_markdown, pivot_to_tex
from volmark_analysis.points import point_results
from volmark_analysis.summary import findings
from volmark_analysis.tables import results_table, tex_text


def printed(capsys, *arguments):
    assert main(list(arguments)) == 0
    return capsys.readouterr().out


@pytest.mark.parametrize("value, text", [(0, "0"), (12.345, "12.3"), (1234.5, "1234"), (0.012345, "0.0123"),
                                         (9.999, "10.00"), (1e-9, "1.00e-09"), (-3.14159, "-3.14")])
def test_numbers_have_three_digits(value, text):
    assert number_text(value) == text


def test_sizes_and_counts():
    assert bytes_text(2097152) == "2.00 MiB" and bytes_text(10) == "10 B"
    assert count_text(90000) == "90.0 k" and count_text(2.5e6) == "2.50 M" and count_text(7) == "7"


def test_markdown_has_a_row_per_point_of_equal_width(experiment_folder, capsys):
    text = printed(capsys, "table", str(experiment_folder))
    rows = [line for line in text.splitlines() if line.startswith("|")]
    assert len(rows) == 2 + 10
    widths = {len(re.findall(r"(?<!\\)\|", row)) for row in rows}
    assert len(widths) == 1
    assert "failed: VK_ERROR_DEVICE_LOST in pass march \\| the driver" in text
    assert "unsupported: needs 64-bit atomics" in text
    for word in ("synthetic", "smoke", "llvmpipe", "Mesa 25.0.7", "24 frames × 3 orbits × 1–5 processes"):
        assert word in text.splitlines()[0]


def test_intervals_and_spreads_are_told_apart(experiment_folder, capsys):
    rows = printed(capsys, "table", str(experiment_folder)).splitlines()
    five = next(r for r in rows if "nested_ellipsoids | 0.5" in r)
    one = next(r for r in rows if "marschner_lobb | 0.5" in r)
    assert re.search(r"\d \[\d", five) and not re.search(r"\d \[\d", one) and re.search(r"\d \(\d", one)


def test_dagger_comes_with_its_note(experiment_folder, capsys):
    text = printed(capsys, "table", str(experiment_folder))
    assert text.count("†") == 8 + 1 and "fewer than 299" in text


@pytest.mark.parametrize("name", ["low1_avg_ms", "low1_integral_ms", "p99_ms"])
def test_low1_is_named(experiment_folder, capsys, name):
    assert f"({name})" in printed(capsys, "table", str(experiment_folder), "--low1", name)


def test_csv_has_plain_numbers(experiment_folder, capsys):
    text = printed(capsys, "table", str(experiment_folder), "--format", "csv", "--columns",
                   "step,mean_ms,psnr_db,fps,counter.samples,status")
    rows = list(csv.DictReader(io.StringIO(text)))
    assert len(rows) == 10
    assert float(rows[0]["fps"]) == pytest.approx(1000 / float(rows[0]["mean_ms"]))
    assert float(rows[1]["counter.samples"]) > 0
    assert rows[7]["mean_ms"] == "" and rows[7]["status"] == "failed"


def test_tex_is_balanced_and_escaped(experiment_folder, capsys):
    text = printed(capsys, "table", str(experiment_folder), "--format", "tex")
    begins, ends = re.findall(r"\\begin{(\w+)}", text), re.findall(r"\\end{(\w+)}", text)
    assert begins == ["table", "tabular"] and ends == ["tabular", "table"]
    assert not re.search(r"(?<!\\)[_%#](?! needs)", text.split("\n", 1)[1].replace("{tab:results}", ""))
    columns = len(re.search(r"\\begin{tabular}{(\w+)}", text)[1])
    for line in text.splitlines():
        if line.endswith(r"\\"):
            span = re.search(r"\\multicolumn{(\d+)}", line)
            assert len(re.findall(r"(?<!\\)&", line)) + 1 + (int(span[1]) - 1 if span else 0) == columns
    assert tex_text("50% & a_b") == r"50\% \& a\_b"


def test_a_time_is_never_alone(experiment_folder):
    experiment = load_experiment(experiment_folder)
    results = point_results(experiment)
    for chosen in (["fps"], ["step", "mean_ms"], ["host_median_ms", "memory_bytes"], ["pass.march"]):
        table = results_table(experiment, results, columns=chosen)
        names = [c.name for c in table.columns]
        assert names[names.index(next(c.name for c in table.columns if c.is_time)) + 1] == "psnr_db"
    assert "psnr_db" not in [c.name for c in results_table(experiment, results, columns=["memory_bytes"]).columns]
    chosen = ["step", "psnr_db", "mean_ms"]
    assert [c.name for c in results_table(experiment, results, columns=chosen).columns] == chosen


def test_unknown_column_names_the_nearest(experiment_folder, capsys):
    assert main(["table", str(experiment_folder), "--columns", "mean_sm"]) == 2
    error = capsys.readouterr().err
    assert "did you mean mean_ms?" in error and "low1_avg_ms" in error and error.count("\n") == 1


def test_identical_pictures_have_no_psnr(fresh_folder, capsys):
    for path in fresh_folder.glob("runs/*/[!.]*/run.json"):
        document = json.loads(path.read_text())
        if document["point_index"] == 0:
            for picture in document["pictures"]:
                picture.update(mse=0.0, psnr_db=None, identical=True)
            path.write_text(json.dumps(document))
    assert "| identical |" in printed(capsys, "table", str(fresh_folder))
    results = point_results(load_experiment(fresh_folder))
    assert "identical" in findings(results, technique_comparisons(results))[0][3]


def test_pivots_need_one_or_two_axes(experiment_folder):
    experiment = load_experiment(experiment_folder)
    results = point_results(experiment)
    assert pivot_of(experiment, results) is None  # technique, scene, step
    two = [r for r in results if r.scene == "nested_ellipsoids" and r.technique != "dvr_temporal"]
    pivot = pivot_of(experiment, two)
    assert (pivot.row_axis, pivot.column_axis) == ("technique", "step")
    assert len(pivot.rows) == 2 and len(pivot.columns) == 2
    assert all(re.fullmatch(r"[\d.]+ \([\d.]+ dB\)", cell) for cell in pivot.cells.values())
    assert pivot_to_markdown(pivot).count("\n|") == 4
    assert pivot_to_csv(pivot).count("\n") == 3
    assert pivot_to_tex(pivot).count(r"\\") == 3
    one = pivot_of(experiment, two[:2])
    assert (one.row_axis, one.column_axis) == ("step", "")
    assert pivot_of(experiment, two[:1]) is None


def test_compare_pairs_what_agrees(experiment_folder, capsys):
    text = printed(capsys, "compare", str(experiment_folder), "--a", "technique=iso_raymarch", "--b", "technique=dvr_raymarch")
    rows = [line for line in text.splitlines() if line.startswith("|")][2:]
    assert len(rows) == 3 and "[" in rows[0] and rows[2].rstrip().endswith("– |")
    text = printed(capsys, "compare", str(experiment_folder), "--a", "technique=iso_raymarch,scene=nested_ellipsoids",
                   "--a", "step=0.5", "--b", "technique=dvr_temporal")
    assert len([line for line in text.splitlines() if line.startswith("|")]) == 3


@pytest.mark.parametrize("a, b, text", [
    ("technique", "step=1.0", "allowed: label=value"),
    ("tecnique=x", "step=1.0", "did you mean technique?"),
    ("step=2", "step=1.0", "allowed: 0.5, 1.0"),
    ("step=0.5,scene=marschner_lobb,technique=dvr_raymarch", "step=1.0", "--a: no completed run"),
    ("step=1.0", "step=1.0", "no two different results"),
])
def test_compare_refuses(experiment_folder, capsys, a, b, text):
    assert main(["compare", str(experiment_folder), "--a", a, "--b", b]) == 2
    error = capsys.readouterr().err
    assert text in error and error.count("\n") == 1
