"""Measure how quick the service is for others while a client makes it compute as much as it can.

    python -m benchmarks guarded              # all attacks, five minutes
    python -m benchmarks.guarded ring wide    # those whose names contain one of the words

The attack is sent by a process of its own, so that it shares nothing with the probes but the machine. The probes of
another user run at rest, under the attack, and at rest again; both times of rest together are the reference.
"""

import argparse
import itertools
import json
import multiprocessing
import os
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from http.client import HTTPConnection
from pathlib import Path

from benchmarks import attacks
from benchmarks.measure import Figure
from benchmarks.service import service

_ATTACKER, _USER = "127.0.0.2", "127.0.0.1"  # clients are told apart by their addresses
_ROUNDS = 20
"""Rounds of probes under an attack, and in the times of rest before and after it together."""
_SETTLE = 3.0
"""Seconds between the begin or the end of an attack and the first probe."""
_SHORT = ("health", "page")
"""Probes with a limit in seconds."""

Attack = list[tuple[str, Callable[[int], dict]]]
Probes = dict[str, Callable[[], tuple[int, bytes]]]


def send(
    address: str, method: str, path: str, body: object = None, source: str = _USER, token: str = ""
) -> tuple[int, bytes]:
    """Send a request from an address of this machine and return the status and the body of the answer."""
    host, _, port = address.removeprefix("http://").partition(":")
    connection = HTTPConnection(host, int(port), 120, (source, 0))
    try:
        text = None if body is None else json.dumps(body)
        connection.request(method, path, text, {"Content-Type": "application/json", "X-Control-Token": token})
        answer = connection.getresponse()
        return answer.status, answer.read()
    finally:
        connection.close()


def attacks_by_name() -> dict[str, Attack]:
    """Return requests (path, body by number) that are sent together, by the name of the attack."""
    check, run, session = "/api/plants/check", "/api/runs?wait=60", "/api/sessions"

    def distinct(make: Callable[[], dict]) -> Callable[[int], dict]:
        return lambda number: make() | {"id": f"p{number}"}  # another id: not the same computation

    return {
        "(a+…+f)^64": [(check, distinct(attacks.chain))] * 4,
        "ring of exponentials": [(check, distinct(attacks.ring))] * 4,
        "20 × 20 products": [(run, lambda number: attacks.observed(attacks.products(), seed=number))] * 3,
        "60 states, 40 channels": [(check, distinct(attacks.wide))] * 3,
        "sessions at t = 90 000 s": [(session, attacks.later)] * 2,
        "two longest runs": [(run, attacks.longest)] * 2,
    }


@contextmanager
def under(address: str, attack: str, first: int) -> Iterator[None]:
    """Send the requests of an attack from another process, each again and again, until the end."""
    process = multiprocessing.get_context("spawn").Process(target=keep_sending, args=(address, attack, first))
    process.start()
    time.sleep(_SETTLE)
    try:
        yield
    finally:
        process.kill()
        process.join()


def keep_sending(address: str, attack: str, first: int) -> None:
    """Send each request of an attack from a thread of its own, again and again; bodies are numbered from `first`."""
    numbers = itertools.count(first)

    def again_and_again(path: str, body: Callable[[int], dict]) -> None:
        while True:
            send(address, "POST", path, body(next(numbers)), _ATTACKER)

    threads = [threading.Thread(target=again_and_again, args=request) for request in attacks_by_name()[attack]]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()


def probes(address: str, numbers: Iterator[int]) -> Probes:
    """Return the requests of another user, all of them new to the service."""

    def new_plant() -> dict:
        """Return a pendulum with a coefficient that no other plant had."""
        return attacks.plant(f"p{next(numbers)}", {"x": "v", "v": f"-sin(x) - 0.{next(numbers):08d}*v + u"})

    experiment = {"experiment": "dc-motor"}
    return {
        "health": lambda: send(address, "GET", "/api/health"),
        "page": lambda: send(address, "GET", "/"),
        "new plant": lambda: send(address, "POST", "/api/plants/check", new_plant()),
        "new seed": lambda: send(address, "POST", "/api/runs?wait=60", experiment | {"set": {"seed": next(numbers)}}),
        "new session": lambda: send(address, "POST", "/api/sessions", experiment | {"set": {"seed": next(numbers)}}),
    }


def measured(address: str, calls: Probes, rounds: int) -> dict[str, list[float]]:
    """Return the seconds of each probe in each round. Sessions are ended after each: they play, which takes time."""
    seconds: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            begin = time.perf_counter()
            status, content = call()
            seconds[name].append(time.perf_counter() - begin)
            if status >= 400:
                raise AssertionError(f"{name} was answered with {status}: {content[:300].decode()}")
            if "session" in name:
                opened = json.loads(content)
                send(address, "DELETE", opened["links"]["self"], token=opened["token"])
    return seconds


def p95(values: list[float]) -> float:
    """Return the value that 95 % do not exceed."""
    return sorted(values)[min(len(values) - 1, int(0.95 * len(values)))]


def figures(chosen: Sequence[str] = ("",)) -> Iterator[Figure]:
    """Yield the seconds of each probe under attacks: short ones, and of the others their 95 % by that at rest."""
    first = int(time.time()) % 100_000 * 1000
    numbers = itertools.count(first)
    names = [name for name in attacks_by_name() if any(word in name for word in chosen)]
    with (
        tempfile.TemporaryDirectory(prefix="thetascope-benchmark-") as data,
        Path(data, "log").open("w") as log,
        service(Path(data), log) as (address, _),
    ):
        calls = probes(address, numbers)
        measured(address, calls, 2)  # compiles and calibrates what all of them share
        before = measured(address, calls, _ROUNDS // 2)
        for number, attack in enumerate(names, 1):
            with under(address, attack, first + number * 100_000_000):
                seconds = measured(address, calls, _ROUNDS)
            time.sleep(_SETTLE)
            after = measured(address, calls, _ROUNDS // 2)
            for name in calls:
                yield compared(f"{name}, {attack}: 95 %", name in _SHORT, seconds[name], before[name] + after[name])
            before = after
        yield Figure.of("memory after all, service and workers", [memory(os.getpid())], unit="MB")


def compared(what: str, short: bool, seconds: list[float], rest: list[float]) -> Figure:
    """Return the 95 % of a probe under an attack in seconds, or divided by the 95 % at rest."""
    if short:
        return Figure(what, p95(seconds), min(seconds), max(seconds), "≤ 100 ms", "ms")
    reference = p95(rest)
    ratios = [value / reference for value in seconds]
    return Figure(f"{what} ÷ {1000 * reference:.0f} ms at rest", p95(ratios), min(ratios), max(ratios), "≤ 2")


def memory(pid: int) -> float:
    """Return the megabytes of the processes below a process, shared pages divided among those that share them."""
    total = 0.0
    for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split():
        for line in Path(f"/proc/{child}/smaps_rollup").read_text().splitlines():
            if line.startswith("Pss:"):
                total += int(line.split()[1]) / 1024
        total += memory(int(child))
    return total


if __name__ == "__main__":
    arguments = argparse.ArgumentParser(prog="python -m benchmarks.guarded", description=__doc__)
    arguments.add_argument("words", nargs="*", default=[""], help="of the names of attacks; all if none is given")
    for figure in figures(arguments.parse_args().words):
        print(figure.text(), flush=True)
