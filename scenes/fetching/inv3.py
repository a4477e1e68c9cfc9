"""Projects of InVesalius."""
import plistlib
import tarfile
import xml.parsers.expat
import zlib
from pathlib import Path

from . import FetchError
from .scene import BYTES_PER_TYPE, Layout

MAXIMUM_BYTES = 1 << 30
MAXIMUM_PROJECT_BYTES = 1 << 16


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
    """Layout and voxels of an InVesalius project.

    InVesalius keeps the rows from back to front and mirrors its surfaces when it makes them. Reversing the
    rows gives a right-handed volume: x to the patient's left, y to the back, z to the crown.
    """
    try:
        with tarfile.open(path, "r:gz") as archive:
            project = plistlib.loads(read_member(archive, "main.plist", MAXIMUM_PROJECT_BYTES))
            matrix = project["matrix"]
            depth, rows, columns = (int(n) for n in matrix["shape"])
            scalar_type = matrix["dtype"]
            if scalar_type != "int16" or min(depth, rows, columns) < 1:
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
    return Layout((columns, rows, depth), scalar_type, spacing), reverse_rows(voxels, rows, row_bytes)
