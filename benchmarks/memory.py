"""Memory of the service while one session plays for long: as many rows as an hour at ten times real time brings.

python -m benchmarks memory                          200 times real time, so that it takes three minutes
SPEED=10 python -m benchmarks memory                 the hour itself
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
    """Resident memory at the end of each sixth after the first two, over that at the end of the second, when all that is kept is full."""
    speed = float(os.environ.get("SPEED", "200"))
    with service(1) as (process, address), Client(address) as client:
        begin = resident(process)
        session = client.post("/api/sessions", {"experiment": EXPERIMENT, "speed": speed})
        watchers, found = Watchers(), []
        viewer = watchers.connect(
            int(address.rpartition(":")[2]), f"{session['links']['stream']}?token={session['token']}"
        )
        try:
            for _ in range(PARTS):
                end = time.monotonic() + PLAYED / speed / PARTS
                while time.monotonic() < end:
                    watchers.run(10.0)
                    viewer.clear()
                found.append(resident(process))
            played = client.get(session["links"]["self"])["t"]
        finally:
            watchers.close()
    yield Figure.of("memory of the service as it starts, MB", [begin])
    yield Figure.of("memory after a third of the time, MB", [found[1]])
    yield Figure.of(
        f"memory later, of {played:.0f} s played ÷ after a third", [m / found[1] for m in found[2:]], "flat"
    )


def resident(process: subprocess.Popen) -> float:
    """Resident memory of a process, MB."""
    line = next(
        line for line in Path(f"/proc/{process.pid}/status").read_text().splitlines() if line.startswith("VmRSS")
    )
    return int(line.split()[1]) / 1024
