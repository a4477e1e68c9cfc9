#!/usr/bin/env python3
"""Makes the volumes of scenes whose data comes with a Debian package.

usage: fetch.py NAME [--to DIR] [--from FILE]
       fetch.py --list

Nothing is downloaded. A volume is written only if its voxels have the SHA-512 that the scene file names.
"""
import argparse
import difflib
import hashlib
import json
import os
import plistlib
import sys
import tarfile
import tempfile
import xml.parsers.expat
import zlib
from pathlib import Path

SCENES = Path(__file__).resolve().parent
PACKAGE_FILES = {"invesalius-examples": Path("/usr/share/doc/invesalius-examples/examples/Cranium.inv3")}
BYTES_PER_TYPE = {"int16": 2}
MAXIMUM_BYTES = 1 << 30
MAXIMUM_HEADER_BYTES = 1 << 16


class FetchError(Exception):
    """One line for the user."""


def read_scenes():
    """Scene documents by name."""
    scenes = {}
    for path in sorted(SCENES.glob("*.json")):
        try:
            scenes[path.stem] = json.loads(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise FetchError(f"{path}: {error}") from None
    return scenes


def find_scene(scenes, name):
    if name in scenes:
        return scenes[name]
    nearest = difflib.get_close_matches(name, scenes, n=1)
    hint = f", did you mean {nearest[0]}?" if nearest else f", allowed: {', '.join(scenes)}"
    raise FetchError(f"there is no scene {name}{hint}")


def package_of(scene):
    return scene.get("source", {}).get("package")


def member_named(archive, name):
    for member in archive.getmembers():
        if member.isfile() and Path(member.name).name == name:
            return member
    raise FetchError(f"{archive.name}: there is no {name} in it")


def read_member(archive, name, size):
    """The content of a member of at most, or (if it is given) exactly, `size` bytes."""
    member = member_named(archive, name)
    if member.size > size:
        raise FetchError(f"{archive.name}: {name} has {member.size} bytes, expected {size}")
    return archive.extractfile(member).read()


def reverse_rows(voxels, rows, row_bytes):
    """Reverses the order of the rows of every slice."""
    flipped = bytearray(len(voxels))
    slice_bytes = rows * row_bytes
    for start in range(0, len(voxels), slice_bytes):
        for row in range(rows):
            source = start + row * row_bytes
            target = start + (rows - 1 - row) * row_bytes
            flipped[target : target + row_bytes] = voxels[source : source + row_bytes]
    return bytes(flipped)


def read_inv3(path):
    """Dims (x, y, z), spacing (mm), type and voxels of an InVesalius project.

    InVesalius keeps the rows from back to front and mirrors its surfaces when it makes them. Reversing the
    rows gives a right-handed volume: x to the patient's left, y to the back, z to the crown.
    """
    try:
        with tarfile.open(path, "r:gz") as archive:
            project = plistlib.loads(read_member(archive, "main.plist", MAXIMUM_HEADER_BYTES))
            matrix = project["matrix"]
            depth, rows, columns = (int(n) for n in matrix["shape"])
            scalar_type = matrix["dtype"]
            if scalar_type not in BYTES_PER_TYPE or min(depth, rows, columns) < 1:
                raise FetchError(f"{path}: found {columns} x {rows} x {depth} voxels of {scalar_type}, allowed: int16")
            row_bytes = columns * BYTES_PER_TYPE[scalar_type]
            expected = depth * rows * row_bytes
            if expected > MAXIMUM_BYTES:
                raise FetchError(f"{path}: {expected} bytes of voxels, allowed: {MAXIMUM_BYTES}")
            voxels = read_member(archive, "matrix.dat", expected)
            spacing = tuple(float(length) for length in project["spacing"])
    except (tarfile.TarError, OSError, EOFError, zlib.error) as error:
        raise FetchError(f"{path}: can't be read: {error}") from None
    except (KeyError, TypeError, ValueError, plistlib.InvalidFileException, xml.parsers.expat.ExpatError) as error:
        raise FetchError(f"{path}: not an InVesalius project: {error!r}") from None
    if len(voxels) != expected:
        raise FetchError(f"{path}: matrix.dat has {len(voxels)} bytes, expected {expected}")
    return (columns, rows, depth), spacing, scalar_type, reverse_rows(voxels, rows, row_bytes)


def check_voxels(place, voxels, sha512):
    found = hashlib.sha512(voxels).hexdigest()
    if found != sha512:
        raise FetchError(f"{place}: the voxels' SHA-512 is {found[:16]}..., the scene file says {sha512[:16]}...")


def nrrd_header(name, package, dims, spacing, scalar_type):
    return (
        f"NRRD0004\n# Converted from the Debian package {package}\ntype: {scalar_type}\ndimension: 3\n"
        f"sizes: {' '.join(map(str, dims))}\nspacings: {' '.join(map(repr, spacing))}\n"
        f"endian: little\nencoding: raw\ncontent: {name}\n\n"
    ).encode("ascii")


def write_atomically(path, *parts):
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            for part in parts:
                file.write(part)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        os.unlink(temporary)
        raise


def is_whole(path, sha512):
    """Whether a file that this script wrote has the voxels of the scene file."""
    if not path.is_file():
        return False
    _, blank_line, voxels = path.read_bytes().partition(b"\n\n")
    return bool(blank_line) and hashlib.sha512(voxels).hexdigest() == sha512


def fetch(name, folder, source):
    """Writes the scene's volume to a folder unless it is there. Returns what was done, as one line."""
    scene = find_scene(read_scenes(), name)
    package = package_of(scene)
    if "generator" in scene["volume"]:
        return f"{name}: its volume is generated, there is nothing to fetch"
    if package is None:
        url = scene.get("source", {}).get("url", "its source")
        raise FetchError(f"{name}: no package has this volume; it comes from {url}")
    sha512 = scene["source"]["sha512"]
    target = folder / scene["volume"]["file"]
    if is_whole(target, sha512):
        return f"{name}: {target} is there already"

    source = source or PACKAGE_FILES[package]
    if not source.is_file():
        raise FetchError(f"{source} is missing: install the Debian package {package} (ci/bootstrap.sh does)")
    dims, spacing, scalar_type, voxels = read_inv3(source)
    check_voxels(source, voxels, sha512)
    write_atomically(target, nrrd_header(name, package, dims, spacing, scalar_type), voxels)
    return f"{name}: wrote {target}, {' x '.join(map(str, dims))} voxels of {scalar_type}"


def data_folders(folder):
    listed = os.environ.get("VOLMARK_DATA", "").split(":")
    return [SCENES, *(Path(part) for part in listed if part), folder]


def state_of(scene, folder):
    volume = scene["volume"]
    if "generator" in volume:
        return "generated"
    file = volume["file"] if "file" in volume else volume["raw"]["file"]
    if any((candidate / file).is_file() for candidate in data_folders(folder)):
        return "here"
    return "to fetch" if package_of(scene) else "missing"


def list_scenes(folder):
    scenes = read_scenes()
    width = max(map(len, scenes), default=0)
    return [f"{name:<{width}}  {state_of(scene, folder):<9}  {scene['title']}" for name, scene in scenes.items()]


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="fetch.py", description=__doc__.splitlines()[0])
    parser.add_argument("name", nargs="?", help="a scene whose volume comes with a Debian package")
    parser.add_argument("--to", type=Path, default=SCENES / "data", metavar="DIR", help="default: scenes/data")
    parser.add_argument("--from", type=Path, dest="source", metavar="FILE", help="instead of the package's file")
    parser.add_argument("--list", action="store_true", help="show all scenes and whether their volumes are here")
    options = parser.parse_args(arguments)
    if options.list == (options.name is not None):
        parser.error("give a scene's name or --list")
    try:
        if options.list:
            print("\n".join(list_scenes(options.to)))
        else:
            print(fetch(options.name, options.to, options.source))
    except (FetchError, OSError) as error:
        print(f"fetch.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
