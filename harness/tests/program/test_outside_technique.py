"""A technique built outside the repository against the installed package."""

import os
import pathlib
import shutil
import subprocess

from conftest import BUILD, SOURCE


def run(*command, **options):
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


def test_template_builds_and_draws_outside(tmp_path):
    prefix = tmp_path / "prefix"
    run("cmake", "--install", BUILD, "--prefix", prefix)
    (package,) = prefix.rglob("volmarkConfig.cmake")

    outside = tmp_path / "outside"
    shutil.copytree(SOURCE / "techniques" / "template", outside)
    flags = os.environ.get("VOLMARK_OUTSIDE_FLAGS", "")
    run("cmake", "-S", outside, "-B", outside / "build", "-G", "Ninja", f"-Dvolmark_DIR={package.parent}",
        f"-DCMAKE_CXX_FLAGS={flags}", f"-DCMAKE_CXX_COMPILER={compiler()}")
    run("cmake", "--build", outside / "build")

    environment = {k: v for k, v in os.environ.items() if not k.startswith("VOLMARK_")}
    environment["VOLMARK_TECHNIQUES"] = str(outside / "build")
    program = prefix / "bin" / "volmark"
    assert "box_depth" in run(program, "list", env=environment, cwd=tmp_path)
    run(program, "render", "--scene", "marschner_lobb", "--technique", "box_depth", "--size", "32x32", "-o",
        tmp_path / "box.exr", env=environment, cwd=tmp_path)
    assert (tmp_path / "box.exr").stat().st_size > 500

    # The installed program finds the modules and scenes that were installed with it.
    del environment["VOLMARK_TECHNIQUES"]
    listed = run(program, "list", env=environment, cwd=tmp_path)
    assert "iso_raymarch" in listed and "marschner_lobb" in listed


def compiler():
    """The one that volmark itself was built with: the loader refuses others."""
    for line in pathlib.Path(BUILD / "CMakeCache.txt").read_text().splitlines():
        if line.startswith("CMAKE_CXX_COMPILER:"):
            return line.split("=", 1)[1]
    raise AssertionError("the build has no compiler")
