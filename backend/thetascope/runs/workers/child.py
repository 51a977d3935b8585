"""The worker's side: receive a computation, carry it out within its limits, send the result."""

import gc
import logging
import os
import pickle
import signal
import time
from multiprocessing.connection import Connection
from queue import SimpleQueue
from threading import Thread
from typing import Any

from thetascope.process_settings import collect_rarely
from thetascope.runs.workers.limits import Limits

try:
    import resource
except ImportError:  # Windows has no such limits
    resource = None

_REPORT_INTERVAL = 0.05
"""Least seconds between two reports of progress."""
_NICE = 2
"""A worker gives way to the service, which answers everybody."""

log = logging.getLogger(__name__)


class Reporter:
    """Tells the service how far the computation in this process is."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._reported = 0.0

    def progress(self, share: float) -> None:
        """Report the share done."""
        if time.monotonic() - self._reported >= _REPORT_INTERVAL:
            self._reported = time.monotonic()
            self._connection.send(("progress", share))

    def other_limits(self, limits: Limits) -> None:
        """Ask for other limits from now on, where the part that was limited is done."""
        limit_cpu(limits.cpu)
        self._connection.send(("limits", limits))


def serve(connection: Connection, memory: int, environment: dict[str, str]) -> None:
    """Carry out computations until the service closes the connection.

    Args:
        connection: to the service: (task, cpu seconds) in, (kind, value) out.
        memory: bytes that the computations may take.
        environment: variables to set first.
    """
    os.environ.update(environment)
    gc.freeze()  # what was imported
    collect_rarely()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C ends the service, which ends its workers
    if hasattr(os, "nice"):
        os.nice(_NICE)
    limit_memory(memory)
    tasks: SimpleQueue[tuple[bytes, float]] = SimpleQueue()
    Thread(target=_receive, args=(connection, tasks), name="receive", daemon=True).start()
    reporter = Reporter(connection)
    while True:
        _carry_out(connection, reporter, *tasks.get())


def _receive(connection: Connection, tasks: "SimpleQueue[tuple[bytes, float]]") -> None:
    """Receive tasks. When the service has ended, end this process, whatever it computes."""
    try:
        while True:
            tasks.put(connection.recv())
    except (EOFError, OSError):
        os._exit(0)


def _carry_out(connection: Connection, reporter: Reporter, packed: bytes, cpu: float) -> None:
    limit_cpu(cpu)
    try:
        task, args = pickle.loads(packed)
        answer = ("value", task(reporter, *args))
    except MemoryError:
        answer = ("memory", None)
    except Exception as error:
        answer = ("error", _portable(error))
    send(connection, answer)


def _portable(error: Exception) -> Exception:
    """Return the exception if it can be sent, else one that says it in words."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        log.exception("An exception cannot be sent", exc_info=error)
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


def send(connection: Connection, answer: tuple[str, Any]) -> None:
    """Send an answer; the bytes of large arrays follow it and are not copied."""
    buffers: list[pickle.PickleBuffer] = []
    head = pickle.dumps(answer, protocol=5, buffer_callback=buffers.append)
    views = [buffer.raw() for buffer in buffers]
    connection.send(("answer", head, [view.nbytes for view in views]))
    for view in views:
        connection.send_bytes(view)


def receive(connection: Connection, head: bytes, sizes: list[int]) -> tuple[str, Any]:
    """Return the answer of :func:`send`, whose first message had this head and these sizes."""
    buffers = []
    for size in sizes:
        buffers.append(bytearray(size))
        connection.recv_bytes_into(buffers[-1])
    return pickle.loads(head, buffers=buffers)


def limit_memory(memory: int) -> None:
    """Limit the memory of this process to what it has and the given bytes."""
    if resource is not None:
        most = data_bytes(os.getpid()) + memory
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))


def limit_cpu(seconds: float) -> None:
    """Limit the processor time of this process from here on, in seconds; the system kills it after them."""
    if resource is not None:
        used = time.process_time()
        resource.setrlimit(resource.RLIMIT_CPU, (int(used + seconds) + 1, resource.RLIM_INFINITY))


def data_bytes(pid: int) -> int:
    """Return the bytes of data that a process has reserved; 0 where the system does not tell."""
    try:
        with open(f"/proc/{pid}/statm") as file:
            return int(file.read().split()[5]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, IndexError, ValueError):
        return 0
