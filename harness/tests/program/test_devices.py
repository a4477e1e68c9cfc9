"""Devices that lack something: a row that says so, and everything else goes on."""

from conftest import BUILD, SMALL


def test_a_device_without_mesh_shaders_gets_a_row(volmark):
    volmark.environment.update(VK_ADD_LAYER_PATH=f"{BUILD}/tests/layer",
                               VK_INSTANCE_LAYERS="VK_LAYER_VOLMARK_hide_extension",
                               VOLMARK_TEST_HIDE="VK_EXT_mesh_shader")
    methods = {"mesh_shader_isosurface": {}, "optimized_mesh": {}, "optimized_mesh, vertex": {"pipeline": "vertex"},
               "marching_cubes": {}}
    values = [{"label": label, "set": {"technique": {"name": label.split(",")[0], "parameters": parameters}}}
              for label, parameters in methods.items()]
    document = {"set": {**SMALL, "scene": "sphere", "volume.generator.dims": [24, 24, 24], "measure.isolation": "volume"},
                "blocks": [{"axes": {"method": {"values": values}}}]}
    result = volmark("run", volmark.scenario(document), "--results", volmark.results)
    assert result.returncode == 0, result.stderr
    runs = {run["labels"]["method"]: run for run in volmark.runs().values()}
    assert {method: run["status"] for method, run in runs.items()} == {
        "mesh_shader_isosurface": "unsupported", "optimized_mesh": "unsupported",
        "optimized_mesh, vertex": "completed", "marching_cubes": "completed"}
    assert runs["mesh_shader_isosurface"]["reason"].endswith("has no mesh shaders.")
    assert runs["optimized_mesh"]["reason"].endswith("has no mesh shaders; pipeline=vertex needs none.")
