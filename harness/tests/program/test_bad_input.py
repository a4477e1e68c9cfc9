"""Bad input gives one clear line, exit code 2, and leaves nothing written."""

import gzip
import json
import struct

import pytest
from conftest import SMALL

RAW_HEADER = "NRRD0004\ntype: {type}\ndimension: 3\nsizes: {sizes}\nspacings: 1 1 1\nendian: little\nencoding: {encoding}\n\n"


def refused(volmark, *arguments, says):
    """Runs, and checks the one line; nothing but the inputs may be there afterwards."""
    before = set(volmark.folder.rglob("*"))
    result = volmark(*arguments, timeout=60)
    assert result.returncode == 2, (result.stdout, result.stderr)
    lines = result.stderr.strip().splitlines()
    assert len(lines) == 1, result.stderr
    for word in says:
        assert word in lines[0], lines[0]
    assert set(volmark.folder.rglob("*")) == before


def run_scenario(volmark, document, *extra):
    return ("run", volmark.scenario(document), "--results", volmark.results, *extra)


TECHNIQUE = [{"set": {"technique.name": "iso_raymarch"}}]


@pytest.mark.parametrize("document, says", [
    ({"set": {**SMALL, "resolutoin": [8, 8]}, "blocks": TECHNIQUE}, ["resolutoin", "resolution", "scenario.json"]),
    ({"set": {**SMALL, "resolution": "big"}, "blocks": TECHNIQUE}, ["/set/resolution", "big"]),
    ({"set": {**SMALL, "resolution": [0, 8]}, "blocks": TECHNIQUE}, ["resolution", "0"]),
    ({"set": {**SMALL, "resolution": [1000000, 1000000]}, "blocks": TECHNIQUE}, ["resolution", "1000000"]),
    ({"set": {**SMALL, "pacing": {"frames": 1.5}}, "blocks": TECHNIQUE}, ["frames", "1.5"]),
    ({"set": {**SMALL, "scene": "marschner_lob"}, "blocks": TECHNIQUE}, ["marschner_lob", "marschner_lobb"]),
    ({"set": SMALL, "blocks": [{"set": {"technique.name": "iso_raymrach"}}]}, ["iso_raymrach", "iso_raymarch"]),
    ({"set": SMALL, "blocks": [{"set": {"technique": {"name": "iso_raymarch", "parameters": {"stepp": 1}}}}]},
     ["stepp", "step"]),
    ({"set": SMALL, "blocks": [{"set": {"technique": {"name": "iso_raymarch", "parameters": {"step": 99}}}}]},
     ["step", "99"]),
    ({"set": {**SMALL, "isovalue": {"normalized": 3}}, "blocks": TECHNIQUE}, ["isovalue", "3"]),
    ({"set": {**SMALL, "isovalue": "bony"}, "blocks": TECHNIQUE}, ["isovalue", "bony"]),
    ({"set": {**SMALL, "isovalue": {"raw": 1e9}}, "blocks": TECHNIQUE}, ["isovalue"]),
    ({"set": SMALL, "blocks": []}, ["blocks"]),
    ({"set": SMALL}, ["technique"]),
])
def test_scenarios(volmark, document, says):
    refused(volmark, *run_scenario(volmark, document), says=says)


def test_malformed_json(volmark):
    path = volmark.folder / "broken.json"
    path.write_text('{"volmark": 1,\n "name": }')
    refused(volmark, "run", path, "--results", volmark.results, says=["broken.json", "line 2"])


def test_missing_config(volmark):
    refused(volmark, "run", "nowhere.json", says=["nowhere.json"])


def test_wrong_format_version(volmark):
    path = volmark.folder / "future.json"
    path.write_text(json.dumps({"volmark": 99, "name": "x", "blocks": TECHNIQUE}))
    refused(volmark, "run", path, "--results", volmark.results, says=["99", "1"])


def test_assignments(volmark):
    document = {"set": SMALL, "blocks": TECHNIQUE}
    refused(volmark, *run_scenario(volmark, document, "--set", "pacing.framse=3"), says=["framse", "frames"])
    refused(volmark, *run_scenario(volmark, document, "--set", "pacing.frames"), says=["pacing.frames"])
    refused(volmark, *run_scenario(volmark, document, "--profile", "smok"), says=["smok", "smoke"])


def test_unwritable_results(volmark):
    path = volmark.scenario({"set": SMALL, "blocks": TECHNIQUE})
    (volmark.folder / "file").write_text("in the way")
    refused(volmark, "run", path, "--results", volmark.folder / "file" / "results", says=["results"])


def test_existing_experiment_of_another_version(volmark):
    path = volmark.scenario({"set": SMALL, "blocks": TECHNIQUE})
    folder = volmark.results / "scenario"
    folder.mkdir(parents=True)
    (folder / "experiment.json").write_text('{"format": "volmark.experiment", "version": 7}')
    refused(volmark, "run", path, "--results", volmark.results, says=["version", "7"])


def write_volume(volmark, type, sizes, payload, encoding="raw"):
    path = volmark.folder / "v.nrrd"
    path.write_bytes(RAW_HEADER.format(type=type, sizes=sizes, encoding=encoding).encode() + payload)
    return path


@pytest.mark.parametrize("sizes, payload, encoding, says", [
    ("4 4 4", b"\0" * 63, "raw", ["v.nrrd"]),
    ("4 4 4", b"\0" * 65, "raw", ["v.nrrd"]),
    ("4 4 -4", b"\0" * 64, "raw", ["v.nrrd", "-4"]),
    ("4 4 0", b"", "raw", ["v.nrrd", "0"]),
    ("99999 99999 99999", b"\0" * 64, "raw", ["v.nrrd"]),
    ("4294967296 4294967296 4294967296", b"\0" * 64, "raw", ["v.nrrd"]),
    ("4 4 4", gzip.compress(b"\0" * 63), "gzip", ["v.nrrd"]),
    ("4 4 4", gzip.compress(b"\0" * 65), "gzip", ["v.nrrd"]),
    ("4 4 4", gzip.compress(b"\0" * 64)[:-9], "gzip", ["v.nrrd"]),
])
def test_lying_headers(volmark, sizes, payload, encoding, says):
    path = write_volume(volmark, "uint8", sizes, payload, encoding)
    refused(volmark, "render", "--volume", path, "-o", "x.exr", says=says)


@pytest.mark.parametrize("value, word", [(float("nan"), "NaN"), (float("inf"), "infinite")])
def test_voxels_that_are_not_finite(volmark, value, word):
    path = write_volume(volmark, "float", "2 2 2", struct.pack("<8f", 0, 1, 2, 3, 4, 5, value, 7))
    refused(volmark, "render", "--volume", path, "-o", "x.exr", says=[word, "(0, 1, 1)"])


def test_constant_volume(volmark):
    path = write_volume(volmark, "uint8", "4 4 4", b"\7" * 64)
    refused(volmark, "render", "--volume", path, "-o", "x.exr", says=["7"])


def test_one_voxel_axes_are_drawn(volmark):
    path = write_volume(volmark, "uint8", "8 8 1", bytes(range(64)))
    for technique in ("iso_raymarch", "dvr_raymarch"):
        result = volmark("render", "--volume", path, "--technique", technique, "--size", "16x16", "-o", "x.exr")
        assert result.returncode == 0, result.stderr


def test_render_needs_a_volume_and_a_good_size(volmark):
    refused(volmark, "render", "-o", "x.exr", says=["--volume", "--scene"])
    refused(volmark, "render", "--volume", "missing.nrrd", "-o", "x.exr", says=["missing.nrrd"])
    refused(volmark, "render", "--scene", "marschner_lobb", "--size", "12by9", "-o", "x.exr", says=["12by9"])
    refused(volmark, "render", "--scene", "marschner_lobb", "--size", "16x16", "-o", "no/such/folder/x.exr", says=["no/such"])


def test_missing_volume_names_the_way_to_get_it(volmark):
    scene = volmark.folder / "far.json"
    scene.write_text(json.dumps({"volmark_scene": 1, "title": "far away", "volume": {"file": "far.nrrd"},
                                 "isovalues": {"a": {"normalized": 0.5}}}))
    document = {"set": {**SMALL, "scene": str(scene)}, "blocks": TECHNIQUE}
    refused(volmark, *run_scenario(volmark, document), says=["far.nrrd"])


def test_every_point_is_checked_against_its_volume(volmark):
    """A limit on voxels, and an isovalue of a later point: both are found before anything is written."""
    write_volume(volmark, "uint8", "4 4 4", bytes(range(64)))
    scene = volmark.folder / "small.json"
    scene.write_text(json.dumps({"volmark_scene": 1, "title": "small", "volume": {"file": "v.nrrd"}}))
    settings = {**SMALL, "scene": str(scene)}
    refused(volmark, *run_scenario(volmark, {"set": settings, "blocks": TECHNIQUE, "limits": {"voxels": 63}}),
            says=["64 voxels", "63"])
    values = [{"raw": 10}, {"raw": 1000}]
    blocks = [{**TECHNIQUE[0], "axes": {"isovalue": {"path": "isovalue", "values": values}}}]
    refused(volmark, *run_scenario(volmark, {"set": settings, "blocks": blocks}), says=["isovalue"])
