"""Scene files as far as fetching needs them; the program checks the rest (volmark schema scene)."""
import difflib
import json
from dataclasses import dataclass
from pathlib import Path

from . import FetchError

BYTES_PER_TYPE = {"int8": 1, "uint8": 1, "int16": 2, "uint16": 2, "float32": 4}


@dataclass(frozen=True)
class Layout:
    """Little-endian voxels without a header, x fastest."""

    dims: tuple
    type: str
    spacing_mm: tuple

    @property
    def bytes(self):
        columns, rows, slices = self.dims
        return columns * rows * slices * BYTES_PER_TYPE[self.type]


@dataclass(frozen=True)
class Scene:
    name: str
    title: str
    file: str  # name of the volume's file in a data folder; "" for a generated one
    raw_offset: int  # where the voxels start in a file without header, -1 if the file has a header
    sha512: str  # of the voxels; "" if the scene file names none
    url: str
    layout: Layout  # of the file at url; None if that file is the volume's file itself
    package: str
    package_file: str  # absolute path
    package_member: str  # of the package's file, if that is a tar archive; else ""
    license: str
    note: str

    @property
    def is_generated(self):
        return not self.file

    @property
    def is_fetchable(self):
        return bool(self.package or self.url)


def plain_file_name(file):
    """The name itself if it can only mean a file directly in a folder."""
    if not file or Path(file).name != file or file.startswith(".") or not file.isprintable() or "\\" in file:
        raise FetchError(f"found the file name {file!r}, allowed: a visible file's name without a folder")
    return file


def layout_of(raw):
    if raw is None:
        return None
    dims = tuple(int(side) for side in raw["dims"])
    spacing = tuple(float(length) for length in raw.get("spacing_mm", (1, 1, 1)))
    if len(dims) != 3 or min(dims) < 1 or len(spacing) != 3 or raw["type"] not in BYTES_PER_TYPE:
        raise FetchError(f"/source/raw: found {json.dumps(raw)}, allowed: 3 dims, {', '.join(BYTES_PER_TYPE)}")
    return Layout(dims, raw["type"], spacing)


def scene_of(name, document):
    volume, source = document["volume"], document.get("source", {})
    raw = volume.get("raw", {})
    file = "" if "generator" in volume else plain_file_name((raw or volume.get("mesh") or volume)["file"])
    package = source.get("package", "")
    return Scene(
        name=name,
        title=document["title"],
        file=file,
        # Of a mesh, all its text is checked.
        raw_offset=raw.get("offset_bytes", 0) if raw else 0 if "mesh" in volume else -1,
        sha512=source.get("sha512", ""),
        url=source.get("url", ""),
        layout=layout_of(source.get("raw")),
        package=package,
        package_file=source["package_file"] if package else "",
        package_member=source.get("package_member", ""),
        license=source.get("license", ""),
        note=source.get("note", ""),
    )


def read_scenes(folder):
    """Scenes by name."""
    scenes = {}
    for path in sorted(folder.glob("*.json")):
        try:
            scenes[path.stem] = scene_of(path.stem, json.loads(path.read_text(encoding="utf-8")))
        except KeyError as error:
            raise FetchError(f"{path}: key {error} is missing") from None
        except (AttributeError, TypeError, ValueError, FetchError) as error:
            raise FetchError(f"{path}: {error}") from None
    return scenes


def find_scene(scenes, name):
    if name in scenes:
        return scenes[name]
    nearest = difflib.get_close_matches(name, scenes, n=1)
    hint = f", did you mean {nearest[0]}?" if nearest else f", allowed: {', '.join(scenes)}"
    raise FetchError(f"there is no scene {name}{hint}")
