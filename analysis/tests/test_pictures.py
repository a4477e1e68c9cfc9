import io

import numpy as np
import pytest
import synthetic
from exr_writer import write_exr
from PIL import Image
from volmark_analysis import pictures
from volmark_analysis.errors import InputError
from volmark_analysis.load import load_experiment
from volmark_analysis.points import point_results


@pytest.fixture(scope="module")
def experiment(experiment_folder):
    return load_experiment(experiment_folder)


def test_error_maps_agree_with_the_metric(experiment):
    """The mean square of what is drawn is the MSE that the run reports (up to half floats)."""
    for result in point_results(experiment):
        for run in result.completed[:1]:
            for row in run.pictures:
                mine = pictures._view(run.folder / row["file"], 0)
                truth = pictures._view(experiment.folder / row["reference_file"], 0)
                error = pictures.color_error(mine.color, truth.color, pictures.background_of(run))
                assert np.mean(error**2) == pytest.approx(row["mse"], rel=0.02)


def test_background_shows_through(experiment):
    run = next(r for r in experiment.runs if r.completed)
    assert pictures.background_of(run) == pytest.approx(synthetic.BACKGROUND)
    shown = pictures.captured_frames(experiment, run)[0]
    expected = np.rint(255 * synthetic.encoded(np.zeros((1, 1, 4))))[0, 0]
    assert (shown.frame[0, 0] == expected).all()


def test_missed_and_spurious_pixels_have_their_colours(experiment):
    run = next(r for r in experiment.runs if r.completed and r.technique["draws"] == "isosurface")
    shown = pictures.captured_frames(experiment, run)[0]
    assert tuple(shown.depth[synthetic.HEIGHT // 2, 24]) == pictures.MISSED
    assert tuple(shown.depth[2, 2]) == pictures.SPURIOUS
    assert tuple(shown.depth[0, 0]) == pictures.NOTHING
    small = pictures.captured_frames(experiment, run, widest=30)[0]
    assert (small.depth == pictures.MISSED).all(axis=-1).sum() == 1  # survives shrinking


def test_volumes_have_no_depth_error(experiment):
    run = next(r for r in experiment.runs if r.completed and r.technique["draws"] == "volume")
    assert all(s.depth is None and s.error is not None for s in pictures.captured_frames(experiment, run))


def test_iterations_keep_their_mean_and_share_a_scale(experiment):
    run = next(r for r in experiment.runs if r.completed and r.technique["name"] == "dvr_raymarch")
    whole, small = (pictures.captured_frames(experiment, run, widest)[0].steps for widest in (None, 48))
    assert whole.shape == (synthetic.HEIGHT, synthetic.WIDTH) and small.mean() == pytest.approx(whole.mean())
    bar = pictures.scale_bar("steps")[0]
    drawn = pictures.steps_map(np.array([[0.0, 0.5 * whole.max(), whole.max()]]), whole.max())[0]
    assert (drawn[0] == bar[0]).all() and (drawn[2] == bar[-1]).all() and (drawn[1] == bar[128]).all()
    other = next(r for r in experiment.runs if r.completed and r.technique["draws"] == "isosurface")
    assert pictures.captured_frames(experiment, other)[0].steps is None


@pytest.mark.parametrize("widest", [96, 95, 40, 1])
def test_shrunk_pictures_fit(experiment, widest):
    run = next(r for r in experiment.runs if r.completed)
    shown = pictures.captured_frames(experiment, run, widest)[0]
    assert shown.frame.shape == shown.reference.shape == shown.error.shape
    assert shown.frame.shape[1] <= widest


def test_shrinking_keeps_mean_light_and_worst_error():
    values = np.random.default_rng(1).random((6, 9))
    assert pictures._shrunk(values, 3).mean() == pytest.approx(values.mean())
    assert pictures._worst(values, 3).max() == values.max()


def test_maps_are_monotone_in_lightness():
    for kind in ("error", "depth", "steps"):
        lightness = pictures.scale_bar(kind)[0] @ np.array([0.2126, 0.7152, 0.0722])
        assert (np.diff(lightness) >= -1.0).all() and lightness[-1] - lightness[0] > 150


def test_zero_error_is_the_lowest_colour():
    lowest = pictures.scale_bar("error")[0, 0]
    assert (pictures.map_colors(np.zeros((1, 1)), pictures.COLOR_ERROR_RANGE, "magma")[0, 0] == lowest).all()


def test_srgb_reference_values():
    assert pictures.to_display(np.array([0.0, 0.5, 1.0, 7.0, np.nan])).tolist() == [0, 188, 255, 255, 0]


def test_png_round_trip():
    pixels = np.random.default_rng(2).integers(0, 256, (5, 7, 3), np.uint8)
    assert (np.array(Image.open(io.BytesIO(pictures.png_of(pixels)))) == pixels).all()


def test_sizes_must_agree(fresh_folder):
    experiment = load_experiment(fresh_folder)
    run = next(r for r in experiment.runs if r.completed)
    color = np.zeros((8, 8, 4), np.float32)
    synthetic.write_layers(experiment.folder / run.pictures[0]["reference_file"], color, None)
    with pytest.raises(InputError, match="found 8 x 8 pixels, expected 96 x 72"):
        pictures.captured_frames(experiment, run)


def test_stereo_rows_take_their_own_view(fresh_folder):
    experiment = load_experiment(fresh_folder)
    run = next(r for r in experiment.runs if r.completed and r.technique["draws"] == "volume")
    left, right = (synthetic.sphere("marschner_lobb", phase, 0.0, False)[0] for phase in (0.0, 0.4))
    channels = {prefix + n: np.ascontiguousarray(color[..., i]).astype("<f2")
                for prefix, color in (("", left), ("right.", right)) for i, n in enumerate("RGBA")}
    for path in (run.folder / run.pictures[0]["file"], experiment.folder / run.pictures[0]["reference_file"]):
        write_exr(path, channels, views=["left", "right"])
    run.pictures[1:] = [{**run.pictures[0], "view": 1}]
    first, second = pictures.captured_frames(experiment, run)
    assert (first.frame != second.frame).any() and (first.error == first.error[0, 0]).all()
    assert (second.frame == pictures.to_display(pictures.over(right, pictures.background_of(run)))).mean() > 0.95
    run.pictures[1]["view"] = 2
    with pytest.raises(InputError, match="no view 2, found 2"):
        pictures.captured_frames(experiment, run)
