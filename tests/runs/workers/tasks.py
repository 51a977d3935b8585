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


def gives_way() -> bool:
    """Return whether this process runs only when a processor has nothing else to do."""
    return os.sched_getscheduler(0) == os.SCHED_IDLE


def comes_after_others() -> bool:
    """Return whether this process has a low priority, compared with the process that it is a copy of."""
    return gives_way() or os.nice(0) - os.getpriority(os.PRIO_PROCESS, os.getppid()) >= 8


def comes_after_others_at(path: str, mark: object = None) -> bool:
    """Return whether this process has a low priority, once a file exists."""
    wait_for(path)
    return comes_after_others()


def until_it_gives_way(seconds: float, mark: object = None) -> bool:
    """Wait until this process gives way; return whether it does within a time."""
    until = time.monotonic() + seconds
    while not gives_way() and time.monotonic() < until:
        time.sleep(0.01)
    return gives_way()


def until_it_comes_after_others(seconds: float, mark: object = None) -> bool:
    """Wait until this process has a low priority; return whether it has within a time."""
    until = time.monotonic() + seconds
    while not comes_after_others() and time.monotonic() < until:
        time.sleep(0.01)
    return comes_after_others()


def gives_way_after(seconds: float) -> bool:
    """Compute for so long; return whether this process gives way then."""
    spin(seconds)
    return until_it_gives_way(5.0)


def run_until_it_gives_way(reporter: Reporter, seconds: float) -> bool:
    return until_it_gives_way(seconds)


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
