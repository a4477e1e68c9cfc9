"""A small OpenEXR writer for tests: single-part scan lines; none, zips or zip; half, float or uint channels."""

import struct
import zlib

import numpy as np

CODES = {"none": (0, 1), "zips": (2, 1), "zip": (3, 16)}
KINDS = {np.dtype("<u4"): 0, np.dtype("<f2"): 1, np.dtype("<f4"): 2}


def write_exr(path, channels, compression="zip", views=None, corner=(0, 0), decreasing=False):
    """`channels`: arrays (height x width) by name."""
    code, lines = CODES[compression]
    names = sorted(channels)
    height, width = channels[names[0]].shape
    header = struct.pack("<II", 20000630, 2)
    window = struct.pack("<4i", corner[0], corner[1], corner[0] + width - 1, corner[1] + height - 1)
    listing = b"".join(n.encode() + b"\0" + struct.pack("<iIii", KINDS[channels[n].dtype], 0, 1, 1) for n in names)
    header += _attribute("channels", "chlist", listing + b"\0")
    header += _attribute("compression", "compression", bytes([code]))
    header += _attribute("dataWindow", "box2i", window) + _attribute("displayWindow", "box2i", window)
    header += _attribute("lineOrder", "lineOrder", bytes([1 if decreasing else 0]))
    header += _attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    header += _attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0))
    header += _attribute("screenWindowWidth", "float", struct.pack("<f", 1))
    if views:
        strings = b"".join(struct.pack("<i", len(v)) + v.encode() for v in views)
        header += _attribute("multiView", "stringvector", strings)
    header += b"\0"

    chunks = []
    for first in range(0, height, lines):
        rows = range(first, min(first + lines, height))
        raw = b"".join(channels[n][y].tobytes() for y in rows for n in names)
        packed = raw if code == 0 else zlib.compress(_predicted(raw))
        chunk = raw if len(packed) >= len(raw) else packed
        chunks.append(struct.pack("<ii", corner[1] + first, len(chunk)) + chunk)
    order = range(len(chunks) - 1, -1, -1) if decreasing else range(len(chunks))
    offsets, body = [0] * len(chunks), b""
    for i in order:
        offsets[i] = len(header) + 8 * len(chunks) + len(body)
        body += chunks[i]
    path.write_bytes(header + struct.pack(f"<{len(chunks)}Q", *offsets) + body)


def _attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def _predicted(raw):
    data = np.frombuffer(raw[0::2] + raw[1::2], np.uint8).copy()
    data[1:] = data[1:] - data[:-1] + np.uint8(128)
    return data.tobytes()
