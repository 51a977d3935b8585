"""Live sessions: cost of a frame against a bare websockets server, sessions held at 30 frames/s, time to a command's effect.

python -m benchmarks.live [sessions]     (2 processors or more; the server has one of them to itself)

A bare server, one connection at a time, sends messages of the same size at the same rate from a loop that sleeps. Both
servers run at the same time on the same processor and are measured in the same seconds, so the ratio is free of drift.
"""

import json
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from backend.client import Client
from benchmarks.watchers import Watcher, Watchers

ROOT = Path(__file__).parents[1]
EXPERIMENT = "zhao-2012"  # 21 columns in rows of 10 ms
SECONDS = 8.0
LATE = 0.040

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


def main(sessions: int = 400) -> None:
    """Measure and print, one figure a line."""
    with ExitStack() as stack:
        server = stack.enter_context(service(sessions))
        shared = cost(server, 1, sessions)
        print(f"cost of a frame / bare server's: one session, {sessions} viewers   {shared:6.2f}   (at most 1.5)")
        single, size = hold(server, sessions)
        print(single)
        print(f"bytes of a frame   {size:.0f}")
    with service(100) as server:
        print(latency(server, 100))


@contextmanager
def pinned(program: list[str], environment: dict[str, str] | None = None) -> Iterator[tuple[subprocess.Popen, str]]:
    """A server on the first processor, and its first line; this process keeps to the others."""
    processors = sorted(os.sched_getaffinity(0))
    os.sched_setaffinity(0, processors[:1])
    process = subprocess.Popen(program, cwd=ROOT, env=environment, stdout=subprocess.PIPE, text=True)
    os.sched_setaffinity(0, processors[1:] or processors)
    try:
        yield process, process.stdout.readline()
    finally:
        process.terminate()
        process.wait(20)
        os.sched_setaffinity(0, processors)


@contextmanager
def service(sessions: int) -> Iterator[tuple[subprocess.Popen, str]]:
    """The service, and its address."""
    with tempfile.TemporaryDirectory() as data:
        environment = os.environ | {
            "THETASCOPE_DATA": data, "THETASCOPE_SESSIONS": str(sessions + 2), "THETASCOPE_VIEWERS": str(sessions),
        }  # fmt: skip
        command = [sys.executable, "-m", "backend.cli", "serve", "--port", "0"]
        with pinned(command, environment) as (process, line):
            yield process, line.split(" at ")[1].split("/ ")[0]


def processor_time(process: subprocess.Popen) -> float:
    """Seconds of processor time that a process has used."""
    fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def opened(address: str, count: int) -> list[dict]:
    """Sessions that play."""
    with Client(address) as client:
        return [client.post("/api/sessions", {"experiment": EXPERIMENT}) for _ in range(count)]


def end(address: str, sessions: list[dict]) -> None:
    for session in sessions:
        with Client(address) as client:
            client._connection.request("DELETE", session["links"]["self"], headers={"X-Control-Token": session["token"]})
            client._connection.getresponse().read()


def watched(watchers: Watchers, address: str, sessions: list[dict], each: int = 1) -> list[Watcher]:
    port = int(address.rpartition(":")[2])
    paths = [f"{session['links']['stream']}?token={session['token']}" for session in sessions for _ in range(each)]
    return [watchers.connect(port, path) for path in paths]


def measured(
    watchers: Watchers, groups: dict[str, tuple[subprocess.Popen, list[Watcher]]]
) -> dict[str, tuple[float, list[float], float]]:
    """For each group: processor seconds a frame, the gaps between frames, bytes a frame, all over the same seconds."""
    watchers.run(2.0)
    for _, members in groups.values():
        for watcher in members:
            watcher.clear()
    before = {name: processor_time(process) for name, (process, _) in groups.items()}
    watchers.run(SECONDS)
    found = {}
    for name, (process, members) in groups.items():
        frames = sum(len(watcher.times) for watcher in members)
        seconds = (processor_time(process) - before[name]) / frames
        gaps = sorted(b - a for watcher in members for a, b in zip(watcher.times, watcher.times[1:], strict=False))
        found[name] = seconds, gaps, sum(watcher.bytes for watcher in members) / frames
    return found


@contextmanager
def bare(size: int) -> Iterator[tuple[subprocess.Popen, int]]:
    with pinned([sys.executable, "-c", BARE, str(size)]) as (process, line):
        yield process, int(line)


def cost(server: tuple[subprocess.Popen, str], sessions: int, viewers: int) -> float:
    """Processor time a frame of the service over that of the bare server, both at work at the same time."""
    process, address = server
    some = opened(address, sessions)
    watchers = Watchers()
    with bare(300) as (other, port):
        half = max(1, viewers // 2 // sessions)
        mine = watched(watchers, address, some, half)
        theirs = [watchers.connect(port, "/") for _ in range(half * sessions)]
        found = measured(watchers, {"service": (process, mine), "bare": (other, theirs)})
    watchers.close()
    end(address, some)
    return found["service"][0] / found["bare"][0]


def hold(server: tuple[subprocess.Popen, str], sessions: int) -> tuple[str, float]:
    """Gaps between the frames of so many sessions, and how busy the processor is."""
    process, address = server
    some = opened(address, sessions)
    watchers = Watchers()
    mine = watched(watchers, address, some)
    seconds, gaps, size = measured(watchers, {"service": (process, mine)})["service"]
    rate = sum(len(watcher.times) for watcher in mine) / SECONDS / sessions
    watchers.close()
    end(address, some)
    share = sum(gap > LATE for gap in gaps) / len(gaps)
    text = (
        f"{sessions} sessions on one core: {rate:.1f} frames/s each, p99 gap {1e3 * quantile(gaps, 0.99):.1f} ms (at most 40),"
        f" {share:.2%} later than 40 ms, processor {seconds * rate * sessions:.0%}, {1e6 * seconds:.0f} µs a frame with simulation"
    )
    return text, size


def latency(server: tuple[subprocess.Popen, str], sessions: int, commands: int = 300) -> str:
    """From a command to the first frame that has a row on which it acted, while so many sessions play."""
    _, address = server
    some = opened(address, sessions)
    watchers, draw = Watchers(), random.Random(1)
    mine = watched(watchers, address, some)
    watchers.run(3.0)
    found = []
    for number in range(commands):
        watcher = draw.choice(mine)
        watchers.run(draw.uniform(0.01, 0.06))
        kind = draw.choice(["set-gain", "inject", "clear", "set-noise"])
        watcher.command(json.dumps({"id": number, **_command(kind, draw)}))
        begin = time.perf_counter()
        watchers.run(1.0, until=lambda watcher=watcher: watcher.effect is not None)
        assert watcher.effect is not None, "a command had no effect within a second"
        found.append(watcher.effect - begin)
    watchers.close()
    found.sort()
    p50, p99 = (1e3 * quantile(found, share) for share in (0.5, 0.99))
    return f"command to frame with {sessions} sessions: p50 {p50:.1f} ms, p99 {p99:.1f} ms (at most 10), worst {1e3 * found[-1]:.1f}"


def _command(kind: str, draw: random.Random) -> dict:
    fault = {"channel": "theta3", "shape": "step", "onset": 0, "size": draw.uniform(0.01, 0.03)}
    return {
        "set-gain": {"type": kind, "observer": "adaptive", "gain": "rho", "value": draw.uniform(6, 10)},
        "inject": {"type": kind, "fault": fault},
        "clear": {"type": kind},
        "set-noise": {"type": kind, "output": "y", "std": draw.uniform(0, 0.002)},
    }[kind]


def quantile(ordered: list[float], share: float) -> float:
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))]


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
