"""The pages of the papers: figures and runs that exist, numbers that are measured as they are stated, mathematics."""

import re
from functools import cache
from xml.etree import ElementTree

import numpy as np
import pytest

from tests.simulate import simulate
from thetascope import figures, library
from thetascope.assembly.paper_page import paper_page
from thetascope.engine.model.result import Result
from thetascope.engine.observers.registry import kinds
from thetascope.runs.results.measures import Readings, columns_read, value_of
from thetascope_schemas.service.learning.measures import Decays, Level, Rises, Settles
from thetascope_schemas.service.learning.paper import Paper, PaperNumber
from thetascope_schemas.service.learning.questions import Words
from tools.document_papers import FILE, page

PAPERS = list(library.papers())
PAGE = (library.Path(library.__file__).parents[3] / "frontend/widgets/equations.js").read_text()
ALLOWED = set(re.findall(r"'(m\w+)'", PAGE.split("ALLOWED")[1].split("]")[0]))


def numbers(paper: Paper) -> list[PaperNumber]:
    """Return the numbers of the table and those of the evidence."""
    return [*paper.numbers, *(one for erratum in paper.errata if erratum.evidence for one in erratum.evidence.numbers)]


@cache
def result(experiment: str) -> Result:
    """Return a run; several numbers are measured in it."""
    return simulate(library.resolve(library.experiment(experiment)))


@pytest.mark.parametrize("id", PAPERS)
def test_every_number_is_that_of_the_independent_computation(id):
    """Each number of the table and of the evidence is measured in its run, within the stated distance."""
    for one in numbers(library.papers()[id]):
        run = result(one.experiment)
        assert set(columns_read(one.measure)) <= set(run.names), one.what.en
        diverged = {
            observer.label: observer.diverged.time for observer in run.observers if observer.diverged is not None
        }
        value = value_of(one.measure, Readings(run.column("t"), run.column, 0.0, diverged=diverged))
        assert value is not None and value == pytest.approx(one.expected, abs=one.within), one.what.en


@pytest.mark.parametrize("id", PAPERS)
def test_every_figure_and_every_piece_of_evidence_exists(id):
    """Experiments are in the library, and their runs have the figures."""
    paper = library.papers()[id]
    shown = [(one.experiment, one.figure) for one in paper.figures]
    shown += [(one.evidence.experiment, one.evidence.figure) for one in paper.errata if one.evidence]
    for experiment, figure in shown:
        spec = library.experiment(experiment)
        names = [entry["name"] for entry in figures.figure_names(spec, result(experiment).names, "en")]
        assert figure in names, (experiment, figure)


@pytest.mark.parametrize("id", PAPERS)
def test_every_equation_is_mathematics_that_the_page_shows(id):
    """TeX becomes MathML of elements that the page takes over, without a command that was not understood."""
    shown = paper_page(id)
    assert len(shown.equations) == len(shown.paper.equations)
    for text, equation in zip(shown.equations, shown.paper.equations, strict=True):
        tree = ElementTree.fromstring(text)
        names = {element.tag.split("}")[1] for element in tree.iter()}
        assert names <= ALLOWED, (equation.tex, names - ALLOWED)
        assert "\\" not in "".join(tree.itertext()), equation.tex


def words(item: object) -> list[Words]:
    """Return every text of an item."""
    if isinstance(item, Words):
        return [item]
    if isinstance(item, tuple):
        return [text for part in item for text in words(part)]
    if hasattr(type(item), "model_fields"):
        return [text for name in type(item).model_fields for text in words(getattr(item, name))]
    return []


@pytest.mark.parametrize("id", PAPERS)
def test_every_text_of_a_paper_has_both_languages(id):
    """English without Chinese characters, Chinese with them; numbers alone need no translation."""
    for text in words(library.papers()[id]):
        assert text.en and not re.search("[\u3400-\u9fff]", text.en), text
        if re.search("[A-Za-z]{4}", text.en):
            assert text.zh and text.zh != text.en or not re.search("[a-z]{4}", text.en), text


def test_the_experiments_of_a_paper_have_its_errata():
    """They stand once, with the paper: experiments, reports and docs/errata.md take them from there."""
    for name, spec in library.experiments().items():
        paper = next((p for p in PAPERS if name == p or name.startswith(f"{p}-")), None)
        assert len(spec.errata) == (len(library.papers()[paper].errata) if paper else 0)
    assert FILE.read_text(encoding="utf-8") == page(), "run `python -m tools.document_papers`"


def test_rates_shares_and_windows_are_measured_as_defined():
    """A decay of 2 1/s, a sine that rises half the time, a root mean square, and a window that ends before a kick."""
    t = np.linspace(0, 10, 1001)
    columns = {"t": t, "decay": -3 * np.exp(-2 * t), "sine": np.sin(2 * np.pi * t), "kick": np.where(t > 8, 5.0, 0.0)}
    readings = Readings(t, columns.__getitem__, 0.0)
    assert value_of(Decays(column="decay", start=1, end=4), readings) == pytest.approx(2)
    assert value_of(Decays(column="kick"), readings) is None
    assert value_of(Rises(column="sine"), readings) == pytest.approx(0.5, abs=0.01)
    assert value_of(Level(take="rms", column="sine"), readings) == pytest.approx(np.sqrt(0.5), abs=1e-3)
    assert value_of(Settles(column="kick", to=0, within=1), readings) is None
    assert value_of(Settles(column="kick", to=0, within=1, end=8), readings) == 0


def test_the_table_of_statements_names_checks_and_experiments_that_exist():
    """docs/papers.md: what it calls a check is one of a run, and each experiment, plant, observer and figure exists."""
    table = (FILE.parent / "papers.md").read_text(encoding="utf-8")
    runs = ("zhao-2012-noise-free", "shen-hu-2015-noise-free", "reduced-order-mimo", "zhou-tan-2012")
    checks = {check.name.text("en") for run in runs for one in result(run).observers for check in one.checks}
    rows = [row for row in table.splitlines() if row.startswith("|") and "heck" in row]
    named = [name for row in rows for name in re.findall(r"\*([^*]+)\*", row)]
    assert len(named) > 15 and set(named) <= checks, set(named) - checks
    known = {*library.experiments(), *library.plants(), *kinds()}
    known |= {figure.name for spec in library.experiments().values() for figure in spec.figures}
    for name in re.findall(r"`([a-z]+(?:-[a-z0-9]+)+)`", table):
        assert name in known, name
