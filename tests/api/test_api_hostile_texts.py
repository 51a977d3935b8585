"""Text made to harm in every field that takes any, and every file that the service makes of it."""

import csv
import io
import json
import re
from collections.abc import Iterator
from html.parser import HTMLParser
from typing import Any

import pytest
from pydantic import ValidationError

from thetascope import library
from thetascope.client import Client
from thetascope_schemas import Experiment

TEXT = (
    '=HYPERLINK("x")</script><script>alert(1)</script><img src=x onerror=alert(2)>'
    "\\input{/x}$^^5cinput{y} %#&_~\r@SUM(1)"
)
SHORT = "=1</i><script>\\input{x}%\r@"
"""The same for fields that take fewer characters."""
_READ = ("expression", "dynamics", "enters", "definitions", "column", "options", "gains")
"""Fields whose text is read as an expression or a name: the engine refuses all other text in them."""
FORMULA = re.compile(r"\s*[=+\-@＝＋－＠]")


def with_hostile_texts(data: dict[str, Any]) -> tuple[dict[str, Any], int]:
    """Return an experiment with hostile text in every field that accepts it, and the number of these fields."""
    count = 0
    for parent, key in list(_texts(data)):
        before = parent[key]
        for text in (TEXT, SHORT):
            parent[key] = text
            try:
                Experiment.model_validate(data)
            except ValidationError:
                parent[key] = before
            else:
                count += 1
                break
    return data, count


def _texts(value: Any) -> Iterator[tuple[Any, Any]]:
    """Yield the place of every text in JSON data: its object or list, and its key."""
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
        if key in _READ:
            continue
        if isinstance(inner, str):
            yield value, key
        elif isinstance(inner, dict | list):
            yield from _texts(inner)


class Tags(HTMLParser):
    """The elements and attributes of a page."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += [name for name, _ in attrs]


@pytest.fixture(scope="module")
def runs(address: str) -> Iterator[tuple[Client, str, str]]:
    """Return a client and two runs: the first with hostile texts, the other as the library has it."""
    plain = library.experiment("zhao-2012").model_dump(mode="json", exclude_unset=True) | {"horizon": 30}
    plain["plant"] = library.plant(plain["plant"]).model_dump(mode="json", exclude_unset=True)
    plain["plant"] |= {"id": "hostile", "description": "x", "source": "x"}
    for entry in (*plain["plant"]["states"], *plain["plant"]["channels"], *plain["plant"]["outputs"]):
        entry |= {"unit": "m", "description": "x"}
    hostile, count = with_hostile_texts(json.loads(json.dumps(plain)))
    assert count >= 20
    with Client(address, timeout=120) as client:
        ids = [client.post("/api/runs?wait=60", spec)["id"] for spec in (hostile, plain | {"seed": 99})]
        notes = json.dumps({"name": "=1+1 <script>alert(1)</script> \\input{x}", "tags": ["@x<b>"]}).encode()
        client.request("PATCH", f"/api/runs/{ids[0]}", notes, {"Content-Type": "application/json"})
        yield client, *ids


def answer(client: Client, path: str) -> str:
    status, _, content = client.request("GET", path)
    assert status == 200, content[:300]
    return content.decode()


def test_no_cell_begins_a_formula(runs):
    """In the columns of a run and in its comparison; every line has as many cells as the head."""
    client, hostile, _ = runs
    for path in ("data?format=csv&points=5", "comparison?format=csv"):
        lines = list(csv.reader(io.StringIO(answer(client, f"/api/runs/{hostile}/{path}"))))
        assert len(lines) > 3 and {len(line) for line in lines} == {len(lines[0])}
        for cell in (cell for line in lines for cell in line):
            assert not FORMULA.match(cell) or _is_number(cell), cell


def test_a_report_has_no_element_of_a_text(runs):
    """It has the elements and attributes of the other run's, and its texts in lists."""
    client, hostile, plain = runs
    page, other = (Tags(answer(client, f"/api/runs/{id}/report")) for id in (hostile, plain))
    assert page.tags.count("script") == other.tags.count("script") and page.tags.count("img") == other.tags.count("img")
    assert set(page.tags) <= set(other.tags) | {"ul", "li", "p", "dt", "dd"}
    assert not [name for name in page.attributes if name.startswith("on")]


@pytest.mark.parametrize("less", [False, True])
def test_no_figure_has_a_command_of_a_text(runs, less):
    """TikZ has its own commands only; SVG has no script, and PDF and PNG are made."""
    client, hostile, plain = runs
    base = f"/api/runs/compare/figure/print?ids={hostile},{plain}" if less else None
    figures = [figure["name"] for figure in client.get(f"/api/runs/{hostile}/figures")["figures"]]
    bases = [base] if base else [f"/api/runs/{hostile}/figures/{name}/print?size=8" for name in figures]
    for path in bases:
        text = answer(client, f"{path}&format=tex").replace("\\textbackslash{}", "")
        commands = re.sub(r"(?<!\\)%.*", "", text)
        assert commands.endswith("\n\\end{tikzpicture}\n")
        assert not re.search(r"\\(input|write|include|openin|catcode|immediate)\b", commands)
        assert "^^" not in commands and "\r" not in text
        svg = Tags(answer(client, f"{path}&format=svg"))
        assert not {"script", "img", "foreignobject"} & set(svg.tags)
        assert not [name for name in svg.attributes if name.startswith("on")]
        for kind in ("pdf", "png"):
            status, _, content = client.request("GET", f"{path}&format={kind}")
            assert status == 200 and content[:4] in (b"%PDF", b"\x89PNG")


def test_a_notebook_runs_nothing_of_a_text(runs):
    """Its cells are Python, in which texts are literals."""
    import ast

    client, hostile, _ = runs
    cells = json.loads(answer(client, f"/api/runs/{hostile}/notebook"))["cells"]
    code = [ast.parse("".join(cell["source"])) for cell in cells if cell["cell_type"] == "code"]
    assert code
    for cell in cells:
        if cell["cell_type"] == "markdown":
            assert "<script" not in "".join(cell["source"])


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
