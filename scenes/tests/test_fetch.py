"""fetch.py without a network: packages, projects of InVesalius, folders, lists, bad input."""
import gzip
import hashlib
import io
import os
import plistlib
import struct
import subprocess
import sys
import tarfile
from array import array
from pathlib import Path

import pytest
from conftest import BODY, DIMS, SCENES

import fetch
from fetching.scene import read_scenes

HEAD_DIMS = (4, 3, 2)
TREE = {"sha512": hashlib.sha512(BODY).hexdigest(), "url": "http://127.0.0.1:1/far/tree_40x30x50_uint8.raw",
        "raw": {"dims": DIMS, "type": "uint8", "spacing_mm": [1, 1, 1]}}


def as_bytes(values):
    numbers = array("h", values)
    if sys.byteorder == "big":
        numbers.byteswap()
    return numbers.tobytes()


def value_at(x, y, z):
    return 100 * z + 10 * y + x


def stored_voxels():
    """As InVesalius keeps them: rows from back to front."""
    return as_bytes(value_at(x, HEAD_DIMS[1] - 1 - y, z) for z in range(2) for y in range(3) for x in range(4))


def wanted_voxels():
    return as_bytes(value_at(x, y, z) for z in range(2) for y in range(3) for x in range(4))


def write_project(path, voxels=None, **changes):
    project = {
        "matrix": {"dtype": "int16", "filename": "matrix.dat", "shape": list(reversed(HEAD_DIMS))},
        "spacing": [0.5, 0.25, 1.5],
        **changes,
    }
    members = {"main.plist": plistlib.dumps(project), "matrix.dat": stored_voxels() if voxels is None else voxels}
    path.parent.mkdir(parents=True, exist_ok=True)
    with tarfile.open(path, "w:gz") as archive:
        for name, content in members.items():
            member = tarfile.TarInfo(f"folder/{name}")
            member.size = len(content)
            archive.addfile(member, io.BytesIO(content))
    return path


def nrrd(voxels=BODY, encoding="raw", more=""):
    """NRRD volume of the scene `tree`."""
    body = gzip.compress(voxels, mtime=0) if encoding == "gzip" else voxels
    return f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 40 30 50\nencoding: {encoding}\n{more}\n".encode() + body


def nifti(voxels, offset=352):
    header = bytearray(offset)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<f", header, 108, offset)
    return gzip.compress(bytes(header) + voxels, mtime=0)


@pytest.fixture
def project(tmp_path, add_scene):
    """The scene `head` in a package whose file lies in a folder of its own."""
    path = write_project(tmp_path / "package" / "Head.inv3")
    add_scene("head", package="some-package", package_file=str(path), license="GPL-2",
              sha512=hashlib.sha512(wanted_voxels()).hexdigest())
    return path


def fails(result, *parts, code=1):
    found, output, errors = result
    assert found == code and output == "" and errors.count("\n") == 1, errors
    for part in ("fetch.py: ", *parts):
        assert part in errors


def is_empty(folder):
    return not folder.exists() or not list(folder.iterdir())


def test_a_project_is_written_the_right_way_round(run, project, data):
    code, output, _ = run("head")
    assert code == 0 and str(data / "head.nrrd") in output
    header, _, voxels = (data / "head.nrrd").read_bytes().partition(b"\n\n")
    lines = header.decode().splitlines()
    assert lines[0] == "NRRD0004"
    assert {"sizes: 4 3 2", "spacings: 0.5 0.25 1.5", "type: int16", "endian: little", "encoding: raw"} <= set(lines)
    assert voxels == wanted_voxels()
    assert [path.name for path in data.iterdir()] == ["head.nrrd"]


def test_a_whole_volume_is_left_and_a_damaged_one_mended(run, project, data):
    target = data / "head.nrrd"
    assert run("head")[0] == 0
    whole, before = target.read_bytes(), target.stat().st_mtime_ns
    code, output, _ = run("head")
    assert code == 0 and "is there already" in output and target.stat().st_mtime_ns == before
    target.write_bytes(whole[:-1])
    assert run("head")[0] == 0
    assert target.read_bytes() == whole


@pytest.mark.parametrize(
    "voxels, changes, part",
    [
        (stored_voxels()[:-2], {}, "matrix.dat has 46 bytes, expected 48"),
        (stored_voxels() + b"xx", {}, "matrix.dat has 50 bytes, expected 48"),
        (bytes(48), {}, "SHA-512"),
        (None, {"matrix": {"dtype": "float64", "shape": [2, 3, 4]}}, "allowed: int16"),
        (None, {"matrix": {"dtype": "uint8", "shape": [2, 3, 4]}}, "allowed: int16"),
        (None, {"matrix": {"dtype": "int16", "shape": [2, -3, -4]}}, "allowed: int16"),
        (None, {"matrix": {"dtype": "int16", "shape": [10**6, 10**6, 10**6]}}, "bytes of voxels, allowed"),
        (None, {"matrix": {"dtype": "int16", "shape": [2, 3]}}, "not an InVesalius project"),
        (None, {"spacing": "wide"}, "not an InVesalius project"),
        (None, {"matrix": {}}, "not an InVesalius project"),
    ],
)
def test_other_projects_are_refused_and_nothing_is_written(run, project, data, voxels, changes, part):
    write_project(project, voxels, **changes)
    code, output, errors = run("head")
    assert code == 1 and output == "" and "Head.inv3" in errors and part in errors
    assert is_empty(data)


def test_damaged_archives_are_refused(run, project, data):
    whole = project.read_bytes()
    for content in (b"", b"rubbish", whole[: len(whole) // 2]):
        project.write_bytes(content)
        fails(run("head"), "Head.inv3")
        assert is_empty(data)


# --- Debian packages -------------------------------------------------------------------------------------------


@pytest.fixture
def archive(tmp_path, monkeypatch):
    """An apt-get that, as the real one, downloads the package into the folder it is called in."""
    root, tools = tmp_path / "root", tmp_path / "tools"
    (root / "DEBIAN").mkdir(parents=True)
    control = "Package: some-package\nVersion: 1\nArchitecture: all\nMaintainer: a <a@b.invalid>\nDescription: a\n"
    (root / "DEBIAN" / "control").write_text(control)
    (root / "opt").mkdir()
    (root / "opt" / "brain.nii.gz").write_bytes(nifti(BODY))
    tools.mkdir()
    subprocess.run(["dpkg-deb", "-b", root, tools / "some-package.deb"], check=True, capture_output=True)
    script = tools / "apt-get"
    script.write_text(f'#!/bin/sh\n[ "$1 $2" = "download some-package" ] || {{ echo "E: no $2" >&2; exit 100; }}\n'
                      f"cp {tools}/some-package.deb ./some-package_1_all.deb\n")
    script.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tools}:{os.environ['PATH']}")
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    return tools


def brain(add_scene, package="some-package", package_file="/opt/brain.nii.gz"):
    add_scene("brain", {"file": "brain.nii.gz"}, package=package, package_file=package_file, sha512=TREE["sha512"])


def test_a_package_that_is_not_installed_is_unpacked_aside(run, add_scene, archive, data, tmp_path):
    brain(add_scene)
    assert run("brain")[0] == 0
    assert (data / "brain.nii.gz").read_bytes() == nifti(BODY) and not Path("/opt/brain.nii.gz").exists()
    assert not list(tmp_path.glob("volmark_fetch_*")), "nothing stays of the package"


def test_an_installed_file_needs_no_apt(run, add_scene, data, tmp_path, monkeypatch):
    (tmp_path / "brain.nii.gz").write_bytes(nifti(BODY))
    brain(add_scene, package_file=str(tmp_path / "brain.nii.gz"))
    monkeypatch.setenv("PATH", "/nowhere")
    assert run("brain")[0] == 0 and (data / "brain.nii.gz").is_file()


def test_packages_that_cannot_be_had_name_the_way_out(run, add_scene, archive, data, monkeypatch):
    brain(add_scene, package="other-package")
    code, _, errors = run("brain")
    assert code == 1 and "E: no other-package: install the Debian package other-package" in errors
    brain(add_scene, package_file="/opt/other.nii.gz")
    assert "the Debian package some-package has no /opt/other.nii.gz" in run("brain")[2]
    monkeypatch.setenv("PATH", "/nowhere")
    fails(run("brain"), "/opt/other.nii.gz is missing: install the Debian package some-package (ci/bootstrap.sh does)")
    assert is_empty(data)


@pytest.fixture
def mesh(tmp_path, add_scene):
    """The scene `mesh`, whose text is one file in an archive that a package installs. Returns the text."""
    text = b"OFF\n0 0 0\n"
    with tarfile.open(tmp_path / "data.tar.gz", "w:gz") as archive:
        member = tarfile.TarInfo("data/a.off")
        member.size = len(text)
        archive.addfile(member, io.BytesIO(text))
    add_scene("mesh", {"mesh": {"file": "a.off"}}, package="some-package", package_file=str(tmp_path / "data.tar.gz"),
              package_member="data/a.off", sha512=hashlib.sha512(text).hexdigest())
    return text


def test_a_file_in_a_packages_archive_is_taken_and_checked(run, mesh, data):
    assert run("mesh")[0] == 0 and (data / "a.off").read_bytes() == mesh
    (data / "a.off").write_bytes(mesh + b"#")
    assert states(run)["mesh"] == "wrong"
    assert run("mesh")[0] == 0 and (data / "a.off").read_bytes() == mesh


def test_a_missing_or_cut_archive_is_refused(run, mesh, data, tmp_path):
    whole = (tmp_path / "data.tar.gz").read_bytes()
    for damaged in (whole[:20], b"no archive"):
        (tmp_path / "data.tar.gz").write_bytes(damaged)
        fails(run("mesh"), "data.tar.gz: there is no file data/a.off in it")
        assert is_empty(data)


# --- Folders ----------------------------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "folder").mkdir()
    return tmp_path / "folder"


def test_from_takes_the_sources_file_or_the_volumes_own(run, add_scene, folder, data):
    add_scene("tree", **TREE)
    (folder / "tree_40x30x50_uint8.raw").write_bytes(BODY)
    assert run("tree", "--from", folder)[0] == 0
    assert (data / "tree.nrrd").read_bytes().partition(b"\n\n")[2] == BODY
    (data / "tree.nrrd").unlink()
    (folder / "tree.nrrd").write_bytes(nrrd(encoding="gzip"))
    assert run("tree", "--from", folder)[0] == 0
    assert (data / "tree.nrrd").read_bytes() == nrrd(encoding="gzip")


def test_from_takes_a_packages_file(run, project, data):
    assert run("head", "--from", project.parent)[0] == 0 and (data / "head.nrrd").is_file()


def test_from_refuses_other_voxels_and_leaves_nothing(run, add_scene, folder, data):
    add_scene("tree", **TREE)
    fails(run("tree", "--from", folder), str(folder), "none of tree.nrrd, tree_40x30x50_uint8.raw")
    (folder / "tree_40x30x50_uint8.raw").write_bytes(BODY[:-1])
    fails(run("tree", "--from", folder), f"found {len(BODY) - 1} bytes, expected {len(BODY)}")
    (folder / "tree_40x30x50_uint8.raw").write_bytes(bytes(len(BODY)))
    assert "SHA-512" in run("tree", "--from", folder)[2]
    (folder / "tree.nrrd").write_bytes(nrrd(encoding="gzip")[:-20])
    assert "file is damaged" in run("tree", "--from", folder)[2]
    assert is_empty(data)


def test_a_copy_that_fails_half_way_leaves_nothing(run, add_scene, folder, data, monkeypatch):
    add_scene("tree", **TREE)
    (folder / "tree.nrrd").write_bytes(nrrd())

    def fail_half_way(path):
        yield nrrd()[:2000]
        raise OSError("Input/output error")

    monkeypatch.setattr(fetch, "chunks_of", fail_half_way)
    assert "Input/output error" in run("tree", "--from", folder)[2] and is_empty(data)


# --- What is here -------------------------------------------------------------------------------------------------


def states(run):
    code, output, _ = run("--list")
    assert code == 0
    return {line.split()[0]: line.split()[1] for line in output.splitlines()[1:]}


def test_list_tells_states_sizes_licenses_and_sources(run, add_scene, project, data):
    add_scene("field", {"generator": {}})
    add_scene("tree", **TREE)
    add_scene("mine")
    assert states(run) == {"field": "generated", "head": "missing", "mine": "missing", "tree": "missing"}
    lines = run("--list")[1].splitlines()
    assert [line.split()[0] for line in lines] == ["name", "field", "head", "mine", "tree"]
    assert "GPL-2" in lines[2] and "Debian package some-package" in lines[2]
    assert "not stated" in lines[4] and TREE["url"] in lines[4] and "0.1 MB" in lines[4]
    assert run("head")[0] == 0
    (data / "mine.nrrd").write_bytes(nrrd())
    for content, state in [
        (nrrd(), "here"),
        (nrrd(encoding="gzip"), "here"),
        (nrrd(encoding="gz"), "wrong"),  # the voxels aren't compressed
        (nrrd(BODY[:-1]), "wrong"),
        (nrrd(encoding="gzip")[:-9], "wrong"),
        (nrrd(more="data file: tree.raw\n"), "unchecked"),
        (nrrd(more="endian: big\n"), "unchecked"),
        (nrrd(encoding="bzip2"), "unchecked"),
        (nrrd()[:40], "wrong"),
        (b"<html>\n\n", "wrong"),
        (b"", "wrong"),
    ]:
        (data / "tree.nrrd").write_bytes(content)
        expected = {"field": "generated", "head": "here", "mine": "unchecked", "tree": state}
        assert states(run) == expected, content[:100]


def test_nifti_and_raw_volumes_are_checked_too(run, add_scene, data):
    brain(add_scene)
    raw = {"file": "b.raw", "offset_bytes": 5, "dims": DIMS, "type": "uint8"}
    add_scene("block", {"raw": raw}, sha512=TREE["sha512"])
    data.mkdir()
    (data / "brain.nii.gz").write_bytes(nifti(BODY, 400))
    (data / "b.raw").write_bytes(b"12345" + BODY)
    assert set(states(run).values()) == {"here"}
    (data / "brain.nii.gz").write_bytes(nifti(BODY[1:]))
    (data / "b.raw").write_bytes(b"1234" + BODY)
    assert set(states(run).values()) == {"wrong"}


def test_what_cannot_be_checked_stays(run, add_scene, data):
    add_scene("tree", **TREE)
    data.mkdir()
    (data / "tree.nrrd").write_bytes(nrrd(more="data file: tree.raw\n"))
    fails(run("tree"), "its voxels can't be checked: it stays")


def test_without_to_the_programs_folders_are_searched(add_scene, folder, tmp_path, capsys, monkeypatch):
    add_scene("tree", **TREE)
    monkeypatch.setenv("VOLMARK_DATA", f"/nowhere::{folder}")
    (folder / "tree.nrrd").write_bytes(nrrd())
    assert fetch.main(["tree"]) == 0
    assert f"{folder / 'tree.nrrd'} is there already" in capsys.readouterr().out
    # A wrong one stays: it isn't ours. But it is found first, which must be said.
    (folder / "tree.nrrd").write_bytes(nrrd(bytes(len(BODY))))
    source = tmp_path / "source"
    source.mkdir()
    (source / "tree_40x30x50_uint8.raw").write_bytes(BODY)
    assert fetch.main(["tree", "--from", str(source)]) == 0
    output = capsys.readouterr()
    written = tmp_path / "scenes" / "data" / "tree.nrrd"
    assert f"wrote {written}" in output.out and written.is_file()
    assert f"{folder / 'tree.nrrd'} has other voxels and is found first" in output.err


# --- Names ----------------------------------------------------------------------------------------------------------


def test_names_are_checked_before_anything_is_done(run, add_scene, project, data):
    add_scene("field", {"generator": {}})
    fails(run("head", "haed"), "did you mean head?", code=2)
    fails(run("xyz"), "allowed: field, head", code=2)
    assert not data.exists()


def test_several_names_go_on_after_a_failure(run, add_scene, project, data):
    add_scene("field", {"generator": {}})
    add_scene("preview", sha512="0" * 128, note="Small; the original is elsewhere.")
    add_scene("loose", url="http://127.0.0.1:1/x")
    code, output, errors = run("preview", "loose", "field", "head", "head")
    assert code == 1 and (data / "head.nrrd").is_file()
    assert len(output.splitlines()) == 2 and "nothing to fetch" in output
    assert "preview: preview.nrrd is not published anywhere" in errors and "the original is elsewhere" in errors
    assert "loose: its scene file names no sha512" in errors


def test_all_takes_what_is_published(run, add_scene, project, folder, data):
    add_scene("field", {"generator": {}})
    add_scene("preview", sha512="0" * 128)
    add_scene("tree", **TREE)
    (folder / "tree.nrrd").write_bytes(nrrd())
    project.rename(folder / "Head.inv3")
    assert run("--all", "--from", folder)[0] == 0
    assert sorted(path.name for path in data.iterdir()) == ["head.nrrd", "tree.nrrd"]


@pytest.mark.parametrize(
    "file", ["../x.nrrd", "/tmp/x.nrrd", "a/x.nrrd", "..", ".", "", ".x.nrrd", "x\n.nrrd", "a\\x.nrrd", "x.nrrd\0"]
)
def test_hostile_file_names_are_refused(run, add_scene, tmp_path, data, file):
    add_scene("tree", {"file": file}, **TREE)
    before = sorted(tmp_path.rglob("*"))
    fails(run("tree"), "tree.json", "found the file name", code=2)
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    "text, part",
    [
        ("{", "tree.json"),
        ("[]", "tree.json"),
        ("{}", "'volume' is missing"),
        ('{"title": "a", "volume": {"file": "a"}, "source": {"package": "a"}}', "'package_file' is missing"),
        ('{"title": "a", "volume": {"file": "a"}, "source": {"raw": {"dims": [1, 2], "type": "uint8"}}}', "3 dims"),
        ('{"title": "a", "volume": {"file": "a"}, "source": {"raw": {"dims": [1, 2, 0], "type": "uint8"}}}', "3 dims"),
        ('{"title": "a", "volume": {"file": "a"}, "source": {"raw": {"dims": [1, 2, 3], "type": "half"}}}', "float32"),
    ],
)
def test_damaged_scene_files_are_named(run, add_scene, text, part):
    (fetch.SCENES / "tree.json").write_text(text)
    fails(run("--list"), part, code=2)


def test_usage_errors_exit_with_2():
    for arguments in ([], ["cranium_ct", "--list"], ["--all", "--list"], ["--unknown"], ["a", "--from", "/nowhere"]):
        result = subprocess.run([sys.executable, SCENES / "fetch.py", *arguments], capture_output=True, text=True)
        assert result.returncode == 2 and "usage:" in result.stderr
    result = subprocess.run([sys.executable, SCENES / "fetch.py", "--help"], capture_output=True, text=True)
    assert result.returncode == 0 and "exit codes: 0 all volumes are there" in result.stdout


# --- The scenes that are shipped ------------------------------------------------------------------------------------

SHIPPED = {scene.name: scene for scene in read_scenes(SCENES).values() if not scene.is_generated}


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_scenes_can_be_fetched_or_say_why_not(name):
    scene = SHIPPED[name]
    assert len(scene.sha512) == 128
    assert scene.is_fetchable or scene.note
    if scene.layout:
        # The files are named after what is in them.
        columns, rows, slices = scene.layout.dims
        assert scene.url.endswith(f"_{columns}x{rows}x{slices}_{scene.layout.type}.raw")
        assert Path(scene.file).stem == name


@pytest.mark.parametrize("name", [name for name in SHIPPED if SHIPPED[name].package])
def test_debians_own_files_have_the_shipped_scenes_voxels(name, tmp_path):
    if not Path(SHIPPED[name].package_file).is_file():
        pytest.skip(f"{SHIPPED[name].package} is not installed")
    assert fetch.main([name, "--to", str(tmp_path)]) == 0
    assert (tmp_path / SHIPPED[name].file).stat().st_size > 1 << 20


def test_two_scenes_never_share_a_file():
    files = [scene.file for scene in SHIPPED.values()]
    assert len(files) == len(set(files))
