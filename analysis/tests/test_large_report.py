"""Reports of large experiments and of hostile names."""

import re

import pytest
from hostile import HOSTILE
from test_report import Page
from volmark_analysis import limits
from volmark_analysis.limits import evenly, first_of
from volmark_analysis.load import load_experiment
from volmark_analysis.plots import plots_of
from volmark_analysis.points import point_results
from volmark_analysis.sheet import picture_sets

RUNS = 200


def test_pictures_are_chosen_from_worst_to_best(large_folder):
    experiment = load_experiment(large_folder)
    results = point_results(experiment)
    sets, note = picture_sets(experiment, results)
    cards = [card for s in sets for block in s.blocks for card in block.cards]
    assert len(sets) == limits.MOST_SETS and len(cards) <= limits.MOST_SETS * limits.MOST_MEMBERS
    assert f"{len(cards)} of {RUNS} points are shown" in note
    shown = [float(re.search(r"([\d.]+) dB", card.note)[1]) for card in cards]
    all_psnr = [r.errors["psnr_db"] for r in results]
    assert min(shown) == pytest.approx(min(all_psnr), abs=0.05) and max(shown) == pytest.approx(max(all_psnr), abs=0.05)
    assert [b.lowest_psnr for s in sets for b in s.blocks] == sorted(b.lowest_psnr for s in sets for b in s.blocks)


def test_plots_are_limited_and_say_so(large_folder):
    for plot in plots_of(point_results(load_experiment(large_folder))):
        assert len(plot.panels) <= limits.MOST_PANELS
        shown = sum(len(panel.results) for panel in plot.panels)
        wanted = RUNS // 2 if plot.name == "depth_time" else RUNS  # volumes have no depth error
        assert shown == wanted or plot.note or any(panel.note for panel in plot.panels), plot.name
    error_time = next(p for p in plots_of(point_results(load_experiment(large_folder))) if p.name == "error_time")
    assert sum(len(panel.results) for panel in error_time.panels) == RUNS  # points need little room


def test_page_has_all_points_and_a_modest_size(large_folder):
    text = (large_folder / "report.html").read_text(encoding="utf-8")
    page = Page(text)
    assert len(text) < 8_000_000
    results_rows = [row for row in page.rows if "MiB" in row and "raymarch" in row]
    assert len(results_rows) == RUNS
    images = [a for a in page.addresses if a.startswith("data:image/png")]
    assert len(images) < 5 * limits.MOST_SETS * limits.MOST_MEMBERS + 20
    assert text.count("<td style=") == RUNS  # the heat maps
    assert "are shown" in text


def test_evenly():
    assert evenly([1, 2, 3], 3) == [1, 2, 3]
    for count in range(5, 50):
        for most in range(2, 5):
            chosen = evenly(list(range(count)), most)
            assert len(set(chosen)) == most and chosen[0] == 0 and chosen[-1] == count - 1 and chosen == sorted(chosen)


def test_lists_count_what_they_leave_out():
    assert first_of(["a", "b"], 2, "x") == ["a", "b"]
    assert first_of(["a", "b", "c", "d"], 2, "the table") == ["a", "b", "… and 2 more: the table"]


def test_hostile_text_stays_text(hostile_folder):
    text = (hostile_folder / "report.html").read_text(encoding="utf-8")
    page = Page(text)
    assert page.tags.count("script") == 1 and page.tags.count("style") == 1
    assert not {"b", "u"} & set(page.tags)
    assert all(a.startswith("data:") for a in page.addresses)
    words = "".join(page.words)
    for piece in HOSTILE:
        assert piece in words, piece  # shown as it is
    assert not [name for name in page.attributes if name.startswith("on")]
    assert not (hostile_folder / "escaped.svg").exists() and not list(hostile_folder.parent.glob("*escaped*"))
    assert len(list((hostile_folder / "plots").glob("counter_*escaped.svg"))) == 1
