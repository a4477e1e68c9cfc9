#!/usr/bin/env python3
"""Brings the volumes of scenes: from Debian packages, over http(s), or from a folder.

A volume is written only if its voxels have the SHA-512 that the scene file names, under the name the scene file
gives it, and all at once; a file of that name with other voxels is replaced. A headerless file gets an NRRD header
in front. A download that was stopped (Ctrl-C, a lost connection) stays beside it as FILE.part, and the same command
goes on from there if the server still has the same file. http_proxy, https_proxy and no_proxy are honoured.

Without --to a volume counts as here if it is in one of the folders that volmark searches: beside the scene files,
in those of VOLMARK_DATA, in scenes/data. States of --list: here, generated, missing, wrong (other voxels than the
scene file says), unchecked (no SHA-512 is given, or none can be computed from this kind of file).

exit codes: 0 all volumes are there, 1 at least one could not be brought, 2 bad input and nothing was tried,
130 interrupted.
"""
import argparse
import contextlib
import os
import sys
import tarfile
import zlib
from pathlib import Path

from fetching import FetchError
from fetching.download import download
from fetching.inv3 import read_inv3
from fetching.packages import package_file
from fetching.part_file import PartFile
from fetching.progress import Progress
from fetching.scene import find_scene, read_scenes
from fetching.voxels import CHUNK_BYTES, UncheckableError, nrrd_header, voxels_sha512

SCENES = Path(__file__).resolve().parent


def folders_of(to):
    """Where volumes are looked for, in order; the last one is where they are written."""
    if to:
        return [to]
    listed = os.environ.get("VOLMARK_DATA", "").split(":")
    return [SCENES, *(Path(part) for part in listed if part), SCENES / "data"]


def find_volume(scene, folders):
    return next((folder / scene.file for folder in folders if (folder / scene.file).is_file()), None)


def state_of(scene, path):
    """Of a volume file; None for a missing one."""
    if scene.is_generated:
        return "generated"
    if path is None:
        return "missing"
    if not scene.sha512:
        return "unchecked"
    try:
        return "here" if voxels_sha512(path, scene.file, scene.raw_offset) == scene.sha512 else "wrong"
    except UncheckableError:
        return "unchecked"


def commit(scene, part, place):
    found = voxels_sha512(part.path, scene.file, scene.raw_offset)
    if found != scene.sha512:
        part.discard()
        shown = f"SHA-512 is {found[:16]}..." if found else "file is damaged"
        raise FetchError(f"{place}: the voxels' {shown}, the scene file says {scene.sha512[:16]}...")
    part.commit()


def header_of(scene, origin):
    """What goes in front of a headerless file."""
    return nrrd_header(scene.name, origin, scene.layout) if scene.layout else b""


def fetch_url(scene, target, progress):
    size = scene.layout.bytes if scene.layout else None
    with PartFile(target, header_of(scene, scene.url)) as part:
        try:
            download(scene.url, part, size, progress)
        except KeyboardInterrupt:
            progress.say(f"stopped at {part.body_bytes / 1e6:.1f} MB; the same command goes on from there")
            raise
        commit(scene, part, scene.url)


def chunks_of(path):
    with open(path, "rb") as file:
        while chunk := file.read(CHUNK_BYTES):
            yield chunk


def member_of(path, name):
    """Bytes of one file in a tar archive."""
    try:
        with tarfile.open(path) as archive:
            member = archive.extractfile(name)
            if member:
                return member.read()
    except (tarfile.TarError, EOFError, zlib.error, KeyError):
        pass
    raise FetchError(f"{path}: there is no file {name} in it")


def contents_of(scene, path):
    """Header, body in chunks, and length of the body that a file becomes."""
    if path.suffix == ".inv3":
        layout, voxels = read_inv3(path)
        return nrrd_header(scene.name, f"the Debian package {scene.package}", layout), [voxels], len(voxels)
    if scene.package_member and path.name != scene.file:
        content = member_of(path, scene.package_member)
        return b"", [content], len(content)
    size = path.stat().st_size
    if path.name == scene.file or not scene.layout:
        return b"", chunks_of(path), size
    if size != scene.layout.bytes:
        raise FetchError(f"{path}: found {size} bytes, expected {scene.layout.bytes}")
    return header_of(scene, scene.url), chunks_of(path), size


def copy_file(scene, path, target, progress):
    header, chunks, size = contents_of(scene, path)
    with PartFile(target, header) as part:
        try:
            part.restart()
            part.require_space(size)
            progress.start(0, size)
            for chunk in chunks:
                part.append(chunk)
                progress.advance(len(chunk))
            progress.end()
        except BaseException:
            part.discard()
            raise
        commit(scene, part, path)


@contextlib.contextmanager
def file_in_folder(scene, folder):
    """The volume's file itself, or that of its source."""
    names = [scene.file, Path(scene.package_file).name, scene.url.rpartition("/")[2]]
    for name in filter(None, names):
        if (folder / name).is_file():
            yield folder / name
            return
    raise FetchError(f"{folder}: there is none of {', '.join(filter(None, names))}")


def fetch(scene, folders, source, progress):
    """Makes sure that the scene's volume is there. Returns one line that says where."""
    if scene.is_generated:
        return f"{scene.name}: its volume is generated, there is nothing to fetch"
    found = find_volume(scene, folders)
    state = state_of(scene, found)
    if state == "here":
        return f"{scene.name}: {found} is there already"
    if not scene.sha512:
        raise FetchError("its scene file names no sha512, so that nothing can be checked")
    if state == "unchecked":
        raise FetchError(f"{found} is there and its voxels can't be checked: it stays")
    target = folders[-1] / scene.file
    if source:
        with file_in_folder(scene, source) as path:
            copy_file(scene, path, target, progress)
    elif scene.package:
        with package_file(scene.package, scene.package_file, progress.say) as path:
            copy_file(scene, path, target, progress)
    elif scene.url:
        fetch_url(scene, target, progress)
    else:
        raise FetchError(f"{scene.file} is not published anywhere, so it can't be fetched. {scene.note}".rstrip())
    if found and found != target:
        progress.say(f"note: {found} has other voxels and is found first")
    return f"{scene.name}: wrote {target}"


def fetch_all(scenes, folders, source):
    """Exit code. Goes on after a volume that could not be brought."""
    failed = False
    for scene in scenes:
        try:
            print(fetch(scene, folders, source, Progress(scene.name)), flush=True)
        except (FetchError, OSError) as error:
            print(f"fetch.py: {scene.name}: {error}", file=sys.stderr, flush=True)
            failed = True
    return 1 if failed else 0


def size_text(scene, path):
    size = path.stat().st_size if path else scene.layout.bytes if scene.layout else None
    return f"{size / 1e6:.1f} MB" if size else "-"


def source_text(scene):
    if scene.package:
        return f"Debian package {scene.package}"
    return scene.url or ("-" if scene.is_generated else "not published")


def list_scenes(scenes, folders):
    rows = [("name", "state", "size", "license", "source")]
    for scene in scenes.values():
        path = None if scene.is_generated else find_volume(scene, folders)
        license_text = scene.license or ("-" if scene.is_generated else "not stated")
        rows.append((scene.name, state_of(scene, path), size_text(scene, path), license_text, source_text(scene)))
    widths = [max(map(len, column)) for column in zip(*rows)]
    for name, state, size, license_text, source in rows:
        cells = [name.ljust(widths[0]), state.ljust(widths[1]), size.rjust(widths[2]), license_text.ljust(widths[3])]
        print("  ".join([*cells, source]))


def parse(arguments):
    summary, _, more = __doc__.partition("\n\n")
    parser = argparse.ArgumentParser(
        prog="fetch.py", description=summary, epilog=more, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="scenes whose volumes to bring")
    parser.add_argument("--all", action="store_true", help="all scenes whose volumes are published somewhere")
    parser.add_argument("--list", action="store_true", help="show every scene: state, size, license, source")
    parser.add_argument("--to", type=Path, metavar="DIR", help="look and write there only; default: scenes/data")
    parser.add_argument("--from", type=Path, dest="source", metavar="DIR", help="copy from this folder instead")
    options = parser.parse_args(arguments)
    if bool(options.names) + options.all + options.list != 1:
        parser.error("give names of scenes, --all or --list")
    if options.source and (options.list or not options.source.is_dir()):
        parser.error(f"--from: found {options.source}, allowed: a folder, and not with --list")
    return options


def main(arguments=None):
    options = parse(arguments)
    folders = folders_of(options.to)
    try:
        scenes = read_scenes(SCENES)
        wanted = [find_scene(scenes, name) for name in dict.fromkeys(options.names)]
    except (FetchError, OSError) as error:
        print(f"fetch.py: {error}", file=sys.stderr)
        return 2
    try:
        if options.list:
            list_scenes(scenes, folders)
            return 0
        if options.all:
            wanted = [scene for scene in scenes.values() if scene.is_fetchable]
        return fetch_all(wanted, folders, options.source)
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
