"""Computations for the tests of the workers; a worker imports this module."""

import os
import signal
import time
from pathlib import Path

import numpy as np

from thetascope.runs.workers.child import Reporter
from thetascope.runs.workers.limits import Limits


def add(a: int, b: int) -> int:
    return a + b


def process_id() -> int:
    return os.getpid()


def wait(seconds: float, mark: object = None) -> None:
    time.sleep(seconds)


def wait_for(path: str) -> None:
    while not Path(path).exists():
        time.sleep(0.01)


def note(path: str, word: str, mark: object = None) -> None:
    with Path(path).open("a") as file:
        file.write(f"{word}\n")


def spin(seconds: float, mark: object = None) -> None:
    until = time.process_time() + seconds
    while time.process_time() < until:
        pass


def niceness_after(seconds: float) -> int:
    spin(seconds)
    time.sleep(0.5)  # longer than between two looks at a computation
    return os.nice(0)


def zeros(count: int) -> np.ndarray:
    return np.zeros(count) + 1


def fail() -> None:
    raise ValueError("a wrong value")


def die() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def wait_in_two_parts(reporter: Reporter, first: float, second: float, limits: Limits) -> str:
    time.sleep(first)
    reporter.other_limits(limits)
    time.sleep(second)
    return "done"
