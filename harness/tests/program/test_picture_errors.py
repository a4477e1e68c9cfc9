"""The errors and layers of captured pictures, as other programs see them: scikit-image, OpenImageIO's idiff and
oiiotool, and FLIP written a second time (flip_numpy.py)."""

import json
import re
import shutil
import subprocess
import sys

import numpy
import pandas
import pytest
from conftest import SMALL, SOURCE, Volmark
from flip_numpy import hdr_flip, ldr_flip

from volmark_analysis.exr import read_channels, read_exr

sys.path.insert(0, str(SOURCE / "analysis" / "tests"))
from exr_writer import write_exr  # noqa: E402

BACKGROUND = [0.2, 0.5, 0.1]


@pytest.fixture(scope="module")
def experiment(tmp_path_factory):
    """Coarse steps, so that there are errors; light that is too bright for the second point of each technique."""
    volmark = Volmark(tmp_path_factory.mktemp("errors"))
    document = {
        "set": {**SMALL, "resolution": [80, 60], "stereo.enabled": True,
                "pictures": {"count": 2, "reference": "cpu", "background": BACKGROUND}},
        "blocks": [{"set": {"technique": {"name": name, "parameters": {"step": step}}, "shading.model": "phong"},
                    "axes": {"light": {"values": [{"label": "dim", "set": {}},
                                                  {"label": "bright", "set": {"light.color": [6, 5, 3]}}]}}}
                   for name, step in (("iso_raymarch", 4), ("dvr_raymarch", 3))]}
    result = volmark("run", volmark.scenario(document), "--results", volmark.results, "--validate")
    assert result.returncode == 0, result.stderr
    return volmark


def compared(experiment):
    """Every row of pictures with the two pictures it is about, linear over the background."""
    folder = experiment.results / "scenario"
    for run in experiment.runs().values():
        assert run["status"] == "completed", run["reason"]
        for row in run["pictures"]:
            pair = (read_exr(folder / "runs" / run["run"][:2] / run["run"] / row["file"]),
                    read_exr(folder / row["reference_file"]))
            yield row, *(over_background(pictures[row["view"]].color.astype(float)) for pictures in pair)


def over_background(color):
    return color[..., :3] + (1 - color[..., 3:]) * numpy.array(BACKGROUND)


def shown(linear):
    clamped = numpy.clip(linear, 0, 1)
    return numpy.where(clamped <= 0.0031308, 12.92 * clamped, 1.055 * clamped ** (1 / 2.4) - 0.055)


def test_mse_equals_numpy(experiment):
    for row, picture, reference in compared(experiment):
        mse = ((shown(picture) - shown(reference)) ** 2).mean()
        assert mse > 1e-7
        assert row["mse"] == pytest.approx(mse, rel=1e-9)
        assert row["psnr_db"] == pytest.approx(-10 * numpy.log10(mse), rel=1e-9)


def test_ssim_equals_scikit_image(experiment):
    metrics = pytest.importorskip("skimage.metrics")
    for row, picture, reference in compared(experiment):
        similarity = metrics.structural_similarity(
            shown(picture), shown(reference), gaussian_weights=True, sigma=1.5, use_sample_covariance=False,
            data_range=1, channel_axis=2)
        assert similarity < 0.9999
        assert row["ssim"] == pytest.approx(similarity, abs=1e-6)


def test_flip_equals_the_second_writing(experiment):
    for row, picture, reference in compared(experiment):
        flip = ldr_flip(numpy.clip(picture, 0, 1), numpy.clip(reference, 0, 1)).mean()
        assert flip > 0.001
        assert row["flip"] == pytest.approx(flip, abs=1e-5)


def test_hdr_flip_is_there_where_colours_exceed_one(experiment):
    seen = set()
    for row, picture, reference in compared(experiment):
        exceeds = max(picture.max(), reference.max()) > 1
        seen.add(exceeds)
        assert (row["flip_hdr"] is not None) == exceeds
        if exceeds:
            assert row["flip_hdr"] == pytest.approx(hdr_flip(picture, reference).mean(), abs=1e-5)
    assert seen == {False, True}


@pytest.mark.skipif(not shutil.which("idiff"), reason="idiff (openimageio-tools) is not installed")
def test_mse_and_psnr_equal_idiff(experiment, tmp_path):
    for row, picture, reference in compared(experiment):
        files = [tmp_path / "picture.exr", tmp_path / "reference.exr"]
        for file, linear in zip(files, (picture, reference)):
            write_exr(file, {name: shown(linear)[..., i].astype("<f4") for i, name in enumerate("RGB")})
        said = subprocess.run(["idiff", "-fail", "0", *files], capture_output=True, text=True).stdout
        rms = float(re.search(r"RMS error = (\S+)", said)[1])
        assert rms**2 == pytest.approx(row["mse"], rel=1e-4)
        psnr = float(re.search(r"Peak SNR = (\S+)", said)[1])
        assert psnr == pytest.approx(row["psnr_db"], abs=0.001)


def read_table(path):
    return pandas.read_csv(path, skiprows=1, float_precision="round_trip")


def test_tables_carry_the_errors(experiment):
    folder = experiment.results / "scenario"
    index = read_table(folder / "index.csv").set_index("run")
    for run in experiment.runs().values():
        rows = run["pictures"]
        table = read_table(folder / "runs" / run["run"][:2] / run["run"] / "pictures.csv")
        for name in ("mse", "ssim", "flip", "flip_hdr"):
            values = [numpy.nan if row[name] is None else row[name] for row in rows]
            numpy.testing.assert_array_equal(table[name], values)
        line = index.loc[run["run"]]
        assert line.ssim == min(row["ssim"] for row in rows) and line.flip == max(row["flip"] for row in rows)
        hdr = [row["flip_hdr"] for row in rows if row["flip_hdr"] is not None]
        assert (line.flip_hdr == max(hdr)) if hdr else numpy.isnan(line.flip_hdr)


def frame_files(experiment, technique):
    for run in experiment.runs().values():
        if run["technique"]["name"] == technique:
            folder = experiment.results / "scenario" / "runs" / run["run"][:2] / run["run"]
            for file in sorted({row["file"] for row in run["pictures"]}):
                yield folder, file


@pytest.mark.parametrize("technique", ["iso_raymarch", "dvr_raymarch"])
def test_steps_of_a_picture_add_up_to_its_counter(experiment, technique):
    for folder, file in frame_files(experiment, technique):
        channels, _ = read_channels(folder / file)
        counters = read_table(folder / "counters.csv").set_index("frame")
        frame = int(re.search(r"\d+", file)[0])
        steps = channels["steps"].astype(float).sum() + channels["right.steps"].astype(float).sum()
        assert steps == counters.samples[frame] > 0


def test_normals_are_there_where_the_surface_is(experiment):
    for folder, file in frame_files(experiment, "iso_raymarch"):
        channels, views = read_channels(folder / file)
        assert views == ["left", "right"]
        for view, prefix in (("left", ""), ("right", "right.")):
            normal = numpy.stack([channels[f"N.{view}.{axis}"] for axis in "XYZ"])
            hit = numpy.isfinite(channels[prefix + "Z"])
            numpy.testing.assert_allclose(numpy.linalg.norm(normal, axis=0), hit, atol=1e-5)
    for folder, file in frame_files(experiment, "dvr_raymarch"):
        assert not [name for name in read_channels(folder / file)[0] if name.startswith("N.")]


def test_render_writes_the_layers(volmark):
    for technique, layers in (("iso_raymarch", {"N.X", "N.Y", "N.Z", "steps"}), ("test_host_threads", {"steps"})):
        result = volmark("render", "--scene", "nested_ellipsoids", "--technique", technique, "--size", "32x32",
                         "-o", "a.exr")
        assert result.returncode == 0, result.stderr
        channels, _ = read_channels(volmark.folder / "a.exr")
        assert set(channels) == {"R", "G", "B", "A", "Z"} | layers
        assert channels["steps"].max() > 0


@pytest.mark.skipif(not shutil.which("oiiotool"), reason="oiiotool (openimageio-tools) is not installed")
def test_openimageio_reads_channels_views_attributes_and_pixels(experiment):
    folder, file = next(frame_files(experiment, "iso_raymarch"))
    channels, _ = read_channels(folder / file)
    said = subprocess.run(["oiiotool", "--info", "-v", folder / file], capture_output=True, text=True).stdout
    run = json.loads((folder / "run.json").read_text())["run"]
    assert f'volmark:run: "{run}"' in said or f'volmark.run: "{run}"' in said, said
    assert "volmark.format: 1" in said and "worldtocamera" in said.lower() and "right.worldToCamera" in said, said
    assert re.search(r'multiView: "?left.*right', said), said

    # OpenImageIO keeps the names, in an order of its own, and every number.
    names = re.search(r"channel list: (.*)", said)[1]
    names = [re.sub(r" \(.*\)", "", name).strip() for name in names.split(",")]
    assert set(names) == set(channels)
    dump = subprocess.run(["oiiotool", "--dumpdata", folder / file], capture_output=True, text=True).stdout
    pixels = {(int(x), int(y)): values.split() for x, y, values in re.findall(r"Pixel \((\d+), (\d+)\): (.*)", dump)}
    height, width = channels["R"].shape
    assert len(pixels) == width * height
    for y in range(height):
        for x in range(width):
            expected = [float(channels[name][y, x]) for name in names]
            assert [float(value) for value in pixels[x, y]] == pytest.approx(expected, rel=1e-5, abs=1e-6), (x, y)
