"""fetch.py with a small project in place of the package's, and with the package's own where it is installed."""
import hashlib
import io
import json
import plistlib
import subprocess
import sys
import tarfile
from array import array
from pathlib import Path

import pytest

SCENES = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(SCENES))
import fetch  # noqa: E402

DIMS = (4, 3, 2)


def as_bytes(values):
    numbers = array("h", values)
    if sys.byteorder == "big":
        numbers.byteswap()
    return numbers.tobytes()


def value_at(x, y, z):
    return 100 * z + 10 * y + x


def stored_voxels():
    """As InVesalius keeps them: rows from back to front."""
    return as_bytes(value_at(x, DIMS[1] - 1 - y, z) for z in range(2) for y in range(3) for x in range(4))


def wanted_voxels():
    return as_bytes(value_at(x, y, z) for z in range(2) for y in range(3) for x in range(4))


def write_project(path, voxels=None, **changes):
    project = {
        "matrix": {"dtype": "int16", "filename": "matrix.dat", "shape": list(reversed(DIMS))},
        "spacing": [0.5, 0.25, 1.5],
        **changes,
    }
    members = {"main.plist": plistlib.dumps(project), "matrix.dat": stored_voxels() if voxels is None else voxels}
    with tarfile.open(path, "w:gz") as archive:
        for name, content in members.items():
            member = tarfile.TarInfo(f"folder/{name}")
            member.size = len(content)
            archive.addfile(member, io.BytesIO(content))
    return path


@pytest.fixture
def scenes(tmp_path, monkeypatch):
    folder = tmp_path / "scenes"
    folder.mkdir()
    source = {"package": "invesalius-examples", "sha512": hashlib.sha512(wanted_voxels()).hexdigest()}
    documents = {
        "head": {"title": "A head", "volume": {"file": "head.nrrd"}, "source": source},
        "tree": {"title": "A tree", "volume": {"file": "tree.nrrd"}, "source": {"url": "http://example.org/tree"}},
        "field": {"title": "A field", "volume": {"generator": {}}},
    }
    for name, document in documents.items():
        (folder / f"{name}.json").write_text(json.dumps(document))
    monkeypatch.setattr(fetch, "SCENES", folder)
    monkeypatch.setattr(fetch, "PACKAGE_FILES", {"invesalius-examples": write_project(tmp_path / "p.inv3")})
    monkeypatch.delenv("VOLMARK_DATA", raising=False)
    return folder


def fails(capsys, arguments, *parts):
    assert fetch.main(arguments) == 1
    output = capsys.readouterr()
    assert output.out == ""
    assert output.err.count("\n") == 1
    for part in ("fetch.py: ", *parts):
        assert part in output.err


def test_writes_the_volume_the_right_way_round(scenes, tmp_path, capsys):
    assert fetch.main(["head", "--to", str(tmp_path / "new" / "data")]) == 0
    assert "4 x 3 x 2 voxels of int16" in capsys.readouterr().out
    header, _, voxels = (tmp_path / "new" / "data" / "head.nrrd").read_bytes().partition(b"\n\n")
    lines = header.decode().splitlines()
    assert lines[0] == "NRRD0004"
    assert {"sizes: 4 3 2", "spacings: 0.5 0.25 1.5", "type: int16", "endian: little", "encoding: raw"} <= set(lines)
    assert voxels == wanted_voxels()
    assert [p.name for p in (tmp_path / "new" / "data").iterdir()] == ["head.nrrd"]


def test_leaves_a_whole_volume_and_mends_a_damaged_one(scenes, tmp_path, capsys):
    target = tmp_path / "head.nrrd"
    arguments = ["head", "--to", str(tmp_path)]
    assert fetch.main(arguments) == 0
    whole, before = target.read_bytes(), target.stat().st_mtime_ns
    assert fetch.main(arguments) == 0
    assert "is there already" in capsys.readouterr().out
    assert target.stat().st_mtime_ns == before
    target.write_bytes(whole[:-1])
    assert fetch.main(arguments) == 0
    assert target.read_bytes() == whole


def test_missing_package_names_the_way_out(scenes, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(fetch, "PACKAGE_FILES", {"invesalius-examples": tmp_path / "absent.inv3"})
    fails(capsys, ["head", "--to", str(tmp_path)], "absent.inv3 is missing", "invesalius-examples", "ci/bootstrap.sh")


@pytest.mark.parametrize(
    "voxels, changes, part",
    [
        (stored_voxels()[:-2], {}, "matrix.dat has 46 bytes, expected 48"),
        (stored_voxels() + b"xx", {}, "matrix.dat has 50 bytes, expected 48"),
        (bytes(48), {}, "SHA-512"),
        (None, {"matrix": {"dtype": "float64", "shape": [2, 3, 4]}}, "allowed: int16"),
        (None, {"matrix": {"dtype": "int16", "shape": [2, -3, -4]}}, "allowed: int16"),
        (None, {"matrix": {"dtype": "int16", "shape": [10**6, 10**6, 10**6]}}, "bytes of voxels, allowed"),
        (None, {"matrix": {"dtype": "int16", "shape": [2, 3]}}, "not an InVesalius project"),
        (None, {"spacing": "wide"}, "not an InVesalius project"),
        (None, {"matrix": {}}, "not an InVesalius project"),
    ],
)
def test_other_projects_are_refused_and_nothing_is_written(scenes, tmp_path, capsys, voxels, changes, part):
    project = write_project(tmp_path / "other.inv3", voxels, **changes)
    fails(capsys, ["head", "--to", str(tmp_path / "data"), "--from", str(project)], "other.inv3", part)
    assert not (tmp_path / "data").exists()


def test_damaged_archives_are_refused(scenes, tmp_path, capsys):
    whole = write_project(tmp_path / "whole.inv3").read_bytes()
    broken = tmp_path / "broken.inv3"
    for content in (b"", b"rubbish", whole[: len(whole) // 2]):
        broken.write_bytes(content)
        fails(capsys, ["head", "--to", str(tmp_path), "--from", str(broken)], "broken.inv3")


def test_names_what_there_is(scenes, tmp_path, capsys):
    fails(capsys, ["haed"], "did you mean head?")
    fails(capsys, ["xyz"], "allowed: field, head, tree")
    fails(capsys, ["tree"], "http://example.org/tree")
    assert fetch.main(["field"]) == 0
    assert "nothing to fetch" in capsys.readouterr().out


def test_list_shows_what_is_here(scenes, tmp_path, capsys):
    def states():
        assert fetch.main(["--list", "--to", str(tmp_path)]) == 0
        return [line.split("  ")[1].strip() for line in capsys.readouterr().out.splitlines()]

    assert states() == ["generated", "to fetch", "missing"]
    assert fetch.main(["head", "--to", str(tmp_path)]) == 0
    capsys.readouterr()
    assert states() == ["generated", "here", "missing"]


def test_usage_errors_exit_with_2():
    for arguments in ([], ["cranium_ct", "--list"], ["--unknown"]):
        result = subprocess.run([sys.executable, SCENES / "fetch.py", *arguments], capture_output=True, text=True)
        assert result.returncode == 2


@pytest.mark.skipif(
    not fetch.PACKAGE_FILES["invesalius-examples"].is_file(), reason="invesalius-examples is not installed"
)
def test_the_packages_head_has_the_scene_files_voxels(tmp_path):
    # Debian's own file against the scene file that is shipped.
    assert fetch.main(["cranium_ct", "--to", str(tmp_path)]) == 0
    assert (tmp_path / "cranium_ct.nrrd").stat().st_size > 256 * 256 * 108 * 2
