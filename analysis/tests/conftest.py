import shutil
import sys
from pathlib import Path

import pytest

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parent.parent)]

import synthetic  # noqa: E402


@pytest.fixture(scope="session")
def experiment_folder(tmp_path_factory):
    """A written experiment. Tests must not change it."""
    return synthetic.write_experiment(tmp_path_factory.mktemp("results") / "synthetic")


@pytest.fixture
def fresh_folder(experiment_folder, tmp_path):
    """A copy to change."""
    return Path(shutil.copytree(experiment_folder, tmp_path / "synthetic"))
