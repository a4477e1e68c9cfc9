"""volmark info, and volumes in the forms that users have."""
import gzip
import json
import signal
import struct
import time

import pytest


def refused(volmark, *arguments):
    """What is said about bad input, in one line."""
    result = volmark(*arguments)
    assert result.returncode == 2 and result.stderr.strip().count("\n") == 0, result.stderr
    return result.stderr


@pytest.fixture
def itk(volmark):
    """Only for a program that was built with ITK."""
    (volmark.folder / "empty.nii").write_bytes(b"")
    if "built without it" in volmark("info", "./empty.nii").stderr:
        pytest.skip("built without ITK")


def write_nrrd(path, value, sizes=(6, 5, 4)):
    count = sizes[0] * sizes[1] * sizes[2]
    path.write_bytes(f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {sizes[0]} {sizes[1]} {sizes[2]}\n"
                     f"spacings: 1 1 2\nencoding: raw\n\n".encode()
                     + bytes((value + i) % 256 for i in range(count)))


def write_nifti(path, sizes=(6, 5, 4)):
    head = bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, *sizes, 1, 1, 1, 1)
    struct.pack_into("<hh", head, 70, 2, 8)
    struct.pack_into("<8f", head, 76, 1, 0.5, 0.5, 2, 1, 1, 1, 1)
    struct.pack_into("<f", head, 108, 352)
    head[344:348] = b"n+1\0"
    voxels = bytes(i % 256 for i in range(sizes[0] * sizes[1] * sizes[2]))
    path.write_bytes(gzip.compress(bytes(head) + voxels) if path.suffix == ".gz" else bytes(head) + voxels)


def test_info_tells_size_type_range_and_histogram(volmark):
    write_nrrd(volmark.folder / "a.nrrd", 0)
    text = volmark("info", "a.nrrd").stdout
    for part in ("6 x 5 x 4", "uint8", "1 x 1 x 2 mm", "0 to 119", "histogram"):
        assert part in text
    document = json.loads(volmark("info", "a.nrrd", "--json").stdout)
    assert document["volmark_info"] == 1 and document["dims"] == [6, 5, 4]
    assert sum(document["histogram"]) == 120 and document["mean"] == pytest.approx(59.5)


def test_info_takes_scenes(volmark):
    assert "float32" in volmark("info", "marschner_lobb").stdout


def test_nifti_is_drawn(volmark, itk):
    for name in ("a.nii", "b.nii.gz"):
        write_nifti(volmark.folder / name)
        result = volmark("render", "--volume", name, "--size", "16x16", "--reference", "-o", "out.exr")
        assert result.returncode == 0, result.stderr
    document = json.loads(volmark("info", "b.nii.gz", "--json").stdout)
    assert document["spacing_mm"] == [0.5, 0.5, 2]


def test_time_series_by_pattern_in_natural_order(volmark):
    for number in (1, 2, 10):
        write_nrrd(volmark.folder / f"step_{number}.nrrd", number)
    scene = {"volmark_scene": 1, "title": "steps", "volume": {"files": ["step_*.nrrd"]}}
    (volmark.folder / "steps.json").write_text(json.dumps(scene))
    document = json.loads(volmark("info", "./steps.json", "--json").stdout)
    assert document["time_steps"] == 3
    for number in (2, 10):  # the first that does not fit is named
        write_nrrd(volmark.folder / f"step_{number}.nrrd", number, sizes=(4, 5, 6))
    said = refused(volmark, "info", "./steps.json")
    assert "step_2.nrrd: its size" in said and "not those of step_1.nrrd" in said
    scene["volume"]["files"] = ["step_1.nrrd", "missing_*.nrrd"]
    (volmark.folder / "steps.json").write_text(json.dumps(scene))
    assert "there is no missing_*.nrrd" in refused(volmark, "info", "./steps.json")


@pytest.mark.parametrize("name, content, says", [
    ("a.nii", b"no nifti", "not NIfTI-1"),
    ("a.mha", b"NDims = 3\n", "no ElementDataFile"),
    ("a.vtk", b"# vtk\n", "not a legacy VTK file"),
    ("a.vti", b"<VTKFile>", 'ends in ".vti", allowed: .nrrd'),
])
def test_bad_files_are_one_line(volmark, itk, name, content, says):
    (volmark.folder / name).write_bytes(content)
    assert says in refused(volmark, "info", "./" + name)


def test_a_folder_without_dicom_is_one_line(volmark, itk):
    (volmark.folder / "series").mkdir()
    for name in ("./series", "series/", "series"):
        assert "series: there is no DICOM file" in refused(volmark, "info", name)


@pytest.mark.parametrize("name", ["./slice.dcm", "slice.dcm", "./slice", "slice"])
def test_a_single_dicom_file_names_the_folder_as_what_is_read(volmark, name):
    (volmark.folder / name).write_bytes(b"\0" * 128 + b"DICM")
    assert "a single DICOM file, allowed: the folder with its series" in refused(volmark, "info", name)


def test_a_file_needs_no_path_to_be_one(volmark):
    (volmark.folder / "a.vti").write_bytes(b"<VTKFile>")
    assert 'ends in ".vti", allowed: .nrrd' in refused(volmark, "info", "a.vti")
    assert "unknown scene" in refused(volmark, "info", "b.vti")


@pytest.mark.parametrize("name", ["two\nlines", "red\x1b[31m", "back\rto the start"])
def test_names_stay_in_their_line(volmark, name):
    """Of a file, and in a header that somebody else wrote."""
    (volmark.folder / (name + ".nrrd")).write_bytes(b"")
    (volmark.folder / "a.nrrd").write_bytes(b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 1 1\nencoding: raw\n"
                                            b"data file: " + name.replace("\n", "\f").encode() + b"\n")
    for file in (name + ".nrrd", "a.nrrd"):
        said = refused(volmark, "info", "./" + file)
        assert said.rstrip("\n").isprintable() and name[:3] in said


@pytest.mark.parametrize("gib", ["-1", "0", "nan", "inf", "1e300"])
def test_the_limit_is_a_size(volmark, gib):
    write_nrrd(volmark.folder / "a.nrrd", 0)
    assert "--max-volume-gib" in refused(volmark, "info", "a.nrrd", "--max-volume-gib", gib)
    assert "--max-volume-gib" in refused(volmark, "render", "--volume", "a.nrrd", "-o", "a.exr", "--max-volume-gib", gib)


@pytest.mark.parametrize("signal_number", [signal.SIGINT, signal.SIGTERM])
def test_commands_end_when_they_are_told_to(volmark, signal_number):
    """All but `run` (test_grid.py) have nothing to put in order."""
    process = volmark.start("render", "--scene", "marschner_lobb", "--reference", "--size", "4096x4096", "-o", "a.exr")
    time.sleep(0.5)
    process.send_signal(signal_number)
    assert process.wait(timeout=20) == -signal_number
