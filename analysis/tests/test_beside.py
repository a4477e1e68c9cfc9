"""Work beside: it happens, and what goes wrong there is raised here."""

import os
import time

import pytest
from volmark_analysis.beside import Beside
from volmark_analysis.errors import InputError


def test_what_it_writes_is_there_at_the_end(tmp_path):
    with Beside(lambda: (tmp_path / "a").write_text("done")):
        pass
    assert (tmp_path / "a").read_text() == "done"


def test_its_errors_are_raised_here(tmp_path):
    with pytest.raises(FileNotFoundError) as raised, Beside(lambda: (tmp_path / "no" / "a").write_text("x")):
        pass
    assert str(raised.value.filename).endswith("no/a")

    def refuse():
        raise InputError("file: place")
    with pytest.raises(InputError, match="file: place"), Beside(refuse):
        pass
    with pytest.raises(RuntimeError, match="ZeroDivisionError"), Beside(lambda: 1 / 0):
        pass
    with pytest.raises(RuntimeError, match="ended early"), Beside(lambda: os._exit(3)):
        pass


def test_an_error_here_ends_it(tmp_path):
    def slow():
        time.sleep(5)
        (tmp_path / "late").write_text("x")
    start = time.monotonic()
    with pytest.raises(KeyError), Beside(slow):
        raise KeyError
    assert time.monotonic() - start < 4 and not (tmp_path / "late").exists()
