"""Times with bounds, who competes with whom, the best and its ties."""

import csv
import io
import json
import re

import numpy as np
import pytest
from made_points import made_point, noisy
from volmark_analysis.__main__ import main
from volmark_analysis.errors import InputError
from volmark_analysis.points import PointResult
from volmark_analysis.search.best import best_of
from volmark_analysis.search.candidates import Limit, contests_of
from volmark_analysis.search.objective import OBJECTIVES, measured


@pytest.mark.parametrize("processes", [1, 2, 4, 5, 8])
def test_times_agree_with_those_of_all_other_tables(processes):
    result = made_point(0, noisy(np.random.default_rng(processes), 10.0, processes))
    time = measured(result, "mean_ms")
    assert (time.low, time.high) == pytest.approx(result.interval or result.spread)
    assert time.is_interval == (processes >= 5)
    for name in OBJECTIVES:
        time = measured(result, name)
        if name == "gpu_median_ms":
            assert time is None  # it has none
        else:
            assert time.value == pytest.approx(result.statistics[name]) and time.low <= time.value <= time.high


@pytest.mark.parametrize("objective", ["median_ms", "p99_ms", "cpu_median_ms"])
def test_bounds_scale_with_the_times_and_shrink_with_the_noise(objective):
    def at(scale, between):
        processes = noisy(np.random.default_rng(1), 10.0, 6, between=between, within=between / 3)
        return measured(made_point(0, [[scale * o for o in orbits] for orbits in processes]), objective)
    one, three, calm = at(1, 0.03), at(3, 0.03), at(1, 0.003)
    assert (three.low, three.value, three.high) == pytest.approx((3 * one.low, 3 * one.value, 3 * one.high))
    assert 0 < calm.high - calm.low < 0.2 * (one.high - one.low)


def test_an_interval_mostly_holds_the_truth():
    rng, held = np.random.default_rng(3), 0
    for _ in range(200):
        time = measured(made_point(0, noisy(rng, 10.0, 8, within=0.001)), "median_ms")
        held += time.low <= 10.0 <= time.high
    assert 0.8 < held / 200 < 0.99  # percentile intervals of few processes are somewhat too narrow


def test_one_orbit_has_no_bounds():
    time = measured(made_point(0, [[np.array([1.0, 2.0, 3.0])]]), "median_ms")
    assert time.low == time.high == time.value == 2.0 and time.text == "2.00"


def random_points(rng, count=120):
    return [made_point(i, noisy(rng, rng.uniform(9, 10), rng.integers(1, 7)), rng.uniform(25, 60, 3),
                       labels={"scene": f"scene {rng.integers(0, 3)}"}, device=f"gpu {rng.integers(0, 2)}",
                       draws=("volume", "isosurface")[rng.integers(0, 2)]) for i in range(count)]


@pytest.mark.parametrize("seed", range(5))
def test_the_best_is_the_fastest_within_the_limits_and_ties_are_all_that_overlap(seed):
    points = random_points(np.random.default_rng(seed))
    points += [PointResult({"technique": "t", "scene": "scene 0"}, 1000, ""), made_point(1001, [[np.ones(2)]], ())]
    contests = contests_of(points, ["scene"], "median_ms", [Limit("psnr_db", 30.0)])
    assert sum(len(c.points) + sum(c.left_out.values()) for c in contests) == len(points)
    reasons = {reason for c in contests for reason in c.left_out}
    assert reasons == {"without a result", "without psnr_db", "outside psnr_db at least 30"}
    for contest in contests:
        for name in ("scene", "device", "draws"):  # what can't be compared does not compete
            assert len({contest.where.get(name)} | {_facts(r)[name] for r in contest.points}) <= 1 or not contest.points
        best = best_of(contest)
        if best is None:
            assert not contest.points
            continue
        time = measured(best.point, "median_ms")
        for r in contest.points:
            assert min(p["psnr_db"] for run in r.completed for p in run.pictures) >= 30
            other = measured(r, "median_ms")
            assert other.value >= time.value
            apart = other.low > time.high or other.high < time.low
            assert (r is best.point) or (r in best.ties) != apart


def _facts(r):
    run = r.any_run
    return {"scene": r.labels["scene"], "device": run.provenance["device"]["name"], "draws": run.technique["draws"]}


def test_of_several_builds_the_last_one_counts():
    rng = np.random.default_rng(1)
    old, new = (made_point(0, noisy(rng, ms), started=year) for ms, year in ((5.0, "2023"), (9.0, "2024")))
    for points in ([old, new], [new, old]):
        assert contests_of(points, [], "median_ms", [])[0].points == [new]


@pytest.mark.parametrize("error, value, allowed", [("psnr_db", 30.0, True), ("psnr_db", 31.0, False), ("flip", 1 / 31, True),
                                                   ("flip", 0.03, False), ("ssim", 0.5, None)])
def test_limits_are_of_the_worst_picture(error, value, allowed):
    assert Limit(error, value).allows(made_point(0, [[np.ones(3)]], (50.0, 30.0, 60.0))) is allowed


def test_identical_pictures_are_within_every_limit():
    assert Limit("psnr_db", 1000.0).allows(made_point(0, [[np.ones(3)]], (np.inf, np.inf)))


def test_an_unknown_axis_is_one_line():
    with pytest.raises(InputError, match="--per: no axis 'stepp'; did you mean step"):
        contests_of([made_point(0, [[np.ones(3)]])], ["stepp"], "median_ms", [])


def printed(capsys, *arguments):
    assert main([*arguments]) == 0
    return capsys.readouterr().out


def test_tables_of_an_experiment(experiment_folder, capsys):
    text = printed(capsys, "best", str(experiment_folder), "--format", "csv")
    rows = list(csv.DictReader(io.StringIO(text)))
    assert len([r for r in rows if r["rank"] == "best"]) == 4  # two scenes, surfaces and volumes
    full = list(csv.DictReader(io.StringIO(printed(capsys, "table", str(experiment_folder), "--format", "csv",
                                                   "--columns", "scene,technique,step,median_ms,psnr_db"))))
    for row in rows:
        same = next(r for r in full if all(r[k] == row[k] for k in ("scene", "technique", "step")))
        assert same["median_ms"] == row["median_ms"] and float(row["low_ms"]) <= float(row["median_ms"]) <= float(row["high_ms"])
    markdown = printed(capsys, "best", str(experiment_folder), "--min-psnr", "47")
    assert "| volume | dvr_temporal | nested_ellipsoids |" in markdown and "1 outside psnr_db at least 47" in markdown
    assert "No error was limited" not in markdown and "No error was limited" in printed(capsys, "best", str(experiment_folder))
    tex = printed(capsys, "best", str(experiment_folder), "--format", "tex", "--per", "scene,technique")
    assert tex.count(r"\begin{") == tex.count(r"\end{") and not re.search(r"(?<!\\)[_%&](?=\w)", tex.split("\\midrule")[1]
                                                                          .split("\\bottomrule")[0].replace(" & ", ""))


def test_hostile_labels_stay_text(hostile_folder, capsys):
    for command in ("best", "pareto"):
        rows = [line for line in printed(capsys, command, str(hostile_folder)).splitlines() if line.startswith("|")]
        assert len(rows) > 4 and len({len(re.findall(r"(?<!\\)\|", row)) for row in rows}) == 1


def test_ties_are_rows_of_their_own(fresh_folder, capsys):
    for path in fresh_folder.glob("runs/*/[!.]*/run.json"):
        document = json.loads(path.read_text())
        if document["labels"].get("step") == "0.5" and document["labels"]["technique"] == "iso_raymarch":
            frames = path.parent / "frames.csv"
            # The slower step at the times of the faster one.
            twin = next(p for p in fresh_folder.glob("runs/*/[!.]*/run.json") if json.loads(p.read_text())["labels"]
                        == {**document["labels"], "step": "1.0"} and json.loads(p.read_text())["replicate"]
                        == document["replicate"])
            frames.write_text((twin.parent / "frames.csv").read_text())
    rows = list(csv.DictReader(io.StringIO(printed(capsys, "best", str(fresh_folder), "--format", "csv"))))
    ties = [r for r in rows if r["rank"] == "tie"]
    assert len(ties) == 2 and {r["technique"] for r in ties} == {"iso_raymarch"}
    assert "tie: its bounds overlap" in printed(capsys, "best", str(fresh_folder))
