"""Dask workers: those of a scheduler that runs somewhere, or some of our own on this machine. Each holds one unit of the
resource GPU and every batch needs one, so that a worker measures one thing at a time."""

from __future__ import annotations

import logging
import os
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import Future
from pathlib import Path
from typing import Any

from ..errors import InputError
from . import batch_task
from .progress import Progress

RESOURCE = "GPU"
_MOST_STARTS = 4
"""Of a local worker that keeps dying within _SECONDS_OF_HEALTH of its start."""
_SECONDS_OF_HEALTH = 60.0
_SECONDS_TO_CONNECT = 10
_SECONDS_TO_STOP = 20.0
_SECONDS_TO_FETCH = 5.0
_SECONDS_BETWEEN_LOOKS = 0.1
"""For workers, where none is at work."""
_SECONDS_BETWEEN_HINTS = 60.0


def _import_distributed():
    try:
        import cloudpickle
        import distributed
    except ImportError as error:
        raise InputError(f"grids on several workers need Dask distributed (Debian's package python3-distributed): {error}; "
                         f"volmark run and --slurm work without it") from None
    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what matters is said by us, in one line
    cloudpickle.register_pickle_by_value(batch_task)
    return distributed


class Workers:
    """The workers of a scheduler; those that come later are taken too."""

    def __init__(self, address: str):
        distributed = _import_distributed()
        try:
            self._client = distributed.Client(address, timeout=_SECONDS_TO_CONNECT)
        except (OSError, ValueError, TimeoutError) as error:
            raise InputError(f"--scheduler: {address}: no scheduler answers ({str(error)[:80]})") from None
        self._address = address
        self._last_hint = time.monotonic()

    def present(self) -> set[str]:
        """Addresses of those that have the resource."""
        workers = self._client.scheduler_info()["workers"]
        return {address for address, facts in workers.items() if facts.get("resources", {}).get(RESOURCE)}

    def submit(self, command: list[str], worker: str) -> Future:
        # Pinned: a task that only prefers a worker stays for ever where all workers died before another came.
        return self._client.submit(batch_task.run_batch, command, os.getcwd(), resources={RESOURCE: 1}, workers=[worker],
                                   pure=False)

    def wait(self, futures: list[Future], seconds: float) -> list[tuple[Future, dict[str, Any]]]:
        """What run_batch returned, of those that are done; at once when one is. Without an exit code if Dask gave it up."""
        from distributed import TimeoutError as Timeout, wait
        if not futures:
            time.sleep(min(seconds, _SECONDS_BETWEEN_LOOKS))
            return []
        try:
            done = wait(futures, timeout=seconds, return_when="FIRST_COMPLETED").done
        except Timeout:
            return []
        outcomes = []
        for future in done:
            try:
                outcomes.append((future, future.result(timeout=_SECONDS_TO_FETCH)))
            except Timeout:  # its worker died with the result: absent from now on
                continue
            except Exception as error:  # whatever the worker's side raised
                outcomes.append((future, {"exit": None, "said": f"{type(error).__name__}: {error}"[:200]}))
        return outcomes

    def cancel(self, futures: list[Future]) -> None:
        self._client.cancel(futures)

    def tend(self, progress: Progress) -> None:
        """Called now and then."""
        if self.present():
            self._last_hint = time.monotonic()
        elif time.monotonic() - self._last_hint > _SECONDS_BETWEEN_HINTS:
            self._last_hint = time.monotonic()
            progress.say(f"waiting: no worker is there; dask worker {self._address} --resources {RESOURCE}=1 --nthreads 1 "
                         f"starts one")

    @property
    def hopeless(self) -> bool:
        """No worker is there and none will come."""
        return False

    def close(self) -> None:
        self._client.close()


class LocalWorkers(Workers):
    """A scheduler in this process, and worker processes that live as long as it."""

    def __init__(self, devices: list[str]):
        """A worker for each; an empty text leaves the choice of the device to volmark."""
        distributed = _import_distributed()
        self._cluster = distributed.LocalCluster(n_workers=0, host="127.0.0.1", dashboard_address=None)
        self._folder = tempfile.TemporaryDirectory(prefix="volmark_grid_")
        self._processes = [_WorkerProcess(self._cluster.scheduler_address, Path(self._folder.name), number, device)
                           for number, device in enumerate(devices)]
        super().__init__(self._cluster.scheduler_address)

    def tend(self, progress: Progress) -> None:
        for process in self._processes:
            process.start_again_if_dead(progress)

    @property
    def hopeless(self) -> bool:
        return all(process.given_up for process in self._processes)

    def close(self) -> None:
        """Stops what runs as Ctrl-C would, so that no claim or half-written folder stays."""
        for process in self._processes:
            process.interrupt()
        deadline = time.monotonic() + _SECONDS_TO_STOP
        for process in self._processes:
            process.end(deadline)
        super().close()
        self._cluster.close()
        self._folder.cleanup()


class _WorkerProcess:
    def __init__(self, scheduler: str, folder: Path, number: int, device: str):
        self._name = f"worker {number + 1}"
        self._log = folder / f"worker_{number}.log"
        self._environment = {**os.environ, batch_task.DEVICE_VARIABLE: device}
        # No nanny: it would start workers again without a limit, and outlive us.
        self._command = ["setpriv", "--pdeathsig", "KILL", sys.executable, "-m", "distributed.cli.dask_worker", scheduler,
                         "--no-nanny", "--nthreads", "1", "--resources", f"{RESOURCE}=1", "--no-dashboard",
                         "--memory-limit", "0", "--local-directory", str(folder), "--death-timeout", "60"]
        self._starts = 0
        self._start()

    def _start(self) -> None:
        self._starts += 1
        self._started = time.monotonic()
        with open(self._log, "ab") as log:
            # A session of its own: Ctrl-C on the terminal is for us alone, who then stop the workers in order.
            self._process = subprocess.Popen(self._command, stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                             env=self._environment, start_new_session=True)

    @property
    def given_up(self) -> bool:
        return self._starts >= _MOST_STARTS and self._process.poll() is not None

    def start_again_if_dead(self, progress: Progress) -> None:
        code = self._process.poll()
        if code is None:
            return
        if time.monotonic() - self._started > _SECONDS_OF_HEALTH:
            self._starts = 0
        if self._starts >= _MOST_STARTS:
            return
        progress.say(f"{self._name} ended ({_cause(code, self._log)}): started again")
        self._start()

    def interrupt(self) -> None:
        self._signal(signal.SIGINT)

    def end(self, deadline: float) -> None:
        try:
            self._process.wait(max(0.1, deadline - time.monotonic()))
        except subprocess.TimeoutExpired:
            self._signal(signal.SIGKILL)
            self._process.wait()

    def _signal(self, number: int) -> None:
        try:
            os.killpg(self._process.pid, number)
        except ProcessLookupError:
            pass


def _cause(code: int, log: Path) -> str:
    if code < 0:
        return f"signal {-code}"
    said = log.read_text(errors="replace").strip().splitlines()
    return f"exit code {code}" + (f": {said[-1][:100]}" if said else "")
