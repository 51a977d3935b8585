"""The service's side of one worker process: start it, hand it computations, read its answers, end it."""

import multiprocessing
import multiprocessing.connection
import os
import sys
import time
from collections.abc import Sequence
from contextlib import contextmanager, suppress
from threading import Lock
from typing import Any

from thetascope.engine.compiler import cache
from thetascope.process_settings import ONE_THREAD
from thetascope.runs.workers.child import data_bytes, receive, serve
from thetascope.runs.workers.precedence import LEFTOVERS

_START = "forkserver" if sys.platform != "win32" else "spawn"
_GRACE = 1.0
"""Seconds that a killed process may take to be gone."""
_NICEST = 19
"""The largest nice value of the system."""
_lock = Lock()  # processes are started and their exit codes are read by one thread at a time


class Gone(Exception):
    """The process has ended; `code` is its exit code, negative for a signal."""

    def __init__(self, code: int | None) -> None:
        super().__init__(code)
        self.code = code


def preload(modules: Sequence[str]) -> None:
    """Name the modules that workers have imported when they start; before the first of them starts."""
    if _START == "forkserver":
        multiprocessing.get_context(_START).set_forkserver_preload(list(modules))


class WorkerProcess:
    """A worker process. Used by one thread at a time.

    Args:
        memory: bytes that its computations may take in addition to its own.
    """

    def __init__(self, memory: int) -> None:
        context = multiprocessing.get_context(_START)
        self._connection, other = context.Pipe()
        environment = ONE_THREAD | {"THETASCOPE_CACHE": str(cache.folder())}
        self._process = context.Process(target=serve, args=(other, memory, environment), daemon=True)
        with _lock, _environment(ONE_THREAD):
            self._process.start()
        other.close()
        self.nice, self._cpu = 0, 0.0
        self._idle_bytes = data_bytes(self._process.pid or 0)

    @property
    def grown(self) -> int:
        """Return the bytes of data that the process has reserved since it started."""
        return data_bytes(self._process.pid or 0) - self._idle_bytes

    @property
    def cpu(self) -> float:
        """Return the seconds of processor time that the process has used, at its end the last ones that were read.

        Where the system does not tell, return those of the clock.
        """
        try:
            with open(f"/proc/{self._process.pid}/stat") as file:
                fields = file.read().rpartition(")")[2].split()
            self._cpu = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
        except (OSError, IndexError, ValueError):
            if sys.platform != "linux":
                return time.monotonic()
        return self._cpu

    def begin(self, task: bytes, cpu: float) -> None:
        """Hand over a computation. Raises Gone."""
        try:
            self._connection.send((task, cpu))
        except OSError:
            raise Gone(self._code()) from None

    def receive(self, seconds: float) -> tuple[str, Any] | None:
        """Return the next message of the worker; None if none comes in time. Raises Gone."""
        try:
            if not self._connection.poll(seconds):
                return None
            kind, *rest = self._connection.recv()
            return receive(self._connection, *rest) if kind == "answer" else (kind, rest[0])
        except (EOFError, OSError):
            raise Gone(self._code()) from None

    def give_way(self, nice: int) -> None:
        """Lower the priority of the process, by a nice value below that of the service, for the rest of its life.

        With :data:`LEFTOVERS` it only runs when a processor has nothing else to do, where the system has such a class.
        """
        pid = self._process.pid
        if nice <= self.nice or pid is None or not hasattr(os, "setpriority"):
            return
        self.nice = nice
        with suppress(OSError):
            base = os.getpriority(os.PRIO_PROCESS, os.getpid())
            os.setpriority(os.PRIO_PROCESS, pid, base + min(nice, _NICEST))
        if nice >= LEFTOVERS and sys.platform == "linux":
            with suppress(OSError):
                os.sched_setscheduler(pid, os.SCHED_IDLE, os.sched_param(0))

    def end(self) -> None:
        """End the process, whatever it computes."""
        with suppress(OSError):
            self._process.kill()
        self._hurry()
        self._code()
        self._connection.close()

    def _hurry(self) -> None:
        """Let a process that gave way end, and return its memory, before others compute: where the system allows it."""
        if self.nice and sys.platform == "linux" and self._process.pid is not None:
            with suppress(OSError):
                os.sched_setscheduler(self._process.pid, os.SCHED_OTHER, os.sched_param(0))
                os.setpriority(os.PRIO_PROCESS, self._process.pid, 0)

    def _code(self) -> int | None:
        """Return the exit code; None if the process is not gone in time. Others can start processes meanwhile."""
        multiprocessing.connection.wait([self._process.sentinel], _GRACE)
        with _lock:
            self._process.join(0)
            return self._process.exitcode


@contextmanager
def _environment(values: dict[str, str]):
    """Set variables for the processes that are started meanwhile."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
