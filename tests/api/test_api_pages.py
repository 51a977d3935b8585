"""The files that a browser loads: types, caching, content policy, and no request to another host."""

import gzip
import json
import re

import pytest

import thetascope
from thetascope.api.http.page_files import page_files
from thetascope.client import ServiceError
from thetascope.engine.observers.registry import kinds


def test_plotly_is_served_from_the_wheel_compressed_and_cached(client):
    """Its version is the one for which the figures are made."""
    from importlib.metadata import version

    status, headers, plain = client.request("GET", "/assets/plotly.min.js")
    assert status == 200 and headers["content-type"].startswith("text/javascript")
    assert b"plotly.js v" in plain[:200] and version("plotly")
    client._connection.request("GET", "/assets/plotly.min.js", headers={"Accept-Encoding": "gzip"})
    answer = client._connection.getresponse()
    assert gzip.decompress(answer.read()) == plain
    client._connection.request("GET", "/assets/plotly.min.js", headers={"If-None-Match": answer.headers["etag"]})
    again = client._connection.getresponse()
    assert (again.status, again.read()) == (304, b"")


@pytest.mark.parametrize("page", ["/docs", "/redoc"])
def test_the_documentation_loads_only_files_of_this_service(client, page):
    """It works offline: every script and style is served with its type; no script is inline."""
    html = client.request("GET", page)[2].decode()
    loaded = re.findall(r'(?:src|href)="(?!data:)([^"]+)"', html)
    assert loaded and all(path.startswith("/assets/") for path in loaded)
    for path in loaded:
        _, headers, content = client.request("GET", path)
        assert content and headers["content-type"].split(";")[0] in ("text/javascript", "text/css")
        assert b"://cdn." not in content
    assert not re.search(r"<script[^>]*>[^<]", html)


@pytest.mark.parametrize("page", ["/", "/runs/", "/records/", "/workshop/"])
def test_a_document_is_revalidated_and_its_files_are_kept(client, page):
    """Scripts and styles have versioned addresses, immutable for a year; the document and plain addresses do not."""
    _, headers, html = client.request("GET", page)
    assert headers["cache-control"] == "no-cache" and headers["content-type"].startswith("text/html")
    loaded = re.findall(r'(?:src|href)="([^"]+\.(?:js|css|svg))"', html.decode())
    assert len(loaded) > 8 and len({path.split("/")[2] for path in loaded}) == 1
    for path in loaded:
        _, kept, content = client.request("GET", path)
        assert "immutable" in kept["cache-control"] and "max-age=31536000" in kept["cache-control"]
        plain = "/" + path.split("/", 3)[3]
        _, revalidated, same = client.request("GET", plain)
        assert revalidated["cache-control"] == "no-cache" and same == content
    client._connection.request("GET", page, headers={"If-None-Match": headers["etag"]})
    again = client._connection.getresponse()
    assert (again.status, again.read()) == (304, b"")


def test_a_file_of_another_version_is_served_and_not_kept(client):
    """A page that was loaded before an update still finds its modules, and no browser keeps them under that address."""
    _, headers, content = client.request("GET", "/static/0123456789abcdef/common/dom.js")
    assert headers["cache-control"] == "no-cache" and content == client.request("GET", "/common/dom.js")[2]
    for path in ("/static/0123456789abcdef/none.js", "/static/x/../../settings.py", "/static/x", "/static/"):
        with pytest.raises(ServiceError) as refusal:
            client.request("GET", path)
        assert refusal.value.status == 404


def test_the_version_changes_with_any_file(tmp_path):
    """It is that of the content: written back, a file has its version again."""
    for name in ("a.js", "b.css", "index.html"):
        (tmp_path / name).write_text("1")
    before = page_files(tmp_path)
    assert set(before.signatures) == {"a.js", "b.css"} and page_files(tmp_path) == before
    (tmp_path / "b.css").write_text("12")
    after = page_files(tmp_path)
    assert after.version != before.version and after.signatures["b.css"] != before.signatures["b.css"]
    (tmp_path / "b.css").write_text("1")
    assert page_files(tmp_path).version == before.version


def test_every_answer_has_the_security_headers(client):
    """Pages, data and problem documents have them."""
    for path in ("/docs", "/api/health", "/openapi.json"):
        headers = client.request("GET", path)[1]
        assert "default-src 'self'" in headers["content-security-policy"]
        assert "script-src 'self';" in headers["content-security-policy"]
        assert (headers["x-content-type-options"], headers["referrer-policy"]) == ("nosniff", "no-referrer")


def test_files_outside_the_page_are_not_served(client):
    """No path leads out of the page's folder."""
    for path in (
        "/../backend/thetascope/settings.py",
        "/%2e%2e/backend/thetascope/settings.py",
        "/assets/../settings.py",
        "/assets/settings.py",
    ):
        with pytest.raises(ServiceError) as refusal:
            client.request("GET", path)
        assert refusal.value.status == 404


def test_the_openapi_document_is_complete(client):
    """Every schema that it refers to is in it, with units, bounds and an example; bodies read by hand are described,
    too."""
    document = client.get("/openapi.json")
    schemas = document["components"]["schemas"]
    referred = set(re.findall(r'"#/components/schemas/([^"]+)"', json.dumps(document)))
    assert referred <= set(schemas)
    body = document["paths"]["/api/runs"]["post"]["requestBody"]["content"]["application/json"]["schema"]
    assert body["anyOf"][0]["$ref"].endswith("/Experiment")
    assert schemas["Experiment"]["examples"] and schemas["Parameter"]["properties"]["unit"]
    assert {"Plant", "RunRequest", "Problem", "Run", "Progress"} <= set(schemas)


def test_the_catalogue_suffices_for_the_forms(client):
    """It has every observer with its gains and their meaning, and every fault shape and signal with typed fields."""
    catalogue = client.catalogue()
    assert [kind["id"] for kind in catalogue["observers"]] == list(kinds())
    zhao = next(kind for kind in catalogue["observers"] if kind["id"] == "zhao-adaptive")
    rho = next(gain for gain in zhao["gains"] if gain["name"] == "rho")
    assert rho["meaning"] and rho["positive"] and rho["high"] is None
    shapes = {fault["shape"]: fault for fault in catalogue["faults"]}
    assert len(shapes) == 15 and shapes["stuck"]["on"] == "output" and shapes["ramp"]["on"] == "channel"
    duration = next(field for field in shapes["ramp"]["fields"] if field["name"] == "duration")
    assert (duration["type"], duration["required"], duration["above"]) == ("number", True, 0)
    assert {signal["kind"] for signal in catalogue["signals"]} >= {"constant", "steps", "pulse", "sine", "expression"}
    assert {plant["id"] for plant in catalogue["plants"]} >= {"dts200", "dc-motor", "quadruple-tank"}


def test_library_items_are_complete_specs(client):
    """A library experiment can be changed and posted as a run."""
    lines = client.get("/api/experiments")["experiments"]
    assert {line["id"] for line in lines} >= {"zhao-2012", "shen-hu-2015", "reduced-order-mimo", "zhou-tan-2012"}
    plant = client.get(client.get("/api/plants")["plants"][0]["href"])
    assert client.check(plant)["valid"]


def test_health_and_openapi_state_the_version_of_the_package(client):
    """Both return thetascope.__version__."""
    assert client.health()["version"] == thetascope.__version__
    assert client.get("/openapi.json")["info"]["version"] == thetascope.__version__
