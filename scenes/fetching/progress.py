"""How far a transfer is: a bar on a terminal, a line every few seconds elsewhere."""
import sys
import time

SECONDS_BETWEEN = {True: 0.1, False: 5.0}
BAR_CELLS = 24


def clock_text(seconds):
    minutes, seconds = divmod(int(seconds + 0.5), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{seconds:02}" if hours else f"{minutes}:{seconds:02}"


class Progress:
    """Of one volume. Bytes; `total` None if unknown. Writes to standard error."""

    def __init__(self, name):
        self._name = name
        self._stream = sys.stderr
        self._is_terminal = self._stream.isatty()
        self._open_line = False

    def start(self, done, total):
        self._done, self._start_bytes, self._total = done, done, total
        self._started = self._shown = time.monotonic()
        if self._is_terminal:
            self._show()

    def advance(self, count):
        self._done += count
        if time.monotonic() - self._shown >= SECONDS_BETWEEN[self._is_terminal]:
            self._show()

    def end(self):
        """The last state stays on the screen."""
        self._show()
        self._close_line()

    def say(self, text):
        self._close_line()
        print(f"{self._name}: {text}", file=self._stream, flush=True)

    def _close_line(self):
        if self._open_line:
            print(file=self._stream, flush=True)
        self._open_line = False

    def _show(self):
        self._shown = time.monotonic()
        text = self._text()
        if self._is_terminal:
            self._stream.write(f"\r\x1b[K{text}")
            self._stream.flush()
            self._open_line = True
        else:
            print(text, file=self._stream, flush=True)

    def _text(self):
        seconds = max(self._shown - self._started, 1e-3)
        rate = (self._done - self._start_bytes) / seconds
        rate_text = f"{rate / 1e6:.1f} MB/s"
        if not self._total:
            return f"{self._name}: {self._done / 1e6:.1f} MB  {rate_text}"
        share = self._done / self._total
        bar = "#" * int(share * BAR_CELLS)
        left = f"  {clock_text((self._total - self._done) / rate)} left" if rate else ""
        amount = f"{self._done / 1e6:.1f} of {self._total / 1e6:.1f} MB"
        return f"{self._name}: [{bar:.<{BAR_CELLS}}] {int(share * 100):3} %  {amount}  {rate_text}{left}"
