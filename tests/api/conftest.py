"""The service as users run it: started by the command line, addressed over HTTP."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import pytest

from tests.api import prepared_services
from thetascope.client import Client

ROOT = Path(__file__).parents[2]


def _started(
    arguments: list[str], environment: dict[str, str], stderr: IO[bytes] | None, own_workers: bool
) -> subprocess.Popen | prepared_services.Service:
    if hasattr(os, "fork"):
        return prepared_services.Service(arguments, environment, stderr, own_workers)
    command = [sys.executable, "-m", "thetascope.cli.main", *arguments]
    return subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=stderr, text=True)


Started = tuple[subprocess.Popen | prepared_services.Service, str]


@contextmanager
def process(
    data: Path, stderr: IO[bytes] | None = None, own_workers: bool = False, **settings: object
) -> Iterator[Started]:
    """Start the service on a free port; return its process and address. Settings as in backend/thetascope/settings.py.

    `stderr` gets its log lines. With `own_workers` its worker processes are its descendants. Computations have more
    time than by default: the tests share the processors.
    """
    environment = {name: value for name, value in os.environ.items() if not name.startswith("THETASCOPE_")}
    defaults = {"prepare": 0, "job_seconds": 300, "job_cpu": 300}
    environment |= {f"THETASCOPE_{name.upper()}": str(value) for name, value in {**defaults, **settings}.items()}
    environment |= {"THETASCOPE_DATA": str(data), "PYTHONUNBUFFERED": "1"}
    started = _started(["serve", "--port", "0"], environment, stderr, own_workers)
    try:
        line = started.stdout.readline()
        assert "http://" in line, f"the service did not start: {line!r}"
        yield started, line.split(" at ")[1].split("/ ")[0]
    finally:
        started.terminate()
        started.wait(60)
        started.stdout.close()


@contextmanager
def service(data: Path, **settings: object) -> Iterator[str]:
    """Start the service on a free port and return its address."""
    with process(data, **settings) as (_, started):
        yield started


@pytest.fixture(scope="session")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Return the address of one service for tests without settings of their own; bodies are limited to 200 kB."""
    with service(tmp_path_factory.mktemp("service"), max_body="200k", wait=60) as started:
        yield started


@pytest.fixture
def client(address: str) -> Iterator[Client]:
    with Client(address, timeout=120) as made:
        yield made


@pytest.fixture(scope="session")
def run(address: str) -> dict:
    """A library run of a few seconds of the first paper's experiment."""
    with Client(address) as made:
        return made.run("zhao-2012", {"horizon": 5, "record": 0.01})


def until(condition) -> None:
    """Wait until a condition of the service holds."""
    deadline = time.monotonic() + 120
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)
