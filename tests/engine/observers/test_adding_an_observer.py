"""ARCHITECTURE.md, "Adding an observer": its file, registered, runs, is documented in words, and equals plain NumPy."""

import re
import sys
from collections.abc import Iterator
from importlib.util import module_from_spec, spec_from_file_location
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from babel.messages.pofile import read_po

from tests.simulate import simulate
from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.analyses.gains import present_gains
from thetascope.assembly.analyses.observer_catalogue import observer_kinds
from thetascope.engine.errors import SpecError
from thetascope.engine.observers import registry
from thetascope.engine.observers.support.declaration import Observer, counted_by
from thetascope.messages.catalogue import catalogue, languages
from thetascope_schemas import Experiment, ResolvedExperiment
from tools import document_observers
from tools.document_observers import WORDS

ROOT = Path(__file__).parents[3]
NAME = "thetascope.engine.observers.papers.luenberger"

PLANT = {
    "id": "two-tanks",
    "states": [{"name": "h1", "initial": 1.0}, {"name": "h2", "initial": 0.5}],
    "inputs": [{"name": "q", "default": 0.4}],
    "parameters": [{"name": "a", "value": 0.8}],
    "outputs": [{"name": "y1", "expression": "h1"}, {"name": "y2", "expression": "h2"}],
    "dynamics": {"h1": "q - a*(h1 - h2)", "h2": "a*(h1 - h2) - 0.5*h2"},
    "channels": [{"name": "bias", "kind": "sensor", "enters": {"y2": "1"}}],
}
GAIN = [[0.6, 0.1], [0.2, 0.9]]


@pytest.fixture
def luenberger(tmp_path, monkeypatch):
    """Return the file of ARCHITECTURE.md as a module of the package, registered, with its entries in the catalogues."""
    section = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8").split("### Adding an observer")[1]
    for language, entries in zip(("en", "zh"), re.findall(r"```po\n(.*?)```", section, flags=re.DOTALL), strict=True):
        for entry in read_po(StringIO(entries)):
            if entry.id:
                monkeypatch.setitem(catalogue(language).templates, entry.id, entry.string)
    code = re.findall(r"```python\n(.*?)```", section, flags=re.DOTALL)[0]
    file = tmp_path / "luenberger.py"
    file.write_text(code, encoding="utf-8")
    location = spec_from_file_location(NAME, file)
    module = module_from_spec(location)
    monkeypatch.setitem(sys.modules, NAME, module)
    location.loader.exec_module(module)
    monkeypatch.setitem(registry._MODULES, "luenberger", "papers.luenberger")
    registry.observer.cache_clear()
    yield registry.observer("luenberger")
    registry.observer.cache_clear()


def spec(gains=None, **changes) -> ResolvedExperiment:
    observer = {"label": "o", "kind": "luenberger", "gains": {"L": GAIN} if gains is None else gains}
    data = {"plant": PLANT, "horizon": 5.0, "step": 0.01, "observers": [observer], "faults": []}
    return library.resolve(Experiment.model_validate(data | changes))


def test_it_equals_plain_numpy(luenberger):
    """x̂ and θ̂ equal an RK4 integration of the equations with a constant sensor bias of 0.2."""
    run = simulate(spec(faults=[{"channel": "bias", "shape": "step", "size": 0.2, "onset": 0.0}]))
    A, L, psi = np.array([[-0.8, 0.8], [0.8, -1.3]]), np.array(GAIN), np.array([0.0, 1.0])
    b = np.array([0.4, 0.0])

    def rate(z: np.ndarray) -> np.ndarray:
        x, estimate, theta = z[:2], z[2:4], z[4]
        r = x + psi * 0.2 - estimate - psi * theta
        return np.concatenate([A @ x + b, A @ estimate + b + L @ r, [psi @ r]])

    z, rows = np.array([1.0, 0.5, 1.0, 0.5, 0.0]), []
    for _ in range(len(run.column("t"))):
        rows.append(z)
        k1 = rate(z)
        k2 = rate(z + 0.005 * k1)
        k3 = rate(z + 0.005 * k2)
        z = z + 0.01 / 6 * (k1 + 2 * k2 + 2 * k3 + rate(z + 0.01 * k3))
    columns = [run.column(name) for name in ("o.x.h1", "o.x.h2", "o.theta.bias")]
    assert np.stack(columns, axis=1) == pytest.approx(np.array(rows)[:, 2:], abs=1e-12)
    assert [c.verdict for c in run.observers[0].checks] == ["holds"]


def messages_of(kind: Observer) -> Iterator[str]:
    """Yield the codes of everything that an observer shows to users."""
    yield from (kind.title.code, kind.summary.code, kind.when.code)
    yield from (item.meaning.code for item in (*kind.gains, *kind.options))
    yield from (counted_by(size).code for gain in kind.gains for size in (gain.size, gain.columns) if callable(size))
    yield from (meaning.code for _, meaning in kind.where)


@pytest.mark.parametrize("language", languages())
def test_its_words_are_in_every_language(luenberger, language):
    """The recipe's entries cover all texts in the observer's forms and lists."""
    assert [code for code in messages_of(luenberger) if code not in catalogue(language).templates] == []


@pytest.mark.parametrize("language", languages())
@pytest.mark.parametrize("kind", registry.kinds())
def test_every_registered_observer_has_words_in_every_language(kind, language):
    """An observer whose title, summary, gain, option or symbol lacks an entry is found."""
    codes = list(messages_of(registry.observer(kind)))
    assert [code for code in codes if code not in catalogue(language).templates] == []


def test_it_is_documented(luenberger):
    """The page has its section and the README's count increases, with nothing else to write."""
    section = document_observers.section(luenberger)
    assert "Luenberger, IEEE TAC" in section and "A − LC stable" in section
    assert "a matrix, one row per state and one column per output" in section
    assert document_observers.counted("Twelve observers").startswith(f"{WORDS[len(registry.kinds())].capitalize()} ")


def test_the_catalogue_and_the_form_contain_it(luenberger):
    """The catalogue states its shape; POST /api/gains returns its numbers with labelled rows and columns."""
    entry = next(kind for kind in observer_kinds() if kind["id"] == "luenberger")
    assert [(g["name"], g["size"], g["columns"]) for g in entry["gains"]] == [("L", "n", "m"), ("kappa", None, None)]
    gains, labels = present_gains(spec({"kappa": 2}))
    assert gains["o"] == {"L": [[0.5, 0.5], [0.5, 0.5]], "kappa": 2.0}
    assert labels["o"] == {"L": {"rows": ["h1", "h2"], "columns": ["y1", "y2"]}}


@pytest.mark.parametrize(
    ("gain", "says"),
    [
        ([[1, 2]], "it has 1 entries; this plant needs 2: h1, h2"),
        ([[1, 2], [3]], "row h2 has 1 entries; it needs 2"),
        ([1, 2], "row h1 has 1 entries; it needs 2"),
        ([[1, 2], [3, 1e9]], "must lie between"),
    ],
)
def test_a_gain_of_another_shape_is_refused_with_the_labels_of_its_rows(luenberger, gain, says):
    """The error names the rows that the plant requires."""
    with pytest.raises(SpecError, match=re.escape(says)):
        prepare(spec({"L": gain}))


def test_a_column_may_be_given_as_rows():
    """[[1], [2]] is the column [1, 2]; a longer row is refused by its name."""
    observer = {"label": "o", "kind": "adaptive-kalman", "gains": {"q": [[1], [2]]}}
    assert present_gains(spec(observers=[observer]))[0]["o"]["q"] == [1.0, 2.0]
    with pytest.raises(SpecError, match="row h2 has 2 entries; it needs 1"):
        present_gains(spec(observers=[observer | {"gains": {"q": [[1], [2, 3]]}}]))


def test_rows_of_the_papers_gains_have_names():
    """H has a row for each unmeasured coordinate, K of a sandwich observer one for each state of L1 and L2."""
    for experiment, label, gain, rows in (
        ("reduced-order-mimo", "reduced", "H", ["L y1", "L y2"]),
        ("zhou-tan-2012", "nonsmooth", "K", ["x11", "x12", "x21", "x22"]),
    ):
        assert present_gains(library.resolve(library.experiment(experiment)))[1][label][gain]["rows"] == rows
