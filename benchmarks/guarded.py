"""Measure how quick the service is for others while a client makes it compute as much as it can.

python -m benchmarks guarded
"""

import itertools
import json
import os
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.client import HTTPConnection
from pathlib import Path

from benchmarks import attacks
from benchmarks.measure import Figure
from benchmarks.service import service

_ATTACKER, _USER = "127.0.0.2", "127.0.0.1"  # clients are told apart by their addresses
_SECONDS = 18.0
"""Seconds for which each attack is observed; one computation may take 20 s."""
_ROUNDS = 12
"""Rounds of probes, at most, in each situation."""


def send(address: str, method: str, path: str, body: object = None, source: str = _USER, timeout: float = 120) -> int:
    """Send a request from an address of this machine and return the status of the answer."""
    host, _, port = address.removeprefix("http://").partition(":")
    connection = HTTPConnection(host, int(port), timeout, (source, 0))
    try:
        text = None if body is None else json.dumps(body)
        connection.request(method, path, text, {"Content-Type": "application/json"})
        answer = connection.getresponse()
        answer.read()
        return answer.status
    finally:
        connection.close()


def attacks_by_name() -> dict[str, list[tuple[str, Callable[[int], dict]]]]:
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
def under(address: str, requests: list[tuple[str, Callable[[int], dict]]], numbers: Iterator[int]) -> Iterator[None]:
    """Send the requests of an attack, each from a thread, again and again until the end."""
    stop = threading.Event()

    def attack(path: str, body: Callable[[int], dict]) -> None:
        while not stop.is_set():
            try:
                send(address, "POST", path, body(next(numbers)), _ATTACKER, timeout=_SECONDS + 2)
            except OSError:
                return

    threads = [threading.Thread(target=attack, args=request, daemon=True) for request in requests]
    for thread in threads:
        thread.start()
    time.sleep(1)
    try:
        yield
    finally:
        stop.set()
        for thread in threads:
            thread.join(_SECONDS + 5)


def probes(address: str, numbers: Iterator[int]) -> dict[str, Callable[[], int]]:
    """Return the requests of another user, all of them new to the service."""

    def new_plant() -> dict:
        """Return a pendulum with a coefficient that no other plant had."""
        return attacks.plant(f"p{next(numbers)}", {"x": "v", "v": f"-sin(x) - 0.{next(numbers):06d}*v + u"})

    experiment = {"experiment": "dc-motor"}
    return {
        "health": lambda: send(address, "GET", "/api/health"),
        "page": lambda: send(address, "GET", "/"),
        "new plant": lambda: send(address, "POST", "/api/plants/check", new_plant()),
        "new seed": lambda: send(address, "POST", "/api/runs?wait=60", experiment | {"set": {"seed": next(numbers)}}),
        "new session": lambda: send(address, "POST", "/api/sessions", experiment | {"set": {"seed": next(numbers)}}),
    }


def measured(calls: dict[str, Callable[[], int]]) -> dict[str, list[float]]:
    """Return the seconds of each probe, in turn until the time is over."""
    seconds: dict[str, list[float]] = {name: [] for name in calls}
    until = time.perf_counter() + _SECONDS
    for _ in range(_ROUNDS):
        for name, call in calls.items():
            begin = time.perf_counter()
            status = call()
            seconds[name].append(time.perf_counter() - begin)
            if status >= 400:
                raise AssertionError(f"{name} was answered with {status}")
        if time.perf_counter() > until:
            break
    return seconds


def p95(values: list[float]) -> float:
    """Return the value that 95 % do not exceed."""
    return sorted(values)[min(len(values) - 1, int(0.95 * len(values)))]


def figures() -> Iterator[Figure]:
    """Yield each probe's seconds at rest; under each attack the seconds of short ones, and the ratios of the others."""
    numbers = itertools.count(int(time.time()) % 100_000)
    with tempfile.TemporaryDirectory(prefix="thetascope-benchmark-") as data, service(Path(data)) as (address, _):
        calls = probes(address, numbers)
        for call in calls.values():
            call()  # compiles and calibrates what all of them share
        rest = measured(calls)
        for name, seconds in rest.items():
            yield Figure.of(f"{name} at rest", seconds, unit="ms")
        for attack, requests in attacks_by_name().items():
            with under(address, requests, numbers):
                seconds = measured(calls)
            for name in calls:
                times, what = seconds[name], f"{name}, {attack}: 95 %"
                if name in ("health", "page"):
                    yield Figure(what, p95(times), min(times), max(times), "≤ 100 ms", "ms")
                    continue
                ratios = [t / p95(rest[name]) for t in times]
                yield Figure(f"{what} ÷ 95 % at rest", p95(ratios), min(ratios), max(ratios), "≤ 2")
        time.sleep(3)
        yield Figure.of("memory after all, service and workers", [memory(os.getpid())], unit="MB")


def memory(pid: int) -> float:
    """Return the megabytes of the processes below a process, shared pages divided among those that share them."""
    total = 0.0
    for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split():
        for line in Path(f"/proc/{child}/smaps_rollup").read_text().splitlines():
            if line.startswith("Pss:"):
                total += int(line.split()[1]) / 1024
        total += memory(int(child))
    return total
