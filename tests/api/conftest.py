"""The service as users run it: started by the command line, addressed over HTTP."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from thetascope.client import Client

ROOT = Path(__file__).parents[2]


@contextmanager
def service(data: Path, **settings: object) -> Iterator[str]:
    """Start the service on a free port and return its address; settings as in backend/thetascope/settings.py."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("THETASCOPE_")}
    environment |= {
        f"THETASCOPE_{name.upper()}": str(value)
        for name, value in {"prepare": 0, "job_seconds": 60, **settings}.items()
    }
    environment |= {"THETASCOPE_DATA": str(data), "PYTHONUNBUFFERED": "1"}
    command = [sys.executable, "-m", "thetascope.cli.main", "serve", "--port", "0"]
    process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True)
    try:
        line = process.stdout.readline()
        assert "http://" in line, f"the service did not start: {line!r}"
        yield line.split(" at ")[1].split("/ ")[0]
    finally:
        process.terminate()
        process.wait(60)
        process.stdout.close()


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
