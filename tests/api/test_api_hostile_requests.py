"""Requests made to harm, sent to every operation that the document names: none is an error of the program.

New operations are included, as they come from the document.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from http.client import HTTPConnection
from itertools import pairwise
from urllib.parse import quote, urlencode

import pytest

from tests.api.conftest import service
from thetascope.client import Client

ALIASES = "a: &a [x, x]\n" + "".join(f"{b}: &{b} [{', '.join([f'*{a}'] * 9)}]\n" for a, b in pairwise("abcdefghi"))
MERGES = "a: &a {k: v}\n" + "".join(
    f"{b}: &{b} {{<<: [{', '.join([f'*{a}'] * 9)}], z: 1}}\n" for a, b in pairwise("abcdefg")
)
JSON, YAML = "application/json", "application/yaml"
BODIES: dict[str, tuple[str, str | bytes]] = {
    "alias bomb": (YAML, ALIASES),
    "merge bomb": (YAML, MERGES),
    "recursion": (YAML, "a: &a [*a]\n"),
    "deep flow": (YAML, "[" * 50_000),
    "deep block": (YAML, "\n".join(" " * i + "a:" for i in range(500))),
    "sexagesimal": (YAML, "horizon: " + ":".join(["59"] * 20_000)),
    "YAML not a number": (YAML, "horizon: .nan\nvalues: [.inf, -.inf]\n"),
    "tag": (YAML, "!!python/object/apply:os.system [exit]"),
    "date": (YAML, "horizon: 2001-99-99\n"),
    "many documents": (YAML, "--- a\n" * 10_000),
    "many keys without values": (YAML, "? " * 10_000),
    "deep JSON": (JSON, "[" * 100_000 + "]" * 100_000),
    "deep objects": (JSON, '{"a":' * 50_000 + "1" + "}" * 50_000),
    "huge integer": (JSON, f'{{"horizon": {"9" * 20_000}}}'),
    "not a number": (JSON, '{"horizon": NaN, "values": [NaN, Infinity, 1e999]}'),
    "surrogates": (JSON, r'{"id": "\ud800", "name": "\udfff", "text": "\ud800", "plant": "\ud800"}'),
    "zero bytes": (JSON, r'{"id": "\u0000", "name": "a\u0000", "text": "\u0000", "plant": "\u0000"}'),
    "not UTF-8": (JSON, b"\xff\xfe\xfa{}"),
    "UTF-16": (JSON, "{}".encode("utf-16")),
    "unknown charset": (f"{JSON}; charset=none", "{}"),
    "empty object": (JSON, "{}"),
    "list": (JSON, "[]"),
    "null": (JSON, "null"),
    "empty": (JSON, ""),
}
VALUES = (
    *("1" + "0" * 30, "-1" + "0" * 30, str(2**63), str(2**31), "-1", "nan", "inf", "-inf", "1e400", "0x10", "٣"),
    *("\0", "a,b" * 100, "=1+1", "../../etc/passwd", "\r\nX-A: b", "💥", "9" * 5000, "[" * 300),
)
RAW = ("%ff", "%ed%a0%80")
"""Values that are not UTF-8."""


@dataclass
class Target:
    """A service with one of everything, and its operations: method, address, parameters, whether they have a body."""

    connection: HTTPConnection
    operations: list[tuple[str, str, list[str], bool]]

    def answer(self, method: str, path: str, kind: str | None = None, body: str | bytes | None = None) -> None:
        """Send a request, and fail on an error of the program."""
        data = body.encode() if isinstance(body, str) else body
        self.connection.request(method, path, data, {"Content-Type": kind} if kind else {})
        answer = self.connection.getresponse()
        content = answer.read()
        if answer.status >= 400:
            self.connection.close()
        assert answer.status < 500, (method, path[:300], body and body[:80], content[:300])


@pytest.fixture(scope="module")
def target(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Target]:
    with service(tmp_path_factory.mktemp("hostile"), max_seconds=10, max_body="2M") as address:
        with Client(address) as client:
            ids = {"runs": client.run("zhao-2012", {"horizon": 1})["id"], "experiments": "zhao-2012"}
            ids |= {"sessions": client.post("/api/sessions", {"experiment": "zhao-2012", "play": False})["id"]}
            client.request("PUT", "/api/my-plants/mine", b"id: mine\n", {"Content-Type": YAML})
            rows = "t,u,y\n" + "".join(f"{k},1,{k}\n" for k in range(30))
            kind = {"Content-Type": "text/csv"}
            client.request("POST", "/api/records?name=r.csv&plant=dts200", rows.encode(), kind)
            ids |= {"my-plants": "mine", "plants": "dts200", "equations": "zhao-2012"}
            ids |= {"records": client.get("/api/records")["records"][0]["id"]}
            document = client.get("/openapi.json")
        connection = HTTPConnection(address.removeprefix("http://"), timeout=120)
        yield Target(connection, operations_of(document, ids))
        connection.close()


def operations_of(document: dict, ids: dict[str, str]) -> list[tuple[str, str, list[str], bool]]:
    """Return the operations of a document but DELETE, with ids of what there is in their addresses."""
    found = []
    for path, methods in document["paths"].items():
        group = path.split("/")[2] if path.count("/") > 1 else ""
        address = re.sub(r"\{[^}]*\}", "states", path.replace("{id}", ids.get(group, "none")))
        for method, operation in methods.items():
            if isinstance(operation, dict) and method in ("get", "post", "put", "patch"):
                names = [one["name"] for one in operation.get("parameters", []) if one["in"] == "query"]
                found.append((method.upper(), address, names, "requestBody" in operation))
    return found


@pytest.mark.parametrize("name", BODIES)
def test_a_body_made_to_harm_is_refused_by_every_operation(target: Target, name: str):
    """Bombs of aliases, depth and digits, numbers that are not finite, and text that is not text."""
    bodies = [(method, path) for method, path, _, has_body in target.operations if has_body]
    assert len(bodies) > 20
    for method, path in bodies:
        target.answer(method, path, *BODIES[name])


def test_a_query_made_to_harm_is_refused_by_every_operation(target: Target):
    """Every parameter gets numbers beyond all bounds, and text that is not text."""
    count = 0
    for method, path, names, has_body in target.operations:
        for name in set(names) - {"lang"}:  # `lang` is the same everywhere
            for value in (*map(quote, VALUES), *RAW):
                query = f"{urlencode({'ids': 'x,y'})}&{name}={value}" if "compare" in path else f"{name}={value}"
                target.answer(method, f"{path}?{query}", *((JSON, "{}") if has_body else ()))
                count += 1
    target.answer("GET", "/api/catalogue?lang=%00%ff")
    assert count > 1000


def test_every_operation_checks_host_and_origin(target: Target):
    """A name that leads here by rebinding reads nothing, and a page of another site changes nothing, wherever."""

    def status(method: str, path: str, **headers: str) -> int:
        target.connection.request(method, path, headers=headers)
        answer = target.connection.getresponse()
        answer.read()
        target.connection.close()
        return answer.status

    assert len(target.operations) > 60
    for method, path, _, _ in target.operations:
        assert status(method, path, Host="evil.example") == 421, (method, path)
        if method != "GET":
            for origin in ("https://evil.example", "null"):
                assert status(method, path, Origin=origin) == 403, (method, path)
