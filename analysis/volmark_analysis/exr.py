"""Reads the OpenEXR files that volmark writes: single-part scan lines, uncompressed or zip, half, float or uint.

Layout: https://openexr.com, "OpenEXR File Layout". Stereo pictures are multi-view: the default view's channels
are plain (R, G, B, A, Z, steps, N.X ...), the others carry the view's name ("right.R").
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .errors import InputError

_MAGIC = 20000630
_TILED, _DEEP, _MULTIPART = 0x200, 0x800, 0x1000
_COMPRESSIONS = {0: ("none", 1), 2: ("zips", 1), 3: ("zip", 16)}  # code: name, lines per block
_COMPRESSION_NAMES = ("none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab")
_PIXEL_TYPES = {0: np.dtype("<u4"), 1: np.dtype("<f2"), 2: np.dtype("<f4")}


@dataclass
class Picture:
    """One view; arrays of height x width (x components), float32. Layers that the file lacks are None."""

    color: np.ndarray
    """Four components: linear, premultiplied alpha."""
    distance: np.ndarray | None
    """World units, infinite where nothing is."""
    steps: np.ndarray | None = None
    """Iterations of each pixel's ray."""
    normal: np.ndarray | None = None
    """Three components: world axes."""


def read_exr(path: str | Path) -> list[Picture]:
    """All views of a file, the default view first. Raises InputError."""
    channels, views = read_channels(path)
    return [_picture_of(channels, "" if i == 0 else f"{name}.", path) for i, name in enumerate(views)]


def read_channels(path: str | Path) -> tuple[dict[str, np.ndarray], list[str]]:
    """Channels by name (height x width, in the file's own type) and the names of the views ([""] for one)."""
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    try:
        return _parse(data, path)
    except (struct.error, zlib.error, IndexError, ValueError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: damaged OpenEXR file ({error})") from None


def _parse(data: bytes, path: str | Path) -> tuple[dict[str, np.ndarray], list[str]]:
    magic, version = struct.unpack_from("<II", data, 0)
    if magic != _MAGIC:
        raise InputError(f"{path}: not an OpenEXR file")
    for bit, name in ((_TILED, "tiled"), (_DEEP, "deep"), (_MULTIPART, "multi-part")):
        if version & bit:
            raise InputError(f"{path}: found a {name} OpenEXR file, allowed: single-part scan lines")
    attributes, offset = _attributes(data)
    compression = attributes["compression"][0]
    if compression not in _COMPRESSIONS:
        found = _COMPRESSION_NAMES[compression] if compression < len(_COMPRESSION_NAMES) else compression
        raise InputError(f"{path}: found compression {found}, allowed: none, zips, zip")
    channels = _channel_list(attributes["channels"])
    for name, _, sampling in channels:
        if sampling != (1, 1):
            raise InputError(f"{path}: channel {name} is subsampled, allowed: full resolution")
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    views = _string_vector(attributes["multiView"]) if "multiView" in attributes else [""]
    pixels = _scan_lines(data, offset, channels, x1 - x0 + 1, y1 - y0 + 1, y0, compression)
    return pixels, views


def _attributes(data: bytes) -> tuple[dict[str, bytes], int]:
    """Header attributes by name, raw, and where the header ends."""
    attributes, at = {}, 8
    while data[at] != 0:
        name_end = data.index(0, at)
        type_end = data.index(0, name_end + 1)
        (size,) = struct.unpack_from("<i", data, type_end + 1)
        start = type_end + 5
        attributes[data[at:name_end].decode()] = data[start : start + size]
        at = start + size
    for name in ("compression", "channels", "dataWindow"):
        if name not in attributes:
            raise ValueError(f"no attribute {name}")
    return attributes, at + 1


def _channel_list(raw: bytes) -> list[tuple[str, np.dtype, tuple[int, int]]]:
    channels, at = [], 0
    while raw[at] != 0:
        end = raw.index(0, at)
        kind, _, x_sampling, y_sampling = struct.unpack_from("<iIii", raw, end + 1)
        channels.append((raw[at:end].decode(), _PIXEL_TYPES[kind], (x_sampling, y_sampling)))
        at = end + 17
    return channels


def _string_vector(raw: bytes) -> list[str]:
    strings, at = [], 0
    while at < len(raw):
        (size,) = struct.unpack_from("<i", raw, at)
        strings.append(raw[at + 4 : at + 4 + size].decode())
        at += 4 + size
    return strings


def _scan_lines(data, offset, channels, width, height, first_line, compression) -> dict[str, np.ndarray]:
    lines_per_block = _COMPRESSIONS[compression][1]
    blocks = -(-height // lines_per_block)
    pixels = {name: np.empty((height, width), kind) for name, kind, _ in channels}
    line_bytes = sum(kind.itemsize for _, kind, _ in channels) * width
    for start in struct.unpack_from(f"<{blocks}Q", data, offset):
        y, size = struct.unpack_from("<ii", data, start)
        row = y - first_line
        lines = min(lines_per_block, height - row)
        if not 0 <= row < height:
            raise ValueError(f"block at line {y} outside the data window")
        block = data[start + 8 : start + 8 + size]
        # A block that would not shrink is stored as it is.
        if compression != 0 and size < lines * line_bytes:
            block = _unpredict(zlib.decompress(block))
        if len(block) != lines * line_bytes:
            raise ValueError(f"block at line {y} has {len(block)} bytes, expected {lines * line_bytes}")
        at = 0
        for line in range(row, row + lines):
            for name, kind, _ in channels:
                pixels[name][line] = np.frombuffer(block, kind, width, at)
                at += width * kind.itemsize
    return pixels


def _unpredict(block: bytes) -> bytes:
    """Undoes zip's preparation: bytes were split into even and odd halves, then stored as differences."""
    differences = np.frombuffer(block, np.uint8).copy()
    differences[1:] -= 128
    halves = np.cumsum(differences, dtype=np.uint8)
    middle = (len(halves) + 1) // 2
    out = np.empty_like(halves)
    out[0::2], out[1::2] = halves[:middle], halves[middle:]
    return out.tobytes()


def _picture_of(channels: dict[str, np.ndarray], prefix: str, path) -> Picture:
    def layer(name):
        # In a view of a multi-view file OpenEXR writes layers as "N.right.X"; volmark writes "right.N.X".
        group, dot, last = name.rpartition(".")
        found = channels.get(prefix + name, channels.get(group + dot + prefix + last))
        return None if found is None else found.astype(np.float32)

    missing = [name for name in "RGB" if prefix + name not in channels]
    if missing:
        raise InputError(f"{path}: no channel {prefix}{missing[0]}, found: {', '.join(channels)}")
    planes = [layer(name) for name in "RGBA"]
    if planes[3] is None:
        planes[3] = np.ones_like(planes[0])
    normal = [layer(f"N.{axis}") for axis in "XYZ"]
    return Picture(np.stack(planes, axis=-1), layer("Z"), layer("steps"),
                   None if any(plane is None for plane in normal) else np.stack(normal, axis=-1))
