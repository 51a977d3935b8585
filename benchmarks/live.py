"""Measure live sessions: the cost of a frame, sessions at 30 frames/s, the latency of commands.

    python -m benchmarks live

The server is pinned to the first processor and the viewers to the others; where the system allows it, both have
priority over other programs. The cost is relative to a bare websockets server that sends messages of the same size at
the same rate on the same processor at the same time, so that other load affects both equally.
"""

import json
import os
import random
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from http.client import HTTPConnection
from itertools import pairwise
from pathlib import Path
from time import perf_counter

from benchmarks.measure import Figure
from benchmarks.watchers import Watcher, Watchers
from thetascope.client import Client

ROOT = Path(__file__).parents[1]
EXPERIMENT = "zhao-2012"  # 21 columns in rows of 10 ms
SETTLE, WINDOW, WINDOWS = 8.0, 3.0, 5
LONG = 8.0  # a window in which each session computes ahead about once
SESSIONS = 400

BARE = """
import asyncio, sys
from websockets.asyncio.server import serve

async def handler(connection):
    loop, payload = asyncio.get_running_loop(), bytes(int(sys.argv[1]))
    due = loop.time()
    while True:
        await connection.send(payload)
        due += 1 / 30
        await asyncio.sleep(max(0, due - loop.time()))

async def main():
    async with serve(handler, "127.0.0.1", 0, compression=None) as server:
        print(server.sockets[0].getsockname()[1], flush=True)
        await asyncio.Future()

asyncio.run(main())
"""


def figures() -> Iterator[Figure]:
    """Yield the cost of a frame, the gaps between frames of many sessions, and the latency of commands."""
    with service(SESSIONS) as server:
        yield cost(server, 1, 200, "frame to one of 200 viewers of a session ÷ bare websockets server")
        what = "frame of one of 100 sessions, simulation included"
        yield cost(server, 100, 1, f"{what} ÷ bare websockets server", diagnosis=False)
        yield cost(server, 100, 1, f"{what}, and the diagnosis of the faults in each ÷ bare websockets server")
        yield from hold(server, SESSIONS)
    with service(100) as server:
        yield from latency(server, 100)


@contextmanager
def pinned(program: list[str], environment: dict[str, str] | None = None) -> Iterator[tuple[subprocess.Popen, str]]:
    """Start a server on the first processor; yield it and its first line. This process moves to the others."""
    processors = sorted(os.sched_getaffinity(0))
    os.sched_setaffinity(0, processors[:1])
    process = subprocess.Popen(program, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True)
    os.sched_setaffinity(0, processors[1:] or processors)
    with suppress(OSError):  # priority over other programs, where the system allows it
        for who in (0, process.pid):
            os.sched_setscheduler(who, os.SCHED_RR, os.sched_param(1))
    try:
        yield process, process.stdout.readline()
    finally:
        process.terminate()
        process.wait(20)
        process.stdout.close()
        os.sched_setaffinity(0, processors)
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


@contextmanager
def service(sessions: int) -> Iterator[tuple[subprocess.Popen, str]]:
    """Start the service; yield its process and address."""
    with tempfile.TemporaryDirectory(prefix="thetascope-benchmark-") as data:
        environment = os.environ | {
            "THETASCOPE_DATA": data,
            "THETASCOPE_SESSIONS": str(sessions),
            "PYTHONUNBUFFERED": "1",
            "THETASCOPE_PREPARE": "0",
        }
        command = [sys.executable, "-m", "thetascope.cli.main", "serve", "--port", "0"]
        with pinned(command, environment) as (process, line):
            if "http://" not in line:
                raise RuntimeError(f"the service did not start: {line!r}")
            yield process, line.split(" at ")[1].split("/ ")[0]


@contextmanager
def playing(
    address: str, sessions: int, viewers: int = 1, diagnosis: bool = True
) -> Iterator[tuple[Watchers, list[Watcher]]]:
    """Open sessions that play, with a number of viewers each, and close them afterwards."""
    with Client(address) as client:
        body = {"experiment": EXPERIMENT, "set": {"diagnosis.enabled": diagnosis}}
        some = [client.post("/api/sessions", body) for _ in range(sessions)]
        watchers, port = Watchers(), int(address.rpartition(":")[2])
        try:
            yield (
                watchers,
                [
                    watchers.connect(port, session["links"]["stream"], session["token"])
                    for session in some
                    for _ in range(viewers)
                ],
            )
        finally:
            watchers.close()
            connection = HTTPConnection("127.0.0.1", port)
            for session in some:
                connection.request("DELETE", session["links"]["self"], headers={"X-Control-Token": session["token"]})
                connection.getresponse().read()


def processor_time(process: int) -> float:
    """Return the processor time of a process, s."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def cost(
    server: tuple[subprocess.Popen, str], sessions: int, viewers: int, what: str, diagnosis: bool = True
) -> Figure:
    """Return the processor time per frame of the service divided by that of the bare server;
    both run at the same time."""
    process, address = server
    ratios = []
    with ExitStack() as stack:
        watchers, mine = stack.enter_context(playing(address, sessions, viewers, diagnosis))
        watchers.run(SETTLE)
        size = sum(watcher.bytes for watcher in mine) / sum(len(watcher.times) for watcher in mine)
        other, line = stack.enter_context(pinned([sys.executable, "-c", BARE, str(round(size))]))
        theirs = [watchers.connect(int(line), "/") for _ in mine]
        watchers.run(1.0)
        for _ in range(WINDOWS):
            for watcher in (*mine, *theirs):
                watcher.clear()
            before = processor_time(process.pid), processor_time(other.pid)
            watchers.run(LONG)
            each = [
                (processor_time(p.pid) - b) / sum(len(watcher.times) for watcher in group)
                for p, b, group in zip((process, other), before, (mine, theirs), strict=True)
            ]
            ratios.append(each[0] / each[1])
    return Figure.of(what, ratios, "≤ 1.5")


def hold(server: tuple[subprocess.Popen, str], sessions: int) -> Iterator[Figure]:
    """Yield the gaps between frames of many sessions on one processor, the load they cause, and other load on it."""
    process, address = server
    gaps, busy, others = [], [], []
    with playing(address, sessions) as (watchers, mine):
        watchers.run(2 * SETTLE)
        for _ in range(WINDOWS):
            for watcher in mine:
                watcher.clear()
            before, used, all_used = perf_counter(), processor_time(process.pid), first_processor()
            watchers.run(WINDOW)
            seconds = perf_counter() - before
            share = (processor_time(process.pid) - used) / seconds
            sorted_gaps = sorted(b - a for watcher in mine for a, b in pairwise(watcher.times))
            gaps.append(sorted_gaps[int(0.99 * len(sorted_gaps))])
            busy.append(share)
            others.append(max(0.0, (first_processor() - all_used) / seconds - share))
    name = f"{sessions} sessions of 21 columns at 30 frames/s on one processor"
    yield Figure.of(f"{name}: p99 of the gap between frames", gaps, "≤ 40 ms", "ms")
    yield Figure.of(f"{name}: share of it", busy)
    yield Figure.of("other load on that processor meanwhile", others)


def first_processor() -> float:
    """Return the seconds for which the first processor was busy or stolen by the host."""
    fields = Path("/proc/stat").read_text().splitlines()[1 + min(os.sched_getaffinity(1))].split()
    user, nice, system, _, _, interrupts, soft, stolen = map(int, fields[1:9])
    return (user + nice + system + interrupts + soft + stolen) / os.sysconf("SC_CLK_TCK")


def latency(server: tuple[subprocess.Popen, str], sessions: int, commands: int = 1000) -> Iterator[Figure]:
    """Yield the time from a command to the first frame with a row that it affects, while other sessions play.

    Percentiles are taken over 200 commands each; of fewer, the 99th would be the slowest command or the second slowest.
    """
    draw, latencies = random.Random(1), []
    with playing(server[1], sessions) as (watchers, mine):
        watchers.run(SETTLE)
        for number in range(commands):
            watcher = draw.choice(mine)
            watchers.run(draw.uniform(0.01, 0.06))
            text = json.dumps({"id": number, **_command(draw)})
            begin = perf_counter()
            watcher.command(text)
            watchers.run(2.0, until=lambda watcher=watcher: watcher.effect is not None)
            if watcher.effect is None:
                raise AssertionError("a command had no effect within two seconds")
            latencies.append(watcher.effect - begin)
    part = commands // WINDOWS
    parts = [sorted(latencies[i : i + part]) for i in range(0, commands, part)]
    middles, ends = ([each[round(share * part) - 1] for each in parts] for share in (0.5, 0.99))
    yield Figure.of(f"from command to frame with {sessions} sessions playing, median", middles, unit="ms")
    yield Figure.of(f"from command to frame with {sessions} sessions playing, p99", ends, "≤ 10 ms", "ms")


def _command(draw: random.Random) -> dict:
    fault = {"channel": "theta3", "shape": "step", "onset": 0, "size": draw.uniform(0.01, 0.03)}
    return draw.choice(
        [
            {"type": "set-gain", "observer": "adaptive", "gain": "rho", "value": draw.uniform(6, 10)},
            {"type": "inject", "fault": fault},
            {"type": "clear"},
            {"type": "set-noise", "output": "y", "std": draw.uniform(0, 0.002)},
        ]
    )
