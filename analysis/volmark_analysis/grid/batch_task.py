"""What a worker does with a batch. Sent to workers as a whole, so that they need no copy of this package: it must import
nothing beyond Python's own library."""

from __future__ import annotations

import os
import subprocess
import time
from typing import Any

DEVICE_VARIABLE = "VOLMARK_GRID_DEVICE"
"""Where a machine has several devices, each of its workers has its own in this variable."""


def run_batch(command: list[str], folder: str) -> dict[str, Any]:
    """Runs `volmark run` in `folder`. It dies with this process: a worker that was killed must not go on measuring beside the
    one that takes over."""
    device = os.environ.get(DEVICE_VARIABLE)
    if device:
        command = [*command, "--device", device]
    begin = time.monotonic()
    done = subprocess.run(["setpriv", "--pdeathsig", "KILL", *command], capture_output=True, text=True, errors="replace",
                          stdin=subprocess.DEVNULL, cwd=folder if os.path.isdir(folder) else None)
    said = [line for line in done.stderr.splitlines() if line.strip()]
    return {"exit": done.returncode, "said": said[-1] if said else "", "seconds": time.monotonic() - begin}
