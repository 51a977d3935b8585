"""Owners of runs over REST: a browser, another browser, scripts with and without a name."""

from http.client import HTTPConnection
from urllib.parse import urlsplit

import pytest

from tests.api.conftest import service
from tests.runs.samples import long_data, spec_data
from thetascope.client import Client, ServiceError

KEY = "an-access-key-of-the-tests"


def browser(address: str) -> Client:
    """Return a client with the cookie of a browser that signed in by the link."""
    connection = HTTPConnection(urlsplit(address).netloc, timeout=60)
    connection.request("GET", f"/?key={KEY}")
    cookie = connection.getresponse().getheader("set-cookie").partition(";")[0]
    connection.close()
    client = Client(address)
    client._access = {"Cookie": cookie}
    return client


def refused(client: Client, method: str, path: str) -> dict:
    """Return the problem of a request that only an owner may send."""
    with pytest.raises(ServiceError) as refusal:
        client.request(method, path)
    assert refusal.value.status == 403 and ";" in refusal.value.problem["detail"]
    return refusal.value.problem


def test_only_owners_cancel_pin_and_remove(tmp_path):
    """A browser's run is closed to another browser and to scripts, and readable for all who have the key."""
    with service(tmp_path, host="0.0.0.0", key=KEY, wait=60) as address:
        ann, eve, script = browser(address), browser(address), Client(address, key=KEY)
        named, other = (Client(address, key=KEY, name=name) for name in ("a secret of mine", "another one"))
        run = ann.post("/api/runs", spec_data())["links"]
        for client in (eve, script, named):
            assert client.get(run["self"])["status"] == "done"
            for method, path in (("DELETE", run["self"]), ("PUT", run["pin"]), ("DELETE", run["pin"])):
                assert refused(client, method, path)["code"] == "run.not-owner"
        running = named.post("/api/runs?wait=0", long_data())["links"]
        for client in (ann, script, other):
            assert refused(client, "POST", running["cancel"])["code"] == "run.not-owner"
            refused(client, "DELETE", running["self"])
        assert named.request("DELETE", running["self"])[0] in (202, 204)

        assert script.post("/api/runs", spec_data())["id"] == ann.get(run["self"])["id"]
        assert refused(script, "DELETE", run["pin"])["code"] == "run.pin.shared"
        assert script.request("DELETE", run["self"])[0] == 200
        assert ann.request("DELETE", run["self"])[0] == 204
        for client in (ann, eve, script, named, other):
            client.close()


def test_on_the_machine_page_and_scripts_are_one_owner(client, address):
    """A run that curl started is removed by the page on the same machine, and the other way round."""
    page = {"Origin": address, "Sec-Fetch-Site": "same-origin", "Cookie": "thetascope-0=x"}
    run = client.post("/api/runs", spec_data(seed=71))["links"]
    assert client.request("DELETE", run["self"], headers=page)[0] == 204
    run = client.post("/api/runs", spec_data(seed=72), headers=page)["links"]
    assert client.request("DELETE", run["self"])[0] == 204
