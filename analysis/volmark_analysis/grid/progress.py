"""How far a grid is: one line that is drawn over on a terminal, plain lines elsewhere."""

from __future__ import annotations

import sys
import time
from collections import deque

_PLAIN_INTERVAL = 15.0
_TERMINAL_INTERVAL = 0.2
_BATCHES_FOR_PACE = 20
"""The time left follows the latest batches: those that were done before are passed over quickly."""


def duration_text(seconds: float) -> str:
    whole = int(seconds + 0.5)
    if whole >= 3600:
        return f"{whole // 3600} h {whole // 60 % 60:02} min"
    return f"{whole // 60} min {whole % 60:02} s" if whole >= 60 else f"{whole} s"


class Progress:
    def __init__(self, stream=None):
        self._stream = sys.stderr if stream is None else stream
        self._terminal = self._stream.isatty()
        self._pace: deque[tuple[int, float]] = deque(maxlen=_BATCHES_FOR_PACE)
        self._points = self._done = 0
        self._last = 0.0
        self._drawn = False
        self._what = ""

    def start(self, points: int, what: str = "") -> None:
        """`what`: in front of every line."""
        self._points, self._done, self._what = points, 0, what
        self._pace.clear()
        self._last = time.monotonic()

    def advance(self, points: int, seconds: float) -> None:
        """A batch is done."""
        self._done += points
        self._pace.append((points, seconds))

    def line(self, workers: int) -> str:
        text = f"{self._what}{self._done} of {self._points} points, {workers} worker{'' if workers == 1 else 's'}"
        points, seconds = (sum(values) for values in zip(*self._pace)) if self._pace else (0, 0.0)
        if points and workers and self._done < self._points:
            text += f", {duration_text((self._points - self._done) * seconds / points / workers)} left"
        return text

    def show(self, workers: int) -> None:
        now = time.monotonic()
        if now - self._last < (_TERMINAL_INTERVAL if self._terminal else _PLAIN_INTERVAL):
            return
        self._last = now
        self._stream.write(f"\r\033[K{self.line(workers)}" if self._terminal else f"{self.line(workers)}\n")
        self._stream.flush()
        self._drawn = self._terminal

    def say(self, line: str) -> None:
        """A line that stays."""
        self.finish()
        self._stream.write(f"{line}\n")
        self._stream.flush()

    def finish(self) -> None:
        if self._drawn:
            self._stream.write("\r\033[K")
        self._drawn = False
