"""A volume on its way: FILE.part grows beside FILE and takes its name when it is whole and right."""
import fcntl
import json
import os
import shutil

from . import FetchError


class PartFile:
    """FILE.part and, for a download that can go on later, FILE.part.from with what the server said of it.

    `header` is written in front of the body that is appended. Only one process at a time can have it.
    """

    def __init__(self, target, header=b""):
        self.target = target
        self.path = target.with_name(target.name + ".part")
        self._origin_path = target.with_name(target.name + ".part.from")
        self._header = header
        target.parent.mkdir(parents=True, exist_ok=True)
        # A link in the part's place must not lead the bytes elsewhere.
        flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
        self._file = os.fdopen(os.open(self.path, flags, 0o666), "r+b", buffering=0)
        try:
            self._lock()
            if self._file.read(len(header)) != header or self.origin is None:
                self.restart()
            self._file.seek(0, os.SEEK_END)
        except BaseException:
            self._file.close()
            raise

    def _lock(self):
        busy = FetchError(f"{self.path}: another process is writing it")
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise busy from None
        # Who had the lock may have finished: then what is open here is the volume itself.
        if not os.path.exists(self.path) or os.stat(self.path).st_ino != os.fstat(self._file.fileno()).st_ino:
            raise busy

    def __enter__(self):
        return self

    def __exit__(self, error, *rest):
        if error and self.body_bytes <= 0:
            self.discard()
        self._file.close()

    @property
    def body_bytes(self):
        return os.fstat(self._file.fileno()).st_size - len(self._header)

    @property
    def origin(self):
        """What was said of the body's source when it began; None if nothing sure is known."""
        try:
            return json.loads(self._origin_path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None

    def restart(self, origin=None):
        """Throws the body away."""
        self._origin_path.unlink(missing_ok=True)
        self._file.seek(0)
        self._file.truncate(0)
        self._write(self._header)
        if origin is not None:
            self._origin_path.write_text(json.dumps(origin), encoding="utf-8")

    def require_space(self, wanted):
        free = shutil.disk_usage(self.path.parent).free
        if wanted > free:
            raise FetchError(f"{self.path.parent}: {wanted / 1e6:.1f} MB are needed, {free / 1e6:.1f} MB are free")

    def append(self, chunk):
        self._write(chunk)

    def _write(self, data):
        view = memoryview(data)
        while view:
            view = view[self._file.write(view) :]

    def commit(self):
        """The part becomes the file: all of it or nothing, even if the power fails."""
        os.fsync(self._file.fileno())
        os.replace(self.path, self.target)
        self._origin_path.unlink(missing_ok=True)
        folder = os.open(self.target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)

    def discard(self):
        self._origin_path.unlink(missing_ok=True)
        self.path.unlink(missing_ok=True)
