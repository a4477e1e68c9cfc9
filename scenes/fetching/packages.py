"""Files of Debian packages: installed ones, or unpacked into a temporary folder, which needs no root."""
import contextlib
import shutil
import subprocess
import tempfile
from pathlib import Path

from . import FetchError

SECONDS_ALLOWED = 1800


def run(*command, folder):
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=SECONDS_ALLOWED)
    except subprocess.TimeoutExpired:
        raise FetchError(f"{command[0]} took longer than {SECONDS_ALLOWED} s") from None
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines()
        raise FetchError(f"{command[0]} failed: {lines[-1] if lines else f'exit code {done.returncode}'}")


def unpack(package, folder):
    run("apt-get", "download", package, folder=folder)
    (archive,) = folder.glob("*.deb")
    run("dpkg-deb", "-x", str(archive), str(folder), folder=folder)


@contextlib.contextmanager
def package_file(package, path, say):
    """A readable path of the file that the package installs as `path`, for as long as the context lasts."""
    installed = Path(path)
    if installed.is_file():
        yield installed
        return
    hint = f"install the Debian package {package} (ci/bootstrap.sh does), or give --from a folder with {installed.name}"
    if not (shutil.which("apt-get") and shutil.which("dpkg-deb")):
        raise FetchError(f"{path} is missing: {hint}")
    say(f"asking apt for the Debian package {package}")
    with tempfile.TemporaryDirectory(prefix="volmark_fetch_") as folder:
        try:
            unpack(package, Path(folder))
        except FetchError as error:
            raise FetchError(f"{path} is missing and {error}: {hint}") from None
        unpacked = Path(folder) / path.lstrip("/")
        if not unpacked.is_file():
            raise FetchError(f"the Debian package {package} has no {path}")
        yield unpacked
