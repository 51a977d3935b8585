"""The report: one file, offline, complete, and deaf to markup in what users type."""

import json
import re
from html.parser import HTMLParser

import pytest

from backend.figures import report

HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(1)>\"'><svg onload=alert(1)>&lt;b&gt;"


class Page(HTMLParser):
    """Elements, attributes and visible text of a page."""

    def __init__(self, html: str):
        super().__init__(convert_charrefs=True)
        self.tags, self.attributes, self.text, self._inside = [], [], [], None
        self.feed(html)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += [(tag, *attribute) for attribute in attrs]
        self._inside = tag

    def handle_endtag(self, tag):
        self._inside = None

    def handle_data(self, data):
        if self._inside not in ("script", "style"):
            self.text.append(data)


@pytest.fixture
def html(experiment, result, plant):
    spec = experiment()
    return report(result(spec), spec, plant, {"id": "abc123", "created": "2025-01-01", "versions": {"thetascope": "0.1"}})


def test_report_is_one_file_that_fetches_nothing(html):
    """No element of the page names another address, and its policy forbids every fetch."""
    page = Page(html)
    assert not [a for a in page.attributes if a[1] in ("src", "href", "action", "data", "poster")]
    assert "default-src 'none'" in html
    assert html.count("Plotly.react(") >= 1 and "plotly.js v" in html


def test_report_says_what_was_run_and_how_to_repeat_it(html):
    """Equations, errata, gains, seed, run, versions, command and the whole spec are in it."""
    text = " ".join(Page(html).text)
    for part in ("Three faults", "A sign is wrong.", "Feed leak", "seed", "abc123", "thetascope 0.1",
                 "thetascope run three-faults.json --out report.html", "holds", "cannot tell", "0.0026", "eq. (36)"):
        assert part in text
    spec = next(part for part in Page(html).text if part.lstrip().startswith("{"))
    assert json.loads(spec)["seed"] == 7


def test_report_tells_errors_and_settling(html):
    """The comparison has the settling time ln(10)/rate of each observer after each step."""
    text = " ".join(Page(html).text)
    assert text.count("1.920") == 3 * 2  # ln(10)/1.2 = 1.919 s, on the grid of 0.01 s: reached, and stayed
    assert text.count("7.680") == 3 * 2  # ln(10)/0.3 = 7.675 s


def test_divergence_is_said_first(experiment, result, plant):
    """An observer that diverged is named before any figure, with the time and the cause."""
    spec = experiment()
    html = report(result(spec, lost={"slow": 50.0}), spec, plant, {})
    assert html.index("slow diverged at 50 s: a finite escape") < html.index("<figure>")


def test_markup_in_user_text_stays_text(experiment, result, plant):
    """Hostile titles, texts, captions and units add no element, no attribute and no script."""
    hostile_plant = plant.model_validate(plant.model_dump() | {
        "title": HOSTILE, "description": HOSTILE,
        "states": [s.model_dump() | {"description": HOSTILE, "unit": "<b onclick=x()>"} for s in plant.states],
        "channels": [c.model_dump() | {"title": HOSTILE, "unit": "<img src=x>"} for c in plant.channels]})
    panel = {"title": HOSTILE, "y_title": HOSTILE, "x_title": HOSTILE, "traces": [{"column": "x.x1", "label": HOSTILE}]}
    clean = experiment()
    spec = experiment(title=HOSTILE, description=HOSTILE, source=HOSTILE, errata=[HOSTILE], plant=hostile_plant,
                      figures=[{"name": "f", "title": HOSTILE, "caption": HOSTILE, "panels": [panel]}])
    page = Page(report(result(spec), spec, hostile_plant, {"id": HOSTILE, "command": HOSTILE, "versions": {HOSTILE: HOSTILE}}))
    reference = Page(report(result(clean), clean, plant, {}))
    assert page.tags.count("script") == reference.tags.count("script") == 3
    assert set(page.tags) <= set(reference.tags) | {"ul", "li"}
    assert not [a for a in page.attributes if a[1].startswith("on")]
    assert HOSTILE in "".join(page.text)


def test_figures_in_the_page_are_valid_json(html):
    """The embedded figures parse, and hold no character that could end their element."""
    text = re.search(r"<script type=application/json id=figures>(.*?)</script>", html, re.DOTALL)[1]
    assert "<" not in text
    assert {"data", "layout"} == set(json.loads(text)[0])
