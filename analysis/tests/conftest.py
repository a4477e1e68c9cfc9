import shutil
import sys
from pathlib import Path

import pytest

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parent.parent)]

import hostile  # noqa: E402
import synthetic  # noqa: E402
from volmark_analysis.__main__ import main  # noqa: E402


@pytest.fixture(scope="session")
def experiment_folder(tmp_path_factory):
    """A written experiment. Tests must not change it."""
    return synthetic.write_experiment(tmp_path_factory.mktemp("results") / "synthetic")


@pytest.fixture
def fresh_folder(experiment_folder, tmp_path):
    """A copy to change."""
    return Path(shutil.copytree(experiment_folder, tmp_path / "synthetic"))


@pytest.fixture(scope="session")
def large_folder(tmp_path_factory):
    """200 points with their report. Tests must not change it."""
    folder = synthetic.write_grid(tmp_path_factory.mktemp("large") / "grid", 200, frames=12)
    assert main(["report", str(folder)]) == 0
    return folder


@pytest.fixture(scope="session")
def hostile_folder(experiment_folder, tmp_path_factory):
    """An experiment of hostile texts with its report. Tests must not change it."""
    folder = Path(shutil.copytree(experiment_folder, tmp_path_factory.mktemp("hostile") / "synthetic"))
    hostile.make_hostile(folder)
    assert main(["report", str(folder)]) == 0
    return folder
