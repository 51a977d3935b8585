"""Measure how many live sessions a core holds, and what it costs to spread them over processes.

    python -m benchmarks processes

The first figure compares two servers one after the other on one processor: the service, whose sessions are diagnosed,
and a bare websockets server that sends frames of the same size at the same rate. A server holds as many as it sends
with gaps of at most 40 ms for 99 % of the frames. The other figures are processor time per frame of a service in two
processes, and of its router, divided by that of one process that plays as many sessions at the same time. Where there
are two processors, those who read need one of them, so that a doubled number of sessions cannot be seen there;
processor time per frame says the same.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from itertools import pairwise
from pathlib import Path

from benchmarks.live import BARE, LONG, ROOT, SETTLE, WINDOWS, pinned, playing, processor_time, service
from benchmarks.measure import Figure
from benchmarks.watchers import Watcher, Watchers
from thetascope.client import Client

EXPERIMENT = "zhao-2012"
GAP = 0.040
"""The longest gap of 99 % of the frames, s."""
FACTOR = 1.4
"""How many times as many connections are tried next."""
SESSIONS = 60


def figures() -> Iterator[Figure]:
    """Yield the share of the bare server's connections that sessions reach, and the cost of processes and router."""
    sessions, connections = sessions_held(), connections_held()
    what = f"sessions that one core holds with a p99 gap of {1000 * GAP:.0f} ms, diagnosis included"
    yield Figure.of(f"{what} ÷ connections of a bare websockets server", [sessions / connections], "≥ 0.7")
    yield Figure.of("those sessions", [sessions])
    yield from cost_of_processes()


def sessions_held() -> float:
    """Return how many sessions the service holds on one processor."""
    with service(2000) as (_, address):
        port = int(address.rpartition(":")[2])
        with Client(address) as client:

            def one(watchers: Watchers) -> Watcher:
                session = client.post("/api/sessions", {"experiment": EXPERIMENT})
                return watchers.connect(port, session["links"]["stream"], session["token"])

            return held(one, 10, SETTLE, LONG)


def connections_held() -> float:
    """Return how many connections a bare server holds on one processor, with frames of 21 columns and 3 rows."""
    with pinned([sys.executable, "-c", BARE, str(24 + 4 * 21 * 3)]) as (_, line):
        return held(lambda watchers: watchers.connect(int(line), "/"), 200, 1.0, 3.0)


def held(one: Callable[[Watchers], Watcher], first: int, settle: float, window: float) -> float:
    """Return how many connections a server holds, interpolated between the last number within the gap and the next."""
    watchers, mine, before = Watchers(), [], (0, 1 / 30)
    try:
        number = first
        while True:
            while len(mine) < number:
                mine.append(one(watchers))
                watchers.run(0.01)  # who does not read is closed
            watchers.run(settle)
            gap = gap_of(watchers, mine, window)
            if gap > GAP:
                return before[0] + (GAP - before[1]) / (gap - before[1]) * (number - before[0])
            before, number = (number, gap), round(FACTOR * number)
    finally:
        watchers.close()


def gap_of(watchers: Watchers, mine: list[Watcher], window: float) -> float:
    """Return the gap between two frames that 99 % of them keep within a window, s; a connection without any counts."""
    for watcher in mine:
        watcher.clear()
    watchers.run(window)
    gaps = sorted(b - a for watcher in mine for a, b in pairwise(watcher.times or [0.0, window]))
    return gaps[int(0.99 * len(gaps))]


def cost_of_processes() -> Iterator[Figure]:
    """Yield the processor time per frame of two processes and of their router, divided by that of one process."""
    processes, routers = [], []
    with ExitStack() as stack:
        one, first = stack.enter_context(running(1))
        two, second = stack.enter_context(running(2))
        watchers, alone = stack.enter_context(playing(first, SESSIONS, diagnosis=False))
        others, spread = stack.enter_context(playing(second, SESSIONS, diagnosis=False))
        _both(watchers, others, 2 * SETTLE)
        for _ in range(WINDOWS):
            for watcher in (*alone, *spread):
                watcher.clear()
            parts = descendants(two)
            groups = [one], [p for p, name in parts if name != "caddy"], [p for p, name in parts if name == "caddy"]
            before = [_used(group) for group in groups]
            _both(watchers, others, LONG)
            used = [_used(group) - b for group, b in zip(groups, before, strict=True)]
            single, double, router = (
                seconds / sum(len(watcher.times) for watcher in group)
                for seconds, group in zip(used, (alone, spread, spread), strict=True)
            )
            processes.append(double / single)
            routers.append(router / single)
    name = f"frame of one of {SESSIONS} sessions"
    yield Figure.of(f"{name}: two processes, without their router ÷ one process", processes, "≤ 1.1")
    yield Figure.of(f"{name}: their router ÷ one process", routers)


@contextmanager
def running(processes: int) -> Iterator[tuple[int, str]]:
    """Start the service; yield its process id and address."""
    with tempfile.TemporaryDirectory(prefix="thetascope-benchmark-") as data:
        own = {"THETASCOPE_DATA": data, "THETASCOPE_PREPARE": "0", "PYTHONUNBUFFERED": "1"}
        command = [sys.executable, "-m", "thetascope.cli.main", "serve", "--port", "0", "--processes", str(processes)]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
        with subprocess.Popen(command, cwd=ROOT, env=os.environ | own, text=True, **pipes) as process:
            try:
                yield process.pid, process.stdout.readline().split(" at ")[1].split("/ ")[0]
            finally:
                process.terminate()
                process.wait(20)


def descendants(pid: int) -> list[tuple[int, str]]:
    """Return the processes that a process has started, with their names."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        name, _, rest = (place / "stat").read_text().partition("(")[2].rpartition(")")
        if int(rest.split()[1]) == pid:
            found.append((int(place.name), name))
    return found


def _used(processes: list[int]) -> float:
    return sum(processor_time(process) for process in processes)


def _both(first: Watchers, second: Watchers, seconds: float) -> None:
    """Read for two sets of connections in turn, for a few milliseconds each."""
    for _ in range(round(seconds / 0.01)):
        first.run(0.005)
        second.run(0.005)
