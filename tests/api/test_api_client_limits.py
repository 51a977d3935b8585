"""The limits of one client: 429 with the limit and the remedy; other clients are not concerned."""

import pytest

from tests.api.conftest import service, until
from tests.api.streams import closed, opened, watching
from tests.runs.samples import spec_data
from thetascope.client import Client, ServiceError
from thetascope_schemas.service.session import CLOSE_SOCKETS

KEY = "an-access-key-of-the-tests"
ANOTHER = {"X-Forwarded-For": "10.0.0.2"}
LONG = {"horizon": 1000, "step": 0.0001, "record": 1, "seed": 1}


def refused(ask) -> ServiceError:
    """Return the refusal of a request that is over a limit."""
    with pytest.raises(ServiceError) as refusal:
        ask()
    assert refusal.value.status == 429 and ";" in refusal.value.problem["detail"]
    return refusal.value


def test_each_limit_refuses_one_more(tmp_path):
    """Runs, forks and sessions, websockets; what has ended counts no longer."""
    limits = {"client_runs": 1, "client_sessions": 2, "client_sockets": 1, "wait": 0}
    with (
        service(tmp_path, host="0.0.0.0", key=KEY, **limits) as address,
        Client(address, key=KEY) as client,
    ):
        running = client.post("/api/runs", spec_data(**LONG))
        another = spec_data(**LONG | {"seed": 2})
        assert refused(lambda: client.post("/api/runs", another)).problem["code"] == "client.runs"
        assert client.post("/api/runs", spec_data(**LONG))["id"] == running["id"]
        elsewhere = client.post("/api/runs", another, headers=ANOTHER)
        for run in (running, elsewhere):
            client.cancel(run["id"])
        until(lambda: client.get(running["links"]["progress"])["status"] == "cancelled")
        third = client.post("/api/runs", spec_data(**LONG | {"seed": 3}))
        client.cancel(third["id"])

        session = opened(client)
        fork = client.post(session["links"]["fork"])
        for ask in (lambda: opened(client), lambda: client.post(session["links"]["fork"])):
            assert refused(ask).problem["code"] == "client.sessions"
        assert client.post(session["links"]["fork"], headers=ANOTHER)["id"]
        client.request("DELETE", fork["links"]["self"], headers={"X-Control-Token": fork["token"]})
        assert opened(client)["id"]

        headers = {"X-Access-Key": KEY}
        with watching(address, session, additional_headers=headers) as first:
            assert first.receive()["type"] == "hello"
            with watching(address, session, additional_headers=headers) as second:
                assert closed(second) == CLOSE_SOCKETS
            with watching(address, session, additional_headers=headers | ANOTHER) as page:
                assert page.receive()["type"] == "hello"


def test_processor_time_of_computations_is_limited(tmp_path):
    """A client that has used its share within a minute waits; stored results are still answered, dropped ones not."""
    with (
        service(tmp_path, host="0.0.0.0", key=KEY, client_cpu=0.01, wait=60, memory=1, store_limit=150_000) as address,
        Client(address, key=KEY) as client,
    ):
        run = client.run(spec_data())
        plant = spec_data()["plant"]
        for ask in (
            lambda: client.post("/api/runs", spec_data(seed=2)),
            lambda: client.check(plant),
            lambda: opened(client),
        ):
            assert refused(ask).problem["code"] == "client.cpu"
        with pytest.raises(ServiceError) as refusal:
            client.check(plant)
        assert 0 < refusal.value.problem["args"]["limit"] <= refusal.value.problem["args"]["used"]
        assert client.get(run["links"]["self"])["status"] == "done"
        assert client.get(f"{run['links']['data']}?format=json")["columns"]
        newer = client.post("/api/runs", spec_data(seed=3), headers=ANOTHER)
        client.request("PUT", newer["links"]["pin"])  # waits until it is stored, for which the older one is dropped
        dropped = f"{run['links']['data']}?format=json"
        assert refused(lambda: client.get(dropped)).problem["code"] == "client.cpu"
        assert client.request("GET", dropped, headers={"X-Forwarded-For": "10.0.0.3"})[0] == 200
