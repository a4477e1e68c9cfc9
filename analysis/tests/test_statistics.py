import math

import numpy as np
import pytest
import synthetic
from volmark_analysis.load import load_experiment
from volmark_analysis.plots import figure_of, plots_of, styles_of
from volmark_analysis.points import groups_of, point_results, ratio_of
from volmark_analysis.statistics import (RESAMPLES, draw_processes, mean_interval, paired_ratio, resampling_weights,
                                         statistics_of)

RNG = np.random.default_rng(11)


@pytest.mark.parametrize("count", [1, 2, 99, 100, 101, 299, 1000])
def test_equal_to_plain_formulas(count):
    times = list(RNG.lognormal(2, 0.5, count))
    ours, plain = statistics_of(times), synthetic.plain_statistics(times)
    assert ours.keys() == plain.keys()
    for name in plain:
        assert ours[name] == pytest.approx(plain[name], rel=1e-12), name


def test_low1_by_hand():
    times = [1.0] * 198 + [51.0, 101.0]  # total 350, 1 % is 3.5: the slowest frame alone covers it
    statistics = statistics_of(times)
    assert statistics["low1_avg_ms"] == 76.0
    assert statistics["low1_integral_ms"] == 101.0


def test_run_json_statistics_follow_from_frames_csv(experiment_folder):
    runs = [r for r in load_experiment(experiment_folder).runs if r.completed]
    assert len(runs) > 10
    for run in runs:
        for name, column in (("frame", "frame_ms"), ("host", "host_ms"), ("cpu", "cpu_ms"), ("draw", "draw_ms")):
            for key, value in statistics_of(run.headline[column].to_numpy()).items():
                assert run.statistics[name][key] == pytest.approx(value, rel=1e-9), (name, key)


def test_scaling_times_scales_statistics():
    times = RNG.lognormal(1, 0.3, 500)
    one, three = statistics_of(times), statistics_of(3 * times)
    for name in one.keys() - {"count", "fps"}:
        assert three[name] == pytest.approx(3 * one[name])
    assert three["fps"] == pytest.approx(one["fps"] / 3)


def test_weights_of_every_resample_add_up_to_one():
    weights = resampling_weights([3, 1, 4, 2, 5], np.random.default_rng(1))
    assert weights.shape == (RESAMPLES, 15)
    assert np.allclose(weights.sum(axis=1), 1)
    # On average every process counts the same, whatever its number of orbits.
    assert weights.mean(axis=0)[:3].sum() == pytest.approx(0.2, abs=0.02)
    assert weights.mean(axis=0)[3] == pytest.approx(0.2, abs=0.02)


def test_drawn_processes_are_shared_when_asked():
    rng = np.random.default_rng(1)
    drawn = draw_processes(5, rng)
    a, b = resampling_weights([2] * 5, rng, drawn), resampling_weights([3] * 5, rng, drawn)
    for process in range(5):
        assert np.allclose(a[:, 2 * process:2 * process + 2].sum(1), b[:, 3 * process:3 * process + 3].sum(1))


def made_processes(center, processes, spread=0.05, orbits=3, poses=30):
    wave = 1 + 0.3 * np.sin(np.linspace(0, 6, poses))
    return [center * wave * math.exp(RNG.normal(0, spread)) * np.exp(RNG.normal(0, 0.01, (orbits, poses)))
            for _ in range(processes)]


def test_mean_interval_needs_five_processes():
    assert mean_interval([list(p) for p in made_processes(10, 4)]) is None
    assert mean_interval([list(p) for p in made_processes(10, 5)]) is not None


def test_mean_interval_covers_the_true_mean():
    """Nominal 95 %; percentile intervals of ten processes cover a little less."""
    wave = (1 + 0.3 * np.sin(np.linspace(0, 6, 30))).mean()
    truth = 10 * wave * math.exp(0.05**2 / 2)
    hits = 0
    for _ in range(100):
        low, high = mean_interval([list(p) for p in made_processes(10, 10)])
        hits += low <= truth <= high
    assert 80 <= hits <= 100


def test_interval_shrinks_with_more_processes():
    def width(n):
        return np.mean([np.ptp(mean_interval([list(p) for p in made_processes(10, n)])) for _ in range(10)])
    assert width(40) < 0.6 * width(6)


def test_a_known_ratio_is_found():
    a, b = made_processes(20, 6, 0.02), made_processes(10, 6, 0.02)
    ratio = paired_ratio(a, b, same_processes=False)
    assert ratio.median == pytest.approx(2, rel=0.05)
    assert ratio.interval[0] < ratio.median < ratio.interval[1] and ratio.clear
    assert ratio.pose_low <= ratio.median <= ratio.pose_high


def test_pairing_removes_what_processes_share():
    drift = [math.exp(RNG.normal(0, 0.3)) for _ in range(6)]
    base = [p / p.mean() for p in made_processes(1, 6, 0)]
    a, b = [20 * d * p for d, p in zip(drift, base)], [10 * d * p[:, :] for d, p in zip(drift, base)]
    together, apart = paired_ratio(a, b, same_processes=True), paired_ratio(a, b, same_processes=False)
    assert np.ptp(together.interval) < 0.1 * np.ptp(apart.interval)


def test_inverse_swaps_everything():
    ratio = paired_ratio(made_processes(20, 5), made_processes(10, 5), same_processes=False)
    back = ratio.inverse()
    assert back.median == pytest.approx(1 / ratio.median)
    assert back.interval == pytest.approx((1 / ratio.interval[1], 1 / ratio.interval[0]))
    assert back.pose_low == pytest.approx(1 / ratio.pose_high)
    swapped = paired_ratio([1 / x for x in [np.ones((1, 3)) * 2]], [np.ones((1, 3))], False)
    assert swapped.median == pytest.approx(0.5) and swapped.interval is None


def test_equal_times_are_not_a_clear_difference():
    ratio = paired_ratio(made_processes(10, 8), made_processes(10, 8), same_processes=True)
    assert not ratio.clear


def test_groups_and_ratios_of_an_experiment(experiment_folder):
    results = point_results(load_experiment(experiment_folder))
    assert [len(g) for g in groups_of(results)] == [5, 5]
    iso, dvr = results[0], results[2]
    assert (iso.technique, dvr.technique) == ("iso_raymarch", "dvr_raymarch")
    ratio = ratio_of(iso, dvr)
    assert ratio.paired and ratio.processes == 5 and ratio.interval
    assert ratio.median == pytest.approx(9 / 17, rel=0.08)  # what the times were made from
    assert ratio_of(dvr, iso).median == pytest.approx(1 / ratio.median)


def test_timed_pacing_is_not_paired_but_plotted(experiment_folder):
    results = point_results(load_experiment(experiment_folder))
    iso, dvr = results[0], results[2]
    for run in iso.completed:
        run.frames.loc[run.frames.orbit_kind == "headline", "phase"] += 0.0137 * run.frames.orbit
    ratio = ratio_of(iso, dvr)
    assert not ratio.paired and ratio.interval is None
    assert ratio.median == pytest.approx(iso.statistics["mean_ms"] / dvr.statistics["mean_ms"])
    for plot in plots_of([iso, dvr]):
        if plot.name == "orbit":
            figure = figure_of(plot, plot.panels, styles_of([iso, dvr]))
            assert len(figure.axes[0].lines[0].get_xdata()) == 3 * 24
