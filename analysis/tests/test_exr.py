import struct

import numpy as np
import pytest
from exr_writer import write_exr
from volmark_analysis.errors import InputError
from volmark_analysis.exr import read_channels, read_exr

RNG = np.random.default_rng(3)


def channels(height, width, noisy):
    """Half, float and uint channels; smooth ones compress, noisy ones are stored as they are."""
    y, x = np.mgrid[0:height, 0:width]
    value = RNG.random((height, width)) if noisy else (x + 2 * y) / (width + 2 * height)
    made = {n: (value * s).astype("<f2") for n, s in zip("RGBA", (1, 0.5, 0.25, 1))}
    made["Z"] = np.where(x > y, 10 * value, np.inf).astype("<f4")
    made["id"] = (x * 7 + y).astype("<u4")
    return made


@pytest.mark.parametrize("compression", ["none", "zips", "zip"])
@pytest.mark.parametrize("noisy", [False, True])
@pytest.mark.parametrize("size", [(1, 1), (16, 5), (17, 3), (37, 23)])
@pytest.mark.parametrize("decreasing", [False, True])
def test_every_channel_comes_back_bit_by_bit(tmp_path, compression, noisy, size, decreasing):
    written = channels(*size, noisy)
    write_exr(tmp_path / "a.exr", written, compression, corner=(-3, 11), decreasing=decreasing)
    read, views = read_channels(tmp_path / "a.exr")
    assert views == [""] and set(read) == set(written)
    for name in written:
        assert read[name].tobytes() == written[name].tobytes()


def test_picture_layers(tmp_path):
    written = channels(4, 6, False)
    write_exr(tmp_path / "a.exr", written)
    (picture,) = read_exr(tmp_path / "a.exr")
    assert picture.color.dtype == np.float32
    assert np.array_equal(picture.color[..., 1], written["G"].astype(np.float32))
    assert np.array_equal(picture.distance, written["Z"])


@pytest.mark.parametrize("second_view", ["right.{}", "N.right.{}"])
def test_steps_and_normals(tmp_path, second_view):
    """In a further view a layer's name comes as volmark writes it or as OpenEXR does."""
    left, more = channels(4, 6, False), {}
    for i, name in enumerate(("steps", "N.X", "N.Y", "N.Z")):
        left[name] = RNG.random((4, 6)).astype("<f4")
        more[second_view.format(name[2:]) if name != "steps" and second_view.startswith("N") else f"right.{name}"] = \
            left[name] + 1
    write_exr(tmp_path / "a.exr", left | more | {f"right.{n}": left[n] for n in "RGB"}, views=["left", "right"])
    first, second = read_exr(tmp_path / "a.exr")
    assert np.array_equal(first.steps, left["steps"]) and np.array_equal(second.steps, left["steps"] + 1)
    for i, axis in enumerate("XYZ"):
        assert np.array_equal(first.normal[..., i], left[f"N.{axis}"])
        assert np.array_equal(second.normal[..., i], left[f"N.{axis}"] + 1)


def test_normals_need_all_three_components(tmp_path):
    write_exr(tmp_path / "a.exr", channels(4, 6, False) | {"N.X": np.zeros((4, 6), "<f4")})
    (picture,) = read_exr(tmp_path / "a.exr")
    assert picture.normal is None and picture.steps is None


def test_no_depth_and_no_alpha(tmp_path):
    written = {n: a for n, a in channels(4, 6, False).items() if n in "RGB"}
    write_exr(tmp_path / "a.exr", written)
    (picture,) = read_exr(tmp_path / "a.exr")
    assert picture.distance is None and (picture.color[..., 3] == 1).all()


def test_multi_view_has_the_default_view_first(tmp_path):
    left, right = channels(4, 6, False), channels(4, 6, True)
    write_exr(tmp_path / "a.exr", left | {f"right.{n}": a for n, a in right.items()}, views=["left", "right"])
    pictures = read_exr(tmp_path / "a.exr")
    assert len(pictures) == 2
    assert np.array_equal(pictures[0].color[..., 0], left["R"].astype(np.float32))
    assert np.array_equal(pictures[1].color[..., 0], right["R"].astype(np.float32))
    assert np.array_equal(pictures[1].distance, right["Z"])


def test_files_written_by_openexr():
    """tests/data: made with libOpenEXR 3.1; R = x + y/16, G = -x, B = x*y, A = 1, Z = 100 + x - y."""
    from pathlib import Path
    folder = Path(__file__).parent / "data"
    y, x = np.mgrid[0:37, 0:21].astype(np.float32)
    for name in ("none", "zips", "zip"):
        (picture,) = read_exr(folder / f"openexr_{name}.exr")
        assert np.array_equal(picture.color, np.stack([x + y / 16, -x, x * y, np.ones_like(x)], axis=-1))
        assert np.array_equal(picture.distance, 100 + x - y)
    left, right = read_exr(folder / "openexr_multiview.exr")
    assert np.array_equal(left.color[..., 0], x + y / 16) and np.array_equal(right.color[..., 0], 2 * x)


def corrupt(path, change):
    data = bytearray(path.read_bytes())
    change(data)
    path.write_bytes(data)


@pytest.mark.parametrize("change, text", [
    (lambda d: d.__setitem__(slice(0, 4), b"abcd"), "not an OpenEXR file"),
    (lambda d: d.__setitem__(slice(4, 8), struct.pack("<I", 2 | 0x200)), "tiled"),
    (lambda d: d.__setitem__(slice(4, 8), struct.pack("<I", 2 | 0x1000)), "multi-part"),
    (lambda d: d.__setitem__(d.index(b"\0compression\0\x01") + 17, 4), "compression piz"),
    (lambda d: d.__delitem__(slice(-9, None)), "damaged"),
    (lambda d: d.__delitem__(slice(40, None)), "damaged"),
    (lambda d: d.clear(), "damaged"),
])
def test_unreadable_files_give_one_line(tmp_path, change, text):
    path = tmp_path / "bad.exr"
    write_exr(path, channels(20, 9, False))
    corrupt(path, change)
    with pytest.raises(InputError) as caught:
        read_exr(path)
    assert text in str(caught.value) and str(path) in str(caught.value) and "\n" not in str(caught.value)


def test_missing_file(tmp_path):
    with pytest.raises(InputError, match="No such file"):
        read_exr(tmp_path / "none.exr")
