"""Measure the service over HTTP, as users start it: a run with its figures, and the time until it is ready.

python -m benchmarks service
"""

import itertools
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from benchmarks.measure import Figure, ratios, rounds
from benchmarks.problem import engine, kernels_alone
from thetascope.client import Client

ROOT = Path(__file__).parents[1]


@contextmanager
def service(data: Path, log: IO[str] | None = None) -> Iterator[tuple[str, float]]:
    """Start a service in a new process; yield its address and the seconds until it answered.

    Its log lines go to the file `log`, if it is given.
    """
    more = {"PYTHONUNBUFFERED": "1", "THETASCOPE_PREPARE": "0"}
    environment = os.environ | {"THETASCOPE_DATA": str(data)} | more
    command = [sys.executable, "-m", "thetascope.cli.main", "serve", "--port", "0"]
    begin = time.perf_counter()
    process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=log, text=True)
    try:
        line = process.stdout.readline()
        if "http://" not in line:
            raise RuntimeError(f"the service did not start: {line!r}")
        address = line.split(" at ")[1].split("/ ")[0]
        with Client(address) as client:
            client.health()
        yield address, time.perf_counter() - begin
    finally:
        process.terminate()
        process.wait(20)
        process.stdout.close()


def figures() -> Iterator[Figure]:
    """Yield the time of a complete run over HTTP and the time until the service is ready."""
    with tempfile.TemporaryDirectory(prefix="thetascope-benchmark-") as data:
        with service(Path(data)) as (address, _):
            yield whole(address)
        yield ready(Path(data))


def whole(address: str, count: int = 15) -> Figure:
    """Return the time of a POST with a new seed each time, so that the store cannot answer, and GET of all figures."""
    call, _ = kernels_alone(engine())
    seeds = itertools.count(1000)
    with Client(address) as client:

        def request() -> None:
            run = client.run("zhao-2012", {"seed": next(seeds)})
            if run["status"] != "done":
                raise AssertionError(run)
            for name in names:
                client.request("GET", f"/api/runs/{run['id']}/figures/{name}")

        first = client.run("zhao-2012")
        listed = client.get(f"/api/runs/{first['id']}/figures")["figures"]
        names = [f["name"] for f in listed]
        seconds = rounds({"service": request, "kernels": call}, count)
    what = f"POST of zhao-2012 (100 s at 1 ms) and GET of its {len(names)} figures ÷ kernels"
    return Figure.of(what, ratios(seconds, "service", "kernels"), "≤ 15")


def ready(data: Path, count: int = 5) -> Figure:
    """Return the time from the start of the process to the first answer, with the files of an earlier start."""
    seconds = []
    for _ in range(count):
        with service(data) as (_, took):
            seconds.append(took)
    return Figure.of("service ready, second and later starts", seconds, "≤ 2 s", "s")
