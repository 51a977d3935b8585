"""The catalogues over HTTP."""

import json
import re
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest

from thetascope.client import Client


def test_a_catalogue_comes_with_its_plural_rule_and_an_etag(address):
    """The templates of a language are one document; a request with its ETag is answered without a body."""
    with urlopen(f"{address}/api/messages/zh-CN") as answer:
        data, tag = json.load(answer), answer.headers["etag"]
    assert data["language"] == "zh" and data["plural"] == ["other"]
    assert data["messages"]["common.states"] == ["{n} 个状态"]
    with urlopen(f"{address}/api/messages/en") as answer:
        assert answer.headers["etag"] != tag
        english = json.load(answer)
    assert english["plural"] == ["one", "other"] and english["messages"]["join.or"] == "{head} or {last}"
    with pytest.raises(HTTPError) as caught:
        urlopen(Request(f"{address}/api/messages/zh", headers={"If-None-Match": tag}))
    assert caught.value.code == 304


RUN = {"experiment": "zhao-2012"}
PLANT = {
    "id": "lag",
    "states": [{"name": "x"}],
    "outputs": [{"name": "y", "expression": "x"}],
    "dynamics": {"x": "-x"},
}
REFUSED = [
    ("POST", "/api/runs", RUN | {"set": {"horizon": -1}}, 422),
    ("POST", "/api/runs", RUN | {"set": {"horizn": 1}}, 422),
    ("POST", "/api/runs", RUN | {"set": {"faults.0.end": 1}}, 422),
    ("POST", "/api/runs", RUN | {"set": {"seed": 1.5, "step": "x"}}, 422),
    ("POST", "/api/runs", RUN | {"set": {"observers.0.gains.nope": 1}}, 422),
    ("POST", "/api/runs", RUN | {"set": {"horizon": 1e6, "record": 100}}, 422),
    ("POST", "/api/runs", RUN | {"set": {"faults": [{"channel": "theta1", "shape": "stp"}]}}, 422),
    ("POST", "/api/runs", {"experiment": "zhao-2021"}, 404),
    ("POST", "/api/runs", {"nothing": 1}, 422),
    ("POST", "/api/runs", "{", 422),
    ("POST", "/api/runs", " " * 300_000, 413),
    ("GET", "/api/runs/0123456789abcdef", None, 404),
    ("GET", "/api/runs?limit=0", None, 422),
    ("GET", "/api/lessons/nothing", None, 404),
    ("GET", "/api/plants/zhao-contoiss", None, 404),
    ("GET", "/api/nothing", None, 404),
    ("PATCH", "/api/runs", {}, 405),
    ("GET", "/api/sessions/none", None, 404),
    ("POST", "/api/sessions", {}, 422),
    ("POST", "/api/sessions", RUN | {"set": {"observers.0.kind": "ekf"}}, 422),
    ("POST", "/api/runs", RUN | {"set": {"observers.0.gains.rho": -1}}, 422),
    ("POST", "/api/runs", {"plant": PLANT | {"dynamics": {"x": "-x +"}}, "horizon": 1}, 422),
    ("POST", "/api/runs", {"plant": PLANT | {"dynamics": {"x": "-x*foo"}}, "horizon": 1}, 422),
    ("POST", "/api/plants/check", PLANT | {"dynamics": {"x": "9**9**9"}}, 422),
    ("POST", "/api/diagnosis", {"plant": "zhao-contois", "csv": "t,u\n0,1\nx,2\n"}, 422),
    ("POST", "/api/diagnosis", {"plant": "zhao-contois"}, 422),
    ("POST", "/api/plants/check", {"id": "a", "states": [], "outputs": [], "dynamics": {}}, 422),
]


def problem_of(address, method, path, body, headers):
    """Send a request that is refused; return its status, headers and problem document."""
    data = body.encode() if isinstance(body, str) else None if body is None else json.dumps(body).encode()
    with pytest.raises(HTTPError) as caught:
        urlopen(Request(address + path, data, {"Content-Type": "application/json", **headers}, method=method))
    return caught.value.code, caught.value.headers, json.load(caught.value)


@pytest.mark.parametrize(("method", "path", "body", "status"), REFUSED, ids=lambda value: str(value)[:50])
def test_every_refusal_is_chinese_if_chinese_is_requested(address, method, path, body, status):
    """Title, problem and remedy are in the language of Accept-Language, which the answer states."""
    code, headers, problem = problem_of(address, method, path, body, {"Accept-Language": "zh-CN,zh;q=0.9,en;q=0.5"})
    assert code == status
    assert headers["content-language"] == "zh" and "Accept-Language" in headers["vary"]
    sentences = [problem["title"], problem["detail"]]
    sentences += [error[part] for error in problem.get("errors", []) for part in ("problem", "remedy")]
    for text in sentences:
        assert re.search("[\u4e00-\u9fff]", text), text
    assert problem["code"]


def test_lang_overrides_accept_language_and_english_is_the_default(address):
    """?lang= is for links; an unknown language is answered in English."""
    path = "/api/runs/0123456789abcdef"
    for suffix, accept, language in (
        ("?lang=zh", "en", "zh"),
        ("?lang=en", "zh", "en"),
        ("", "fr", "en"),
        ("", "", "en"),
    ):
        _, headers, _ = problem_of(address, "GET", path + suffix, None, {"Accept-Language": accept} if accept else {})
        assert headers["content-language"] == language


def test_answers_without_sentences_do_not_depend_on_the_language(address):
    """Caches need not store them once per language."""
    with urlopen(f"{address}/api/health?lang=zh") as answer:
        assert "content-language" not in answer.headers and "Accept-Language" not in answer.headers.get("vary", "")


@pytest.mark.parametrize("path", ["/api/plants", "/api/experiments", "/api/catalogue", "/api/plants/dc-motor"])
def test_the_library_is_answered_in_the_requested_language(address, path):
    """Titles and descriptions are in the requested language, by default in English."""
    texts = {}
    for language in ("en", "zh"):
        with urlopen(Request(address + path, headers={"Accept-Language": language})) as answer:
            assert answer.headers["content-language"] == language
            texts[language] = answer.read().decode()
    assert "DC motor" in texts["en"] and not re.search("[\u4e00-\u9fff]", texts["en"])
    assert "直流电机" in texts["zh"] and "DC motor" not in texts["zh"]


def test_a_plant_can_be_read_in_all_its_languages(address):
    """?lang=* returns the maps of languages, so that an edited copy loses none."""
    with urlopen(f"{address}/api/plants/dc-motor?lang=*") as answer:
        plant = json.load(answer)
    assert plant["title"] == {"en": "DC motor with load and friction", "zh": "带负载和摩擦的直流电机"}
    body = json.dumps(plant).encode()
    with urlopen(Request(f"{address}/api/plants/check", body, {"Content-Type": "application/json"})) as answer:
        assert json.load(answer)["valid"]


def test_a_run_keeps_the_languages_of_its_texts(client, address):
    """The store keeps every language; answers and the list of runs use the requested one."""
    run = client.run("dc-motor", {"horizon": 0.1})
    for language, title in (("en", "DC motor: actuator"), ("zh", "直流电机：执行器")):
        with urlopen(f"{address}/api/runs/{run['id']}?lang={language}") as answer:
            assert json.load(answer)["spec"]["title"].startswith(title)
        with urlopen(f"{address}/api/runs?lang={language}") as answer:
            (listed,) = [line for line in json.load(answer)["runs"] if line["id"] == run["id"]]
        assert listed["title"].startswith(title)


SENTENCE = re.compile(r"[A-Za-z][a-z’'-]*[a-z](?:,? [A-Za-z]?[a-z’'-]*[a-z])+")  # two Latin words in a row
DIVERGES = {"horizon": 4, "faults": [], "observers.1.gains.L": [-40, 1, 1, 1]}


def sentences(data: object, name: str = "") -> list[str]:
    """Return the English sentences in an answer; arguments, citations and fixed values are not sentences."""
    if isinstance(data, dict):
        plain = ("spec", "args", "source", "verdict", "math")
        return [text for key, value in data.items() if key not in plain for text in sentences(value, key)]
    if isinstance(data, list):
        return [text for value in data for text in sentences(value, name)]
    return [data] if isinstance(data, str) and SENTENCE.search(data) else []


@pytest.fixture(scope="module")
def diverged(address) -> str:
    """Return the address of a run in which an observer and the plant diverge."""
    with Client(address, timeout=60) as client:
        return f"{address}/api/runs/{client.run('reduced-order-mimo', DIVERGES)['id']}"


def answer_of(url: str) -> dict:
    with urlopen(url) as answer:
        return json.load(answer)


def test_a_run_is_answered_in_the_requested_language(diverged):
    """Titles, checks, causes, notes and the summary of a run that diverged have no English sentence with ?lang=zh."""
    summary = answer_of(f"{diverged}?lang=zh")["summary"]
    checks = [check for one in summary["observers"] for check in one["checks"]]
    assert summary["diverged"] and summary["notes"] and any(one["diverged"] for one in summary["observers"])
    assert {"fails", "holds"} <= {check["verdict"] for check in checks}
    assert sentences(summary) == []
    english = answer_of(f"{diverged}?lang=en")["summary"]
    assert sentences(english["notes"]) and sentences(english["diverged"]) and sentences(english["observers"])


@pytest.mark.parametrize("path", ["/api/catalogue", "/api/equations/zhou-tan-2012"])
def test_observers_are_described_in_the_requested_language(address, path):
    """Observers, plants, gains, options, symbols and equations have no English sentence with ?lang=zh."""
    assert sentences(answer_of(f"{address}{path}?lang=zh")) == []
    assert sentences(answer_of(f"{address}{path}?lang=en"))
