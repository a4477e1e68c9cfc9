"""Fronts of error against time, their table and plot."""

import csv
import io
import xml.etree.ElementTree

import numpy as np
import pytest
from matplotlib.collections import LineCollection, PathCollection
from made_points import made_point, noisy
from volmark_analysis.__main__ import main
from volmark_analysis.plots import TEXT, figure_of, styles_of
from volmark_analysis.search.candidates import contests_of
from volmark_analysis.search.front_plot import front_plot
from volmark_analysis.search.pareto import DOMINATED, FRONT, UNDECIDED, front_of, front_table


def front(points, error="psnr_db"):
    (contest,) = contests_of(points, [], "median_ms", [], error)
    return front_of(contest, error)


def random_points(rng, count=30, pictures=3):
    return [made_point(i, noisy(rng, rng.uniform(5, 15), rng.integers(1, 4)),
                       rng.choice([30.0, 35.0, 40.0, 45.0, np.inf], pictures)) for i in range(count)]


def worst(r):
    return min(np.inf if p["identical"] else p["psnr_db"] for run in r.completed for p in run.pictures)


def no_worse(a, b):
    return all(x["psnr_db"] is None or (y["psnr_db"] is not None and x["psnr_db"] >= y["psnr_db"])
               for x, y in zip(a.completed[0].pictures, b.completed[0].pictures))


@pytest.mark.parametrize("seed", range(8))
def test_places_mean_what_they_say(seed):
    points = random_points(np.random.default_rng(seed))
    found = front(points)
    times = found.contest.times
    members = found.members(FRONT)
    for a, b in zip(members, members[1:]):
        assert times[id(a)].value < times[id(b)].value and worst(a) < worst(b)
    for r in points:
        faster = [o for o in points if o is not r and times[id(o)].value <= times[id(r)].value and worst(o) >= worst(r)]
        surely = [o for o in points if times[id(o)].high < times[id(r)].low and no_worse(o, r)]
        place = found.places[id(r)]
        assert (place == FRONT) == (not faster)
        assert (place == DOMINATED) == bool(surely)
        assert (place == UNDECIDED) == (bool(faster) and not surely)
    assert {FRONT, DOMINATED} <= set(found.places.values())


def test_only_one_picture_that_is_better_leaves_it_undecided():
    calm = [[np.full(4, 1.0), np.full(4, 1.01)]]
    slow = [[np.full(4, 2.0), np.full(4, 2.01)]]
    best = made_point(0, calm, (50.0, 40.0))
    assert front([best, made_point(1, slow, (49.0, 39.0))]).places[id(best)] == FRONT
    for pictures, place in (((49.0, 39.0), DOMINATED), ((51.0, 39.0), UNDECIDED), ((50.0, 40.0), DOMINATED)):
        other = made_point(1, slow, pictures)
        assert front([best, other]).places[id(other)] == place


def test_pictures_that_differ_between_processes_are_uncertain_too():
    calm, slow = [[np.full(4, 1.0), np.full(4, 1.01)]] * 2, [[np.full(4, 2.0), np.full(4, 2.01)]] * 2
    steady, other = made_point(0, calm, replicas=[(40.0,), (38.0,)]), made_point(1, slow, replicas=[(37.0,), (37.5,)])
    assert front([steady, other]).places[id(other)] == DOMINATED
    other = made_point(1, slow, replicas=[(37.0,), (39.0,)])
    assert front([steady, other]).places[id(other)] == UNDECIDED


def test_overlapping_times_leave_it_undecided():
    best = made_point(0, [[np.full(4, 1.0), np.full(4, 1.2)]], (40.0,))
    for ms, place in ((1.15, UNDECIDED), (1.21, DOMINATED)):
        other = made_point(1, [[np.full(4, ms), np.full(4, ms + 0.2)]], (30.0,))
        assert front([best, other]).places[id(other)] == place


def test_errors_where_less_is_better_give_the_mirror_image():
    points = random_points(np.random.default_rng(1))  # flip falls as psnr_db rises
    assert front(points).places == front(points, "flip").places


def test_points_without_the_error_are_counted():
    points = random_points(np.random.default_rng(1), 5) + [made_point(9, [[np.ones(3)]], ())]
    (contest,) = contests_of(points, [], "median_ms", [], "psnr_db")
    assert contest.left_out == {"without psnr_db": 1} and len(contest.points) == 5


@pytest.mark.parametrize("seed", range(3))
def test_the_plot_shows_every_point_and_joins_the_front(seed):
    points = random_points(np.random.default_rng(seed), 20)
    found = front(points)
    plot = front_plot([found], "median_ms")
    axes = figure_of(plot, plot.panels, styles_of(points)).axes[0]
    drawn = [x for c in axes.collections if isinstance(c, PathCollection) for x, _ in c.get_offsets()]
    assert sorted(drawn) == pytest.approx(sorted(t.value for t in found.contest.times.values()))
    (joined,) = [line for line in axes.lines if line.get_color() == TEXT and line.get_linestyle() == "-"]
    assert list(joined.get_xdata()) == [found.contest.times[id(r)].value for r in found.members(FRONT)]
    bars = [segment for c in axes.collections if isinstance(c, LineCollection) for segment in c.get_segments()]
    bounds = {(a[0], b[0]) for a, b in bars if a[1] == b[1]}
    assert all((t.low, t.high) in bounds for t in found.contest.times.values())
    ends = {tuple(sorted((a[1], b[1]))) for a, b in bars if a[0] == b[0]}
    top = max(worst(r) for r in points if worst(r) < np.inf) + 8
    for r in points:
        best = max(np.inf if p["identical"] else p["psnr_db"] for p in r.completed[0].pictures)
        assert (min(worst(r), top), min(best, top)) in ends
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    assert len([n for n in names if n[0].isdigit() and "step" in n]) == len(found.members(FRONT))
    assert f"{len(found.members(DOMINATED))} dominated" in names


def test_command(experiment_folder, large_folder, capsys):
    assert main(["pareto", str(large_folder), "--format", "csv"]) == 0
    captured = capsys.readouterr()
    rows = list(csv.DictReader(io.StringIO(captured.out)))
    assert len(rows) == 200 and {r["place"] for r in rows} == {FRONT, UNDECIDED, DOMINATED}
    for name in ("svg", "png"):
        assert str(large_folder / "plots" / f"pareto.{name}") in captured.err
    xml.etree.ElementTree.parse(large_folder / "plots" / "pareto.svg")
    assert (large_folder / "plots" / "pareto.png").read_bytes().startswith(b"\x89PNG")
    assert main(["pareto", str(experiment_folder), "--error", "mse", "--per", "scene,technique"]) == 0
    header, *table = [line for line in capsys.readouterr().out.splitlines() if line.startswith("| ")]
    assert "MSE" in header and not any(DOMINATED in line for line in table) and len(table) > 4


def test_nothing_to_show_is_one_line(experiment_folder, capsys):
    assert main(["pareto", str(experiment_folder), "--min-psnr", "99"]) == 2
    said = capsys.readouterr().err
    assert "no point with median_ms and psnr_db" in said and len(said.splitlines()) == 1


def test_the_report_of_a_grid_shows_its_fronts(large_folder, experiment_folder, tmp_path, capsys):
    page = (large_folder / "report.html").read_text()
    section = page[page.index('<section id="best">'):]
    section = section[:section.index("</section>")]
    assert main(["pareto", str(large_folder), "--format", "csv"]) == 0
    printed = capsys.readouterr().out
    assert (large_folder / "tables" / "pareto.csv").read_text() == printed
    kept = [r for r in csv.DictReader(io.StringIO(printed)) if r["place"] != DOMINATED]
    assert section.count("<tr>") == 1 + len(kept) and section.count("<figure>") == len({r["draws"] for r in kept}) == 2
    # Two or three points of a scene need no search.
    assert main(["report", str(experiment_folder), "-o", str(tmp_path / "report.html")]) == 0
    assert "Best parameters" not in (tmp_path / "report.html").read_text()
