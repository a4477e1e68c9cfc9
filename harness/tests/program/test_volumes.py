"""volmark info, and volumes in the forms that users have."""
import gzip
import json
import struct

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
