"""Measure the memory of the service during a long session: as many rows as an hour at ten times real time.

python -m benchmarks memory                          200 times real time, which takes three minutes
SPEED=10 python -m benchmarks memory                 the full hour
"""

import os
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

from benchmarks.live import EXPERIMENT, service
from benchmarks.measure import Figure
from benchmarks.watchers import Watchers
from thetascope.client import Client

PLAYED = 36_000.0  # s of simulated time
PARTS = 6


def figures() -> Iterator[Figure]:
    """Yield the resident memory at the end of each sixth after the first two, relative to that after the second.

    All buffers are full by then.
    """
    speed = float(os.environ.get("SPEED", "200"))
    with service(1) as (process, address), Client(address) as client:
        begin = resident(process)
        session = client.post("/api/sessions", {"experiment": EXPERIMENT, "speed": speed})
        watchers, megabytes = Watchers(), []
        viewer = watchers.connect(int(address.rpartition(":")[2]), session["links"]["stream"], session["token"])
        try:
            for _ in range(PARTS):
                end = time.monotonic() + PLAYED / speed / PARTS
                while time.monotonic() < end:
                    watchers.run(10.0)
                    viewer.clear()
                megabytes.append(resident(process))
            played = client.get(session["links"]["self"])["t"]
        finally:
            watchers.close()
    yield Figure.of("memory of the service as it starts, MB", [begin])
    yield Figure.of("memory after a third of the time, MB", [megabytes[1]])
    yield Figure.of(
        f"memory later, of {played:.0f} s played ÷ after a third", [m / megabytes[1] for m in megabytes[2:]], "flat"
    )


def resident(process: subprocess.Popen) -> float:
    """Return the resident memory of a process in MB."""
    line = next(
        line for line in Path(f"/proc/{process.pid}/status").read_text().splitlines() if line.startswith("VmRSS")
    )
    return int(line.split()[1]) / 1024
