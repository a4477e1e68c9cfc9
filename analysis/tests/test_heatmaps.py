import numpy as np
import pytest
from matplotlib.colors import to_rgb
from volmark_analysis import heatmaps
from volmark_analysis.heatmaps import Shade, grid_of
from volmark_analysis.load import load_experiment
from volmark_analysis.points import point_results


@pytest.fixture
def results(experiment_folder):
    return point_results(load_experiment(experiment_folder))


def test_every_point_has_its_cell(results):
    grid = grid_of(results)
    cells = [cell for heat_map in grid.maps for cell in heat_map.cells.values()]
    assert len(cells) == len(results) and grid.maps_left_out == 0
    assert grid.column_axis == "step"  # the only axis of numbers
    done = [cell for cell in cells if cell.colors]
    assert len(done) == sum(r.completed != [] for r in results)
    assert all("dB" in cell.error for cell in done)  # no time without its error
    assert {cell.error for cell in cells if not cell.colors} == {"failed", "unsupported"}


def test_small_multiples_share_one_scale(results):
    grid = grid_of(results)
    cells = [cell for heat_map in grid.maps for cell in heat_map.cells.values() if cell.colors]
    by_time = sorted((float(cell.time), cell.colors[0][0]) for cell in cells)
    lightness = [np.dot(to_rgb(color), (0.2126, 0.7152, 0.0722)) for _, color in by_time]
    assert lightness == sorted(lightness)
    assert lightness[0] < 0.2 and lightness[-1] > 0.7


def test_ink_stands_out(results):
    def luminance(color):
        value = np.array(to_rgb(color))
        linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
        return linear @ (0.2126, 0.7152, 0.0722)

    shade = Shade("any", 0.0, 1.0, False, str)
    for value in np.linspace(0, 1, 101):
        ground, ink = map(luminance, heatmaps._colors(shade, float(value)))
        assert (max(ground, ink) + 0.05) / (min(ground, ink) + 0.05) > 4.5, value


def test_quantities_that_are_missing_have_no_colour(results):
    grid = grid_of(results)
    titles = [shade.title for shade in grid.shades]
    assert titles == ["frame time, ms", "lowest PSNR, dB", "lowest SSIM", "highest FLIP", "depth error p99.5, voxels"]
    temporal = next(cell for m in grid.maps for (row, _), cell in m.cells.items()
                    if "temporal" in (row + m.title) and cell.colors)
    assert [ground == "none" for ground, _ in temporal.colors] == [False, False, True, True, True]


def test_one_axis_is_no_grid(results):
    assert grid_of([r for r in results if r.technique == "iso_raymarch" and r.scene == "marschner_lobb"]) is None


def test_large_grids_are_cut_and_say_so(results, monkeypatch):
    whole = grid_of(results)
    monkeypatch.setattr(heatmaps, "MOST_CELLS", len(whole.maps[0].rows) * len(whole.maps[0].columns))
    grid = grid_of(results)
    assert len(grid.maps) == 1 and grid.maps_left_out == len(whole.maps) - 1


@pytest.mark.parametrize("logarithmic", [False, True])
def test_shades_run_from_end_to_end(logarithmic):
    shade = Shade("time", 2.0, 200.0, logarithmic, str)
    assert shade.place(2.0) == 0
    assert shade.place(200.0) == pytest.approx(1) and shade.place(float("inf")) == pytest.approx(1)
    assert shade.place(20.0) == pytest.approx(0.5 if logarithmic else 18 / 198)
    assert Shade("time", 3.0, 3.0, logarithmic, str).place(3.0) == 0.5
