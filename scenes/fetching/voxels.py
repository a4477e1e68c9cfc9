"""Headers of volume files, and the SHA-512 of the voxels behind them."""
import gzip
import hashlib
import struct
import zlib

CHUNK_BYTES = 1 << 20
MAXIMUM_HEADER_BYTES = 1 << 16
NIFTI_HEADER_BYTES = 348


class UncheckableError(Exception):
    """The voxels can't be told from the file without more knowledge than is here."""


def nrrd_header(content, origin, layout):
    """Of a file whose voxels follow. `origin` is an address or a package."""
    scalar_type = "float" if layout.type == "float32" else layout.type
    return (
        f"NRRD0004\n# From {origin}\ntype: {scalar_type}\ndimension: 3\n"
        f"sizes: {' '.join(map(str, layout.dims))}\nspacings: {' '.join(f'{s:.17g}' for s in layout.spacing_mm)}\n"
        f"endian: little\nencoding: raw\ncontent: {content}\n\n"
    ).encode("ascii", "replace")


def start_of_nrrd_voxels(file):
    """Moves behind the header. Returns the encoding, "raw" or "gzip"."""
    if not file.readline(MAXIMUM_HEADER_BYTES).startswith(b"NRRD000"):
        raise ValueError("not an NRRD file")
    fields = {}
    while (line := file.readline(MAXIMUM_HEADER_BYTES)) not in (b"", b"\n", b"\r\n"):
        if file.tell() > MAXIMUM_HEADER_BYTES:
            raise ValueError("the header has no end")
        name, _, value = line.decode("utf-8", "replace").partition(":")
        fields[name.strip().lower()] = value.strip().lower()
    apart = {"data file", "datafile", "byte skip", "byteskip", "line skip", "lineskip"} & set(fields)
    if line == b"" and not apart:
        raise ValueError("cut off within the header")
    encoding = {"gz": "gzip"}.get(fields.get("encoding"), fields.get("encoding"))
    if apart or encoding not in ("raw", "gzip") or fields.get("endian") == "big":
        raise UncheckableError("its voxels are not simply behind its header, little-endian, raw or gzip")
    return encoding


def skip_nifti_header(file):
    header = file.read(NIFTI_HEADER_BYTES)
    if header[:4] != struct.pack("<i", NIFTI_HEADER_BYTES):
        raise UncheckableError("it is not a little-endian NIfTI-1 file")
    (offset,) = struct.unpack_from("<f", header, 108)
    file.seek(int(offset))


def hash_of_rest(file):
    digest = hashlib.sha512()
    while chunk := file.read(CHUNK_BYTES):
        digest.update(chunk)
    return digest.hexdigest()


def hash_of_file(file, name, raw_offset):
    if raw_offset >= 0:
        file.seek(raw_offset)
        return hash_of_rest(file)
    if name.endswith((".nrrd", ".nhdr")):
        if start_of_nrrd_voxels(file) == "gzip":
            file = gzip.GzipFile(fileobj=file)
        return hash_of_rest(file)
    if name.endswith((".nii", ".nii.gz")):
        if name.endswith(".gz"):
            file = gzip.GzipFile(fileobj=file)
        skip_nifti_header(file)
        return hash_of_rest(file)
    raise UncheckableError("its name ends in none of .nrrd, .nhdr, .nii, .nii.gz")


def voxels_sha512(path, name, raw_offset=-1):
    """Of a file whose name will be `name`: it decides the format, unless a raw file's offset is given. Damaged
    files hash to "". Throws UncheckableError."""
    try:
        with open(path, "rb", buffering=CHUNK_BYTES) as file:
            return hash_of_file(file, name, raw_offset)
    except (EOFError, gzip.BadGzipFile, zlib.error, struct.error, OverflowError, ValueError):
        return ""
