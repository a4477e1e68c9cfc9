"""A paper's texts and figures in a folder."""

from __future__ import annotations

from pathlib import Path

from ..errors import InputError
from .figures import Drawn, write_figures


def write_output(folder: Path, texts: dict[str, str], drawn: list[Drawn]) -> None:
    """`texts`: by name of the file. Prints what was written. Raises InputError if the folder can't be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="utf-8")
        names = [*texts, *write_figures(folder, drawn)]
    except OSError as error:
        raise InputError(f"{error.filename or folder}: can't be written ({error.strerror or error})") from None
    for name in names:
        print(folder / name)
