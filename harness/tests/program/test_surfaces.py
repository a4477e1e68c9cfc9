"""The techniques that draw isosurfaces, through the whole chain, with the validation layers on; meshes as files."""

import struct

import pytest
from conftest import SMALL

SURFACES = {
    "iso_octree": {},
    "iso_octree, fragment": {"stage": "fragment"},
    "mesh_shader_isosurface": {},
    "marching_cubes": {},
    "marching_cubes, prepass": {"depth_prepass": True},
    "optimized_mesh": {},
    "optimized_mesh, vertex": {"pipeline": "vertex"},
}


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    from conftest import Volmark
    volmark = Volmark(tmp_path_factory.mktemp("surfaces"))
    cases = [{"label": label, "set": {"technique": {"name": label.split(",")[0], "parameters": parameters}}}
             for label, parameters in SURFACES.items()]
    document = {
        "set": {**SMALL, "scene": "blast_wave", "volume.generator.dims": [40, 40, 40],
                "volume.generator.parameters": {"time_steps": 3, "instability": 0, "front_width": 0.1}, "resolution": [72, 60], "stereo.enabled": True,
                "timeline.play_time_steps": True, "timeline.isovalue_sweep": {"from": {"normalized": 0.3}, "to": {"normalized": 0.5}},
                "measure.isolation": "volume", "pictures": {"count": 2, "reference": "cpu"}},
        "blocks": [{"axes": {"method": {"values": cases}}}]}
    result = volmark("run", volmark.scenario(document), "--results", volmark.results, "--validate")
    assert result.returncode == 0, result.stderr
    return {run["labels"]["method"]: run for run in volmark.runs().values()}


def test_every_check_passes(runs):
    assert runs.keys() == SURFACES.keys()
    for run in runs.values():
        assert run["status"] == "completed", run["reason"]
        checks = {check["name"]: check for check in run["checks"]}
        assert {"timed_frame_equals_replay", "memory_equals_ledger", "validation"} <= set(checks)
        assert all(check["passed"] for check in checks.values()), checks


def test_pictures_are_near_the_reference(runs):
    for method, run in runs.items():
        assert run["pictures"]
        for picture in run["pictures"]:
            assert picture["psnr_db"] > 29, (method, picture)
            assert picture["depth_mean_voxels"] < 0.15 and picture["depth_p995_voxels"] < 1.2, (method, picture)
            assert picture["missed_share"] + picture["spurious_share"] < 0.03, (method, picture)


def test_extraction_is_update_and_not_draw(runs):
    for method in ("marching_cubes", "optimized_mesh"):
        passes = runs[method]["statistics"]["passes"]
        assert passes["extract"]["mean_ms"] > 0
        assert runs[method]["statistics"]["update"]["mean_ms"] > 0


def test_a_mesh_is_written_as_ply_and_gltf(volmark):
    for name, magic in (("a.ply", b"ply\n"), ("a.glb", b"glTF")):
        mesh = volmark.folder / name
        result = volmark("render", "--scene", "sphere", "--technique", "marching_cubes", "--size", "32x32", "--mesh", mesh,
                         "-o", volmark.folder / "a.exr", "--set", "volume.generator.dims=[24,24,24]")
        assert result.returncode == 0, result.stderr
        assert mesh.read_bytes().startswith(magic)
        assert f"{mesh}: " in result.stdout and " triangles" in result.stdout
    glb = (volmark.folder / "a.glb").read_bytes()
    assert struct.unpack("<I", glb[8:12])[0] == len(glb)


def test_what_makes_no_mesh_says_so(volmark):
    for arguments, message in ((["--technique", "iso_raymarch", "--mesh", volmark.folder / "a.ply"], "makes no mesh"),
                               (["--technique", "marching_cubes", "--mesh", volmark.folder / "a.obj"], ".ply, .glb")):
        result = volmark("render", "--scene", "sphere", "--size", "32x32", "-o", volmark.folder / "a.exr",
                         "--set", "volume.generator.dims=[24,24,24]", *arguments)
        assert result.returncode == 2
        assert message in result.stderr and result.stderr.count("\n") == 1
