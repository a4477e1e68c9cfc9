"""Every subcommand does what its help says."""

import json
import subprocess

import pytest
from conftest import SMALL, SOURCE


def test_help_teaches(volmark):
    result = volmark("--help")
    assert result.returncode == 0
    for word in ("run", "render", "expand", "validate", "list", "describe", "device", "schema", "Exit codes"):
        assert word in result.stdout


@pytest.mark.parametrize("command", ["run", "render", "expand", "validate", "describe", "device", "schema"])
def test_each_command_has_help(volmark, command):
    result = volmark(command, "--help")
    assert result.returncode == 0 and "Usage" in result.stdout


def test_usage_errors_exit_2(volmark):
    assert volmark().returncode == 2
    assert volmark("frobnicate").returncode == 2
    assert volmark("run").returncode == 2


def test_list_and_describe(volmark):
    listed = volmark("list")
    assert listed.returncode == 0
    for name in ("iso_raymarch", "dvr_raymarch", "marschner_lobb", "cranium_ct", "smoke"):
        assert name in listed.stdout
    described = volmark("describe", "iso_raymarch")
    assert described.returncode == 0 and "step" in described.stdout and "voxel" in described.stdout


def test_describe_suggests(volmark):
    result = volmark("describe", "iso_raymrach")
    assert result.returncode == 2 and "iso_raymarch" in result.stderr


def test_device_names_lavapipe_or_better(volmark):
    result = volmark("device")
    assert result.returncode == 0 and "Vulkan 1." in result.stdout


def test_expand_prints_points_and_estimates(volmark):
    path = volmark.scenario({"set": SMALL, "blocks": [
        {"set": {"technique.name": "iso_raymarch"},
         "axes": {"step": {"path": "technique.parameters.step", "values": [0.5, 1, 2]}}},
        {"set": {"technique.name": "dvr_raymarch"}}]})
    result = volmark("expand", path)
    assert result.returncode == 0
    points = [json.loads(line) for line in result.stdout.splitlines()]
    assert len(points) == 4
    assert points[1]["labels"]["technique"] == "iso_raymarch"
    assert points[1]["config"]["technique"]["parameters"]["step"] == 1
    assert "4 points" in result.stderr and "hours" in result.stderr and "MB" in result.stderr


def test_validate_accepts_all_shipped_scenarios(volmark):
    configs = [p for p in (SOURCE / "configs").rglob("*.json") if p.parent.name not in ("profiles", "schema")]
    assert configs
    result = volmark("validate", *configs)
    assert result.returncode == 0, result.stderr


def test_schema_round_trip(volmark):
    """The schema that the program writes accepts what it accepts and refuses what it refuses."""
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads(volmark("schema").stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    for path in (SOURCE / "configs").rglob("*.json"):
        if path.parent.name not in ("profiles", "schema"):
            validator.validate(json.loads(path.read_text()))
    base = {"volmark": 1, "name": "x", "blocks": [{"set": {"technique.name": "iso_raymarch"}}]}
    for change in ({"resolutoin": [1, 2]}, {"resolution": "large"}, {"pacing": {"frames": -1}}):
        document = dict(base, set=dict(SMALL, **change))
        assert not validator.is_valid(document), change
        refused = volmark("validate", volmark.scenario({k: v for k, v in document.items() if k not in ("volmark", "name")}))
        assert refused.returncode == 2, change


def test_scene_schema(volmark):
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads(volmark("schema", "scene").stdout)
    validator = jsonschema.Draft202012Validator(schema)
    for path in (SOURCE / "scenes").glob("*.json"):
        validator.validate(json.loads(path.read_text()))


def test_render_writes_a_picture(volmark):
    result = volmark("render", "--scene", "marschner_lobb", "--technique", "iso_raymarch", "--size", "64x48", "-o", "a.exr")
    assert result.returncode == 0, result.stderr
    header = subprocess.run(["exrheader", volmark.folder / "a.exr"], capture_output=True, text=True).stdout
    assert "(0 0) - (63 47)" in header
    for channel in ("A, 16-bit", "B, 16-bit", "G, 16-bit", "R, 16-bit", "Z, 32-bit"):
        assert channel in header


def test_render_stereo_is_multi_view(volmark):
    result = volmark("render", "--scene", "marschner_lobb", "--stereo", "--size", "32x32", "-o", "s.exr")
    assert result.returncode == 0, result.stderr
    header = subprocess.run(["exrheader", volmark.folder / "s.exr"], capture_output=True, text=True).stdout
    assert "multiView" in header and "right.R" in header


def test_reference_equals_technique_closely(volmark):
    from volmark_analysis import exr
    arguments = ["render", "--scene", "nested_ellipsoids", "--technique", "iso_raymarch", "--size", "48x48"]
    assert volmark(*arguments, "-o", "t.exr").returncode == 0
    assert volmark(*arguments, "--reference", "-o", "r.exr").returncode == 0
    a, b = (exr.read_exr(volmark.folder / name)[0] for name in ("t.exr", "r.exr"))
    assert a.color[..., 3].mean() > 0.1
    assert (abs(a.color.astype(float) - b.color.astype(float)) > 0.1).any(axis=-1).mean() < 0.02


