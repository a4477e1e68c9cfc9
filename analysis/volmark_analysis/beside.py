"""Work that a second core can do meanwhile."""

from __future__ import annotations

import multiprocessing
from typing import Callable

from .errors import InputError


class Beside:
    """Calls `work` in a forked copy of this process, which sees all its data; only what it writes to disk lasts.

    with Beside(work):  # what is done here runs at the same time
        ...
    At the end of the block an error of `work` is raised here (OSError, InputError, or RuntimeError with the text of any
    other). After an error in the block the copy is ended.
    """

    def __init__(self, work: Callable[[], None]):
        context = multiprocessing.get_context("fork")
        self._receiver, self._sender = context.Pipe(duplex=False)
        self._process = context.Process(target=self._run, args=(work,), daemon=True)

    def _run(self, work: Callable[[], None]) -> None:
        try:
            work()
        except (OSError, InputError) as error:
            self._sender.send(error)
        except Exception as error:  # others may not survive being sent
            self._sender.send(RuntimeError(repr(error)))
        else:
            self._sender.send(None)

    def __enter__(self) -> Beside:
        self._process.start()
        self._sender.close()  # the copy's end alone is left: if the copy dies, recv() ends
        return self

    def __exit__(self, kind, error, trace) -> None:
        if kind is not None:
            self._process.terminate()
            self._process.join()
            return
        try:
            failure = self._receiver.recv()
        except EOFError:
            failure = RuntimeError("the process that writes tables and plots has ended early")
        self._process.join()
        if failure is not None:
            raise failure
