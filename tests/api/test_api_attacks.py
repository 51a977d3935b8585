"""One client makes the service compute as much as it can; others are answered meanwhile, and all of it ends."""

import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from http.client import HTTPConnection
from pathlib import Path

import pytest

from benchmarks import attacks
from tests.api.conftest import process, until
from tests.runs.samples import PLANT, spec_data

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="uses several loopback addresses and /proc")

ATTACKER, USER = "127.0.0.2", "127.0.0.1"
CHECK, RUN, SESSION = "/api/plants/check", "/api/runs?wait=60", "/api/sessions"
ENDS = (
    *("work.cpu-limit", "work.time-limit", "work.memory-limit", "work.not-begun"),
    *("run.too-slow", "session.open.too-slow"),
)
"""How an attack may end."""
Service = tuple[subprocess.Popen, str]


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """Start a service whose computations may take little more than a second of processor time."""
    folder = tmp_path_factory.mktemp("guarded")
    settings = {"job_cpu": 1.2, "job_seconds": 8, "max_seconds": 4, "workers": 2}
    with process(folder, own_workers=True, **settings) as started:
        until(lambda: all(send(started[1], *probe)[0] < 300 for probe in probes(0)))  # compiles what users share
        yield started


def connection(address: str, source: str = USER) -> HTTPConnection:
    host, _, port = address.removeprefix("http://").partition(":")
    return HTTPConnection(host, int(port), 120, (source, 0))


def send(address: str, path: str, body: object = None, source: str = USER) -> tuple[int, dict]:
    """Return the status and the JSON of the answer to a POST, without a body to a GET; {} for another document."""
    link = connection(address, source)
    try:
        link.request("POST" if body else "GET", path, body and json.dumps(body), {"Content-Type": "application/json"})
        answer = link.getresponse()
        data = answer.read()
        return answer.status, json.loads(data) if "json" in answer.getheader("Content-Type", "") else {}
    finally:
        link.close()


def probes(number: int) -> list[tuple[str, dict]]:
    """Return requests that are new to the service: a plant, a seed, a session."""
    plant = PLANT | {"id": f"p{number}", "dynamics": {"x": f"-a*x + u + 0.{number + 1:04d}*x^3"}}
    return [(CHECK, plant), (RUN, spec_data(seed=number)), (SESSION, {"spec": spec_data(seed=1000 + number)})]


def workers_of(pid: int) -> dict[int, float]:
    """Return the worker processes of a service, with the megabytes that each has for itself."""
    workers: dict[int, float] = {}
    for child in _children(pid):
        for worker in _children(child):
            resident, shared = (int(n) for n in Path(f"/proc/{worker}/statm").read_text().split()[1:3])
            workers[worker] = (resident - shared) * os.sysconf("SC_PAGE_SIZE") / 1e6
    return workers


def _children(pid: int) -> list[int]:
    return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]


def test_others_are_answered_while_a_client_makes_the_service_compute(guarded):
    """A new plant, seed and session, the page and health are answered; each attack ends at a limit, with its remedy."""
    started, address = guarded
    requests = {
        "products": (RUN, attacks.observed(attacks.products())),
        "wide": (CHECK, attacks.wide()),
        "wide session": (SESSION, {"spec": attacks.observed(attacks.wide())}),
        "later": (SESSION, attacks.later()),
        "later again": (SESSION, attacks.later(1)),
        "longest": (RUN, attacks.longest(step=0.01, horizon=200_000)),
        "longest again": (RUN, attacks.longest(1, step=0.01, horizon=200_000)),
    }
    before = len(workers_of(started.pid))
    with ThreadPoolExecutor(len(requests)) as pool:
        answers = {name: pool.submit(send, address, *request, ATTACKER) for name, request in requests.items()}
        until(lambda: len(workers_of(started.pid)) > before)
        number, statuses = 1, []
        while not all(answer.done() for answer in answers.values()):
            statuses += [send(address, *probe)[0] for probe in probes(number)]
            statuses += [send(address, path)[0] for path in ("/api/health", "/", "/api/runs")]
            number += 1
        assert set(statuses) <= {200, 201} and number > 1
    for name, answer in answers.items():
        status, document = answer.result()
        problem = document["problem"] if status == 201 else document
        code = problem["errors"][0]["code"] if problem.get("errors") else problem["code"]
        assert status in (201, 422, 503) and code in ENDS, (name, status, code)
        assert "THETASCOPE_" in problem["detail"] or code == "work.not-begun", name
    until(lambda: all(megabytes < 200 for megabytes in workers_of(started.pid).values()))


def test_a_computation_ends_when_its_clients_go_away(guarded):
    """Two requests share it; its process is gone when both have left, although its limit is not reached."""
    started, address = guarded
    links = [connection(address, source) for source in (ATTACKER, USER)]
    for link in links:
        link.request("POST", CHECK, json.dumps(attacks.wide(59)), {"Content-Type": "application/json"})
    until(lambda: health(address)["running"] == 1)
    busy = set(workers_of(started.pid))
    links[0].close()
    assert health(address)["running"] == 1
    links[1].close()
    until(lambda: health(address) == {"running": 0, "waiting": 0})
    until(lambda: not busy <= set(workers_of(started.pid)))


def health(address: str) -> dict:
    """Return the state of the workers in the health of the service."""
    return send(address, "/api/health")[1]["workers"]


def test_a_signal_ends_the_service_while_it_computes(tmp_path):
    """It ends with its workers, and clients that wait for a computation get an answer."""
    with process(tmp_path, own_workers=True, job_seconds=60, job_cpu=60) as (started, address):
        answers: list[tuple[int, dict]] = []
        requests = [(CHECK, attacks.wide()), (SESSION, attacks.later()), (RUN, attacks.longest())]
        threads = [threading.Thread(target=lambda r=r: answers.append(send(address, *r))) for r in requests]
        for thread in threads:
            thread.start()
        until(lambda: health(address)["running"] >= 2)
        pids = [*workers_of(started.pid), *_children(started.pid)]
        started.terminate()
        assert started.wait(60) in (0, -signal.SIGTERM)
        for thread in threads:
            thread.join()
        assert sorted(status for status, _ in answers)[-2:] == [503, 503]
        until(lambda: not any(Path(f"/proc/{pid}").exists() for pid in pids))
