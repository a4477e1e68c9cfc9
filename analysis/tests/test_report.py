import base64
import os
import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree

import pytest
import synthetic
from volmark_analysis.__main__ import main
from volmark_analysis.comparisons import technique_comparisons
from volmark_analysis.load import load_experiment
from volmark_analysis.plots import FAINT, ON_DARK, TEXT, figure_of, plots_of, styles_of, svg_of
from volmark_analysis.points import point_results
from volmark_analysis.summary import findings

VOID = {"meta", "img", "source", "br", "hr", "input", "link"}


class Page(HTMLParser):
    """Checks nesting; keeps text, addresses, attributes' names and table rows."""

    def __init__(self, text):
        super().__init__()
        self.open, self.addresses, self.rows, self.tags, self.words, self.attributes = [], [], [], [], [], []
        self.feed(text)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.attributes += [k for k, _ in attributes]
        self.addresses += [v for k, v in attributes if k in ("src", "srcset", "href", "action", "data", "poster")]
        if tag == "tr":
            self.rows.append("")
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, (tag, self.open[-3:], self.getpos())
        self.open.pop()

    def handle_data(self, data):
        if self.rows and "tr" in self.open:
            self.rows[-1] += data + " "
        if not {"script", "style"} & set(self.open):
            self.words.append(data)


@pytest.fixture(scope="module")
def made(experiment_folder, tmp_path_factory):
    """A folder with its report, and the page."""
    folder = Path(shutil.copytree(experiment_folder, tmp_path_factory.mktemp("report") / "synthetic"))
    assert main(["report", str(folder)]) == 0
    text = (folder / "report.html").read_text(encoding="utf-8")
    return folder, text, Page(text)


def test_loads_nothing_from_anywhere(made):
    _, text, page = made
    assert page.addresses and all(a.startswith("data:") for a in page.addresses)
    assert not re.search(r"https?://|//[a-z]+\.[a-z]|@import|url\(", text)
    assert not {"link", "iframe", "object", "embed"} & set(page.tags)


def test_has_every_point(made):
    _, _, page = made
    for point in synthetic.points():
        assert any(all(value in row for value in point["labels"].values()) for row in page.rows), point
    assert any("VK_ERROR_DEVICE_LOST" in row for row in page.rows)


def test_text_is_escaped(made):
    assert "times &amp; pictures are &lt;invented&gt;" in made[1]


def test_says_what_matters_first(made):
    words = re.sub(r"\s+", " ", " ".join(made[2].words))
    start = words[: words.index("Results")]
    assert re.search(r"iso_raymarch was faster than dvr_raymarch in all 3 comparisons, by 1\.\d+× to [12]\.\d+×", start)
    assert re.search(r"lowest PSNR [\d.]+ dB to [\d.]+ dB against", start)
    for word in ("failed", "unsupported", "insufficient_frames", "disturbed", "memory equals ledger", "history visible"):
        assert word in start, word


def test_pictures_and_plots_are_complete(made):
    _, text, page = made
    images = [a for a in page.addresses if a.startswith("data:image/png")]
    # Per frame: reference and error of isosurfaces (with depth) and volumes (with iterations unless temporal).
    iso, dvr_first, dvr_second = 1 + 2 * 3, 1 + 2 * 3 + 1 * 2, 1 + 1 * 3
    # Scale bars: two kinds of error, iterations of two groups, and one for each of five quantities of the grid.
    assert len(images) == 2 * (2 * iso + dvr_first + dvr_second) + 2 + 2 + 5
    for address in page.addresses:
        kind, data = re.fullmatch(r"data:(image/[a-z+]+);base64,(.*)", address).groups()
        data = base64.b64decode(data, validate=True)
        if kind == "image/png":
            assert data.startswith(b"\x89PNG")
        else:
            assert ElementTree.fromstring(data).tag.endswith("svg")


def test_does_not_name_the_host(made):
    assert "secret-host" not in made[1] and "a processor" in made[1]


def test_size_is_modest(made):
    assert len(made[1]) < 3_000_000


def test_leaves_tables_and_plots(made):
    folder = made[0]
    names = {p.name for p in (folder / "tables").iterdir()}
    assert {"results.md", "results.tex", "results.csv", "work.md", "comparisons.md"} <= names
    stems = {p.stem for p in (folder / "plots").glob("*.svg")}
    assert {"mean", "orbit", "error_time", "depth_time", "ssim_time", "flip_time", "passes", "counter_samples"} <= stems
    assert stems == {p.stem for p in (folder / "plots").glob("*.png")}
    assert not list(folder.glob("*.part"))


def test_equal_input_gives_equal_plots(made):
    results = point_results(load_experiment(made[0]))
    plot = plots_of(results)[1]
    svg = svg_of(figure_of(plot, plot.panels[:1], styles_of(results), titles=False))
    assert base64.b64encode(svg).decode() in made[1]


def test_dark_plots_use_no_colour_of_the_light_ground(made):
    pages = [base64.b64decode(a.split(",")[1]).decode() for a in made[2].addresses if "svg" in a[:20]]
    dark, light = pages[0::2], pages[1::2]
    assert len(dark) == len(light)
    for d, l in zip(dark, light):
        assert TEXT in l and ON_DARK[TEXT] in d and TEXT not in d and FAINT not in d
        assert len(d) == len(l)


def test_one_hue_per_technique_everywhere(experiment_folder):
    results = point_results(load_experiment(experiment_folder))
    styles = styles_of(results)
    looks = {(r.technique, r.labels.get("step")): styles[id(r)].color for r in results}
    for r in results:  # the same in both scenes
        assert styles[id(r)].color == looks[r.technique, r.labels.get("step")]
    assert len(set(looks.values())) == len(looks)


def test_panels_keep_the_order_of_points(experiment_folder):
    results = point_results(load_experiment(experiment_folder))
    for plot in plots_of(results):
        for panel in plot.panels:
            indices = [r.point_index for r in panel.results]
            assert indices == sorted(indices)


def test_unwritable_target(experiment_folder, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main(["report", str(experiment_folder), "-o", str(tmp_path / "file" / "r.html")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


def test_damaged_picture(fresh_folder, capsys):
    path = next(fresh_folder.glob("references/*.exr"))
    path.write_bytes(path.read_bytes()[:100])
    assert main(["report", str(fresh_folder)]) == 2
    error = capsys.readouterr().err
    assert str(path) in error and error.count("\n") == 1 and not (fresh_folder / "report.html").exists()


def test_runs_from_the_repository():
    package = Path(__file__).parent.parent
    environment = {**os.environ, "PYTHONPATH": str(package)}
    help_text = subprocess.run([sys.executable, "-m", "volmark_analysis", "--help"], env=environment, cwd="/",
                               capture_output=True, text=True, check=True).stdout
    for word in ("report", "table", "plots", "compare", "examples:"):
        assert word in help_text
    for name in ("report", "table", "plots", "compare"):
        with pytest.raises(SystemExit) as ended:
            main([name, "--help"])
        assert ended.value.code == 0


def test_many_scenes_are_folded_away(experiment_folder):
    results = point_results(load_experiment(experiment_folder))
    first, folded = findings(results, technique_comparisons(results))
    assert len(first) == 3 + 2 and not folded
    for i, r in enumerate(results):
        for run in r.completed + r.others:
            run.config["scene"] = f"scene {i}"
    first, folded = findings(results, technique_comparisons(results))
    assert len(first) == 3 and len(folded) == 8
    alone = [r for r in results if r.technique == "iso_raymarch"]
    first, folded = findings(alone, technique_comparisons(alone))
    assert len(first) == 4 and not folded  # nothing to compare: the scenes are what there is to say
    assert "took" in first[0]
