"""The report: one file, offline, complete, with users' texts escaped."""

import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest
from markupsafe import Markup, escape
from pydantic import TypeAdapter

from tests.engine.loops import experiment as loop_experiment
from tests.engine.loops import level
from tests.simulate import simulate
from thetascope.engine.model.result import Check
from thetascope.figures.figure_data import FigureData
from thetascope.figures.general_figures import build
from thetascope.figures.html_symbols import symbol
from thetascope.messages import Message
from thetascope.report import words
from thetascope.report.html_report import report
from thetascope.report.words import ReportContext, mark
from thetascope_schemas.experiment.commands import TimedCommand
from thetascope_schemas.experiment.diagnosis import Diagnosis, ObserverDiagnosis

HOSTILE = "</script><script>alert(1)</script><img src=x onerror=alert(1)>\"'><svg onload=alert(1)>&lt;b&gt;"
_COMMANDS = TypeAdapter(tuple[TimedCommand, ...])


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
    about = {"id": "abc123", "created": "2025-01-01", "versions": {"thetascope": "0.1"}}
    return report(result(spec), spec, plant, about)


def test_report_is_one_file_that_fetches_nothing(html):
    """No element of the page refers to another address, and its policy forbids every fetch."""
    page = Page(html)
    assert not [a for a in page.attributes if a[1] in ("src", "href", "action", "data", "poster")]
    assert "default-src 'none'" in html
    assert html.count("Plotly.react(") >= 1 and "plotly.js v" in html


def test_the_report_describes_the_run_and_how_to_repeat_it(html):
    """It has equations, errata, gains, seed, run, versions, command and the whole spec."""
    text = " ".join(Page(html).text)
    for part in (
        "Three faults",
        "A sign is wrong.",
        "Feed leak",
        "seed",
        "abc123",
        "thetascope 0.1",
        "thetascope run three-faults.json --out report.html",
        "holds",
        "cannot tell",
        "0.0026",
        "eq. (36)",
    ):
        assert part in text
    spec = next(part for part in Page(html).text if part.lstrip().startswith("{"))
    assert json.loads(spec)["seed"] == 7


def test_the_report_has_errors_and_settling(html):
    """The comparison has the settling time ln(10)/rate of each observer after each step."""
    text = " ".join(Page(html).text)
    assert text.count("1.920") == 3 * 2  # ln(10)/1.2 = 1.919 s, on the grid of 0.01 s: reached, and stayed
    assert text.count("7.680") == 3 * 2  # ln(10)/0.3 = 7.675 s


def test_divergence_is_reported_first(experiment, result, plant):
    """An observer that diverged is named before any figure, with the time and the cause."""
    spec = experiment()
    html = report(result(spec, lost={"slow": 50.0}), spec, plant, {})
    assert html.index("slow diverged at 50 s: Υ grew without bound") < html.index("<figure>")


def test_markup_in_user_text_stays_text(experiment, result, plant):
    """Hostile titles, texts, captions and units add no element, no attribute and no script."""
    hostile_plant = plant.model_validate(
        plant.model_dump()
        | {
            "title": HOSTILE,
            "description": HOSTILE,
            "states": [s.model_dump() | {"description": HOSTILE, "unit": "<b onclick=x()>"} for s in plant.states],
            "channels": [c.model_dump() | {"title": HOSTILE, "unit": "<img src=x>"} for c in plant.channels],
        }
    )
    panel = {"title": HOSTILE, "y_title": HOSTILE, "x_title": HOSTILE, "traces": [{"column": "x.x1", "label": HOSTILE}]}
    clean = experiment()
    spec = experiment(
        title=HOSTILE,
        description=HOSTILE,
        source=HOSTILE,
        errata=[HOSTILE],
        notes=[{"id": "one", "t": 1, "text": HOSTILE}],
        plant=hostile_plant,
        figures=[{"name": "f", "title": HOSTILE, "caption": HOSTILE, "panels": [panel]}],
    )
    page = Page(
        report(result(spec), spec, hostile_plant, {"id": HOSTILE, "command": HOSTILE, "versions": {HOSTILE: HOSTILE}})
    )
    reference = Page(report(result(clean), clean, plant, {}))
    assert page.tags.count("script") == reference.tags.count("script") == 4
    assert set(page.tags) <= set(reference.tags) | {"ul", "li"}
    assert not [a for a in page.attributes if a[1].startswith("on")]
    assert HOSTILE in "".join(page.text)


def test_figures_in_the_page_are_valid_json(html):
    """The embedded figures are parsed, and contain no character that could end their element."""
    text = re.search(r"<script type=application/json id=figures>(.*?)</script>", html, re.DOTALL)[1]
    assert "<" not in text
    assert {"data", "layout"} == set(json.loads(text)[0])


def sections(html: str) -> dict[str, str]:
    """Return the visible text of the page by the heading of its sections."""
    parts = re.split(r"<h2>(.*?)</h2>", html)
    return {
        title: " ".join(" ".join(Page(body).text).split()) for title, body in zip(parts[1::2], parts[2::2], strict=True)
    }


def table_rows(html: str, first: str) -> list[list[str]]:
    """Return the cells, as HTML, of the table with this first heading."""
    for table in re.findall(r"<table>(.*?)</table>", html, re.DOTALL):
        rows = [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in re.findall(r"<tr>(.*?)</tr>", table)]
        if rows[0][0] == first:
            return rows
    raise AssertionError(f"no table begins with {first!r}")


def diagnosed(outcome, **findings: dict):
    """Return the result with findings; each is the schema's example with these fields changed."""
    example = ObserverDiagnosis.model_json_schema()["examples"][0]
    made = [example | {"observer": label} | changes for label, changes in findings.items()]
    data = {"detector": {"observer": "", "note": "it was not asked"}, "observers": made}
    return replace(outcome, diagnosis=Diagnosis.model_validate(data).model_dump(mode="json"))


ALARM = ObserverDiagnosis.model_json_schema()["examples"][0]["alarms"][0]


def test_every_assumption_has_its_line_and_the_verdicts_are_counted(experiment, result, plant):
    """Name, verdict, sentence, source, value and threshold of each check."""
    spec = experiment()
    failed = Check(
        Message("check.matching"), "fails", Message("check.matching.no-p"), 0.5, 1e-9, "Assumption 3, eq. (9)"
    )
    outcome = result(spec)
    outcome = replace(outcome, observers=tuple(replace(o, checks=(*o.checks, failed)) for o in outcome.observers))
    html = report(outcome, spec, plant, {})
    assert sections(html)["Observers and their assumptions"].count("1 holds, 1 fails, 1 undecided") == 2
    lines = table_rows(html, "assumption")
    plain = [[re.sub("<.*?>", "", cell) for cell in line] for line in lines]
    assert plain[1] == [
        "persistent excitation",
        "holds",
        "smallest eigenvalue over the run: 0.0026",
        "eq. (36)",
        "0.0026",
        "0.002",
    ]
    assert plain[2][1:] == ["cannot tell", escape(str(Message("check.chain.broken"))), "assumption 2", "–", "–"]
    assert plain[3][4:] == ["0.5", "1·10−9"]


def test_errors_of_each_window_are_compared_and_the_smaller_is_marked(html):
    """The faster observer has the smaller error of θ1 after its onset at 40 s; before it neither is better."""
    head, *lines = table_rows(html, "error of")
    assert head[2:] == ["0 to 20 s", "20 to 40 s", "40 to 70 s", "70 to 100 s"]
    quick, slow = (line for line in lines if line[0].startswith(symbol("theta1")))
    assert "adaptive" in quick[1] and "slow" in slow[1]
    assert ["class=best" in cell for cell in quick[2:]] == [False, False, True, True]
    assert not any("class=best" in cell for cell in slow[2:])


def test_the_report_compares_the_alarms_of_the_observers(experiment, result, plant):
    """Faults found and missed, false alarms, wrong names and delays, in words at the top of the table."""
    spec = experiment()
    late = ALARM | {"t": 25.0}
    wrong = ALARM | {"t": 30.0, "channel": "theta1", "alternatives": ["theta2"], "cleared": 35.0}
    extra = [ALARM | {"t": 5.0, "cleared": 6.0}, wrong]
    outcome = diagnosed(result(spec), adaptive={}, slow={"alarms": [late, *extra]})
    html = report(outcome, spec, plant, {})
    head, quick, slow = table_rows(html, "observer")
    cells = {h: (re.sub("<.*?>", "", a), re.sub("<.*?>", "", b)) for h, a, b in zip(head, quick, slow, strict=True)}
    assert cells["faults found"] == ("1 of 3", "1 of 3")
    assert cells["faults missed"] == ("2", "2")
    assert cells["alarms without a fault"] == ("0", "1")
    assert cells["alarms naming a wrong fault"] == ("0", "1")
    assert cells["median delay (s)"] == ("0.600", "5.000")
    assert "class=best" in quick[head.index("median delay (s)")] and "class=best" not in "".join(slow[1:6])
    assert [re.sub("<.*?>", "", "|".join(line[1:])) for line in table_rows(html, "fault in")[1:]] == [
        "20|0.600|5.000",
        "40|missed|missed",
        "70|missed|missed",
    ]


def test_the_diagnosis_of_each_observer_is_in_the_report(experiment, result, plant):
    """Sentence, alarm with onset and size, thresholds and their origin, undetectable faults, and noise."""
    spec = experiment()
    noise = [{"output": "y", "declared": 0.001, "estimated": 0.00098}]
    excitation = {
        "window": 10,
        "level": 4.2,
        "needed": 100,
        "direction": {"theta1": 0.71, "theta2": -0.71, "theta3": 0.0},
        "text": "θ1 and θ2 cannot be distinguished.",
        "proposal": "Let u be a square wave of period 4 s.",
    }
    found = {"sentence": "A sensor bias since 20.0 s.", "noise": noise, "excitation": excitation}
    html = report(
        diagnosed(result(spec), adaptive=found, slow={"alarms": [], "note": "It estimates no faults."}), spec, plant, {}
    )
    text = sections(html)["Diagnosis"]
    assert (
        "all states and faults can be determined from the outputs in principle" in text
        and "rank " in text
        and "condition " in text
    )
    for part in (
        "A sensor bias since 20.0 s.",
        "20.6",
        "(19.9 to 20.1)",
        "0.02 1/h (0.0197 to 0.0203)",
        "41, limit 29.5",
        "still on",
        "glr 29.5, residual 33, set for 0.01 false alarms per hour",
        "32 simulated runs",
        "0.8 hours",
        "before 6 s",
        "0.0011",
        "would be needed",
        "0.71",
        "cannot be distinguished",
        "square wave of period 4 s",
        "0.00098",
        "It estimates no faults.",
    ):
        assert part in text, part
    assert html.index("<h2>Diagnosis") < html.index("<figure>")
    assert "<h2>Diagnosis" not in report(result(spec), spec, plant, {})


def test_an_observability_that_takes_too_long_is_left_out(experiment, result, plant):
    """A service computes it in a worker, where it may reach a limit; all else is in the report."""
    run = diagnosed(result(spec := experiment()), adaptive={})
    html = report(run, spec, plant, {}, observed=lambda _: None)
    assert "Not computed: it takes more time or memory than the service allows." in html


def test_markup_in_a_diagnosis_stays_text(experiment, result, plant):
    """Sentences, notes and proposals add no element and no attribute."""
    spec = experiment()
    excitation = {"window": 1, "level": None, "needed": 1, "direction": {}, "text": HOSTILE, "proposal": HOSTILE}
    hostile = {
        "sentence": HOSTILE,
        "note": HOSTILE,
        "excitation": excitation,
        "alarms": [ALARM | {"test": HOSTILE}],
        "noise": [{"output": "<b onclick=x()>", "declared": None, "estimated": None}],
    }
    page = Page(report(diagnosed(result(spec), adaptive=hostile), spec, plant, {}))
    assert page.tags.count("script") == 4 and "img" not in page.tags and "svg" not in page.tags
    assert not [a for a in page.attributes if a[1].startswith("on")]
    assert "".join(page.text).count(HOSTILE) == 5


ENGLISH = re.compile(r"[a-z]{4,} [a-z]{2,}")  # two words in a row: not a symbol, not a name


def test_a_chinese_report_has_no_english_sentence(experiment, result, plant):
    """Headings, tables, legends and notes are in the requested language; users' texts are unchanged."""
    spec = experiment(title="三个故障", source="论文", errata=["有一处符号错误。"])
    noise = [{"output": "y", "declared": 0.001, "estimated": 0.00098}]
    html = report(diagnosed(result(spec, lost={"slow": 50.0}), adaptive={"noise": noise}), spec, plant, {}, "zh")
    assert "<html lang=zh>" in html
    written: list[str] = []
    example = ObserverDiagnosis.model_json_schema()["examples"][0]
    written += [plant.description, *(c.title for c in plant.channels), *sentences_of(example)]
    text = " ".join(part for part in Page(html).text if not part.lstrip().startswith(("{", "thetascope run")))
    for own in sorted(written, key=len, reverse=True):
        text = text.replace(own.replace("-", " "), "").replace(own, "")
    assert ENGLISH.findall(text) == []
    for heading in ("对象", "故障与噪声", "诊断", "比较", "观测器及其假设", "复现"):
        assert f"<h2>{heading}</h2>" in html


def sentences_of(value: object) -> list[str]:
    """Return all texts in plain data."""
    if isinstance(value, str):
        return [value]
    items = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return [text for item in items for text in sentences_of(item)]


def test_the_text_of_a_message_is_escaped_and_its_markup_is_kept(experiment, result, plant):
    """Arguments that are markup stay markup; every other argument is text, whatever it holds."""
    spec = experiment()
    own = ReportContext(FigureData(result(spec), spec, plant, "light", "en"))
    sentence = own.say("report.diverged", label=HOSTILE, t=mark("power", "1", "3"), cause="\x000\x00")
    assert "1·10<sup>3</sup>" in sentence and "<script" not in sentence and "<img" not in sentence
    assert own.say("report.detail", name="<b>", value=Markup("<i>x</i>")) == "&lt;b&gt; <i>x</i>"


def test_notes_and_bookmarks_are_listed_in_order_of_time(experiment, result, plant):
    """With their moments; a note without a text is a bookmark."""
    spec = experiment(notes=[{"id": "b", "t": 4.25, "text": "It settles."}, {"id": "a", "t": 1.5}])
    text = " ".join(Page(report(result(spec), spec, plant, {})).text)
    assert (
        text.index("Notes and bookmarks") < text.index("Bookmark at 1.5 s") < text.index("Note at 4.25 s: It settles.")
    )


def test_no_markup_is_written_in_python():
    """The report's markup is in its templates, which escape; a tag in a string of the code would not be."""
    folder = Path(words.__file__).parent
    assert {path.name for path in folder.glob("templates/*.html")} >= {"report.html", "marks.html"}
    for path in folder.glob("*.py"):
        tags = re.findall(
            r"[\"'][^\"'\n]*</?(?:p|b|i|td|tr|table|span|h\d|div|section|li|ul|code|pre)[ >]", path.read_text()
        )
        assert tags in ([], ['"<i>', '"<i ']), path.name


def test_a_fact_that_is_a_message_is_rendered(experiment, result, plant):
    """An observer's fact {code, args} is a sentence in the report's language, not data."""
    spec = experiment()
    outcome = result(spec)
    fact = Message("observer.matching.different", first="a", second="b")
    observers = tuple(replace(o, facts={"matching": fact.as_data()}) for o in outcome.observers)
    html = report(replace(outcome, observers=observers), spec, plant, {}, "zh")
    assert fact.text("zh") in html and "observer.matching.different" not in html


def test_the_buttons_of_the_figures_are_in_the_reports_language(experiment, result, plant):
    """The report carries the words of Plotly's buttons, by the English ones that the page gives Plotly too."""
    spec = experiment()
    html = report(result(spec), spec, plant, {}, "zh")
    words = json.loads(re.search(r"id=plotly-words>(.*?)</script>", html)[1])
    page = (Path(__file__).parents[2] / "frontend/i18n/plotly-locale.js").read_text(encoding="utf-8")
    assert words["Download plot as a PNG"] == "下载为 PNG 图片"
    assert list(words) and set(words) == set(re.findall(r"^    '?(.+?)'?: t\('page\.plotly", page, re.MULTILINE))


def test_the_controllers_of_a_loop_are_described():
    """Their laws with limits, set points among the inputs, and the initial values of their states."""
    spec = loop_experiment(level(0.5), horizon=5)
    page = Page(report(simulate(spec), spec, spec.plant, {"id": "loop", "created": "2025-01-01", "versions": {}}))
    text = " ".join("".join(page.text).split())
    assert "limited to [0, 2]" in text and "e(0) = 0" in text and "Kp" in text


def test_the_inputs_of_a_loop_are_drawn_with_the_set_points():
    """The figure of inputs has the set point and the applied input."""
    spec = loop_experiment(level(0.5), horizon=5)
    strips = json.dumps(build(FigureData(simulate(spec), spec, spec.plant, "light"), "inputs"), default=str)
    assert "<i>r</i>" in strips and "<i>q</i>" in strips


def test_the_report_says_how_the_truth_was_changed_during_the_run(experiment, result, plant):
    """Times and the differences at the end; back at the model, that it is as the model."""
    said = {}
    for name, last in {"changed": {"parameters": {"a1": 1.1}}, "as the model": {}}.items():
        commands = [
            {"at": 0.1, "command": "set-truth", "truth": {"deviation": 0.02}},
            {"at": 0.2, "command": "set-truth", "truth": last},
        ]
        spec = experiment().model_copy(update={"commands": _COMMANDS.validate_python(commands)})
        page = report(result(experiment()), spec, plant, {"id": "abc123", "created": "2025-01-01", "versions": {}})
        said[name] = " ".join("".join(Page(page).text).split())
    assert "changed 2 times during the run, first at 0.1 s. At the end: a1 = 1.1." in said["changed"]
    assert "At the end: as the model." in said["as the model"]
