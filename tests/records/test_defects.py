"""What is listed, and what is not: each defect on records that have it and on healthy ones of all plants."""

import numpy as np
import pytest

from tests.records.tank import FACTS, ROWS, Q, T, Y, changed, inspected, kinds, rows, text
from tests.simulate import simulate
from thetascope import library
from thetascope.assembly.analyses.record_inspection import inspect_file, inspected_table, plant_facts
from thetascope.messages import Message
from thetascope.records.defects.readings import resolution_of
from thetascope.records.defects.sentinels import sentinels
from thetascope.records.table import Table, number_column
from thetascope_schemas import Experiment

NOISE = np.random.default_rng(11).standard_normal(5000)


@pytest.mark.parametrize("step", [0.32, 0.05, 1.0, 0.3223, 7e-4])
def test_the_step_of_a_quantised_sensor_is_found(step):
    """Also where readings are printed with fewer digits; units change it by their factor."""
    for scatter in (0.1, 0.5, 2.0):
        values = step * np.rint((20 + 30 * step * np.sin(np.arange(5000) / 300) + scatter * step * NOISE) / step)
        assert resolution_of(values) == pytest.approx(step, rel=1e-6)
        assert resolution_of(np.round(values, 4 if step > 1e-3 else 6)) == pytest.approx(step, rel=0.01)
        assert resolution_of(100 * values) == pytest.approx(100 * step, rel=1e-6)


@pytest.mark.parametrize("digits", [2, 3, 4, 6])
def test_printed_digits_are_no_quantisation(digits):
    """Noise of 0.05 printed with two to six decimals counts as it is."""
    assert resolution_of(np.round(20 + 0.05 * NOISE, digits)) == 0.0


def test_a_step_is_no_resolution_if_readings_are_continuous():
    """A record with few different values, such as a constant with a step, has no resolution that counts."""
    assert resolution_of(np.full(100, 3.0)) == 0.0 and resolution_of(20 + NOISE) == 0.0


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("offset", [0.0, 100.0, -1000.0])
def test_healthy_readings_hold_no_sentinels(scale, offset):
    """Whatever the range of a sensor, none of its readings counts as a mark."""
    assert not sentinels(np.round(scale * NOISE + offset)).any()
    assert not sentinels(np.round(scale * np.cumsum(NOISE) + offset, 1)).any()


def test_levels_of_an_input_within_its_bounds_are_no_sentinels():
    """99 is a value of a valve that is otherwise at 20 or 25 of 100, and a mark where 30 is the most."""
    cells = np.repeat([20.0, 25.0, 99.0, 20.0], 50)
    assert not sentinels(cells, 0.0, 100.0).any()
    assert np.array_equal(sentinels(cells, 0.0, 30.0), cells == 99) and np.array_equal(sentinels(cells), cells == 99)


def test_defects_of_readings_are_found_and_left_as_they_are():
    """Frozen, saturated and spiky readings are named with their times, and stay in the recording."""
    y = 20 + 2 * np.sin(T / 20) + 0.05 * NOISE[:ROWS]
    stuck, clipped, spiky = y.copy(), np.minimum(y, 21.0), y.copy()
    stuck[200:260], spiky[[50, 300]] = y[200], 35.0
    for values, kind, first in ((stuck, "frozen", 200), (clipped, "saturated", None), (spiky, "spikes", 50)):
        found = inspected(text([[t, q, f"{v:.4f}"] for (t, q, _), v in zip(rows(), values, strict=True)]))
        (finding,) = [f for f in found.findings if f.kind == kind]
        assert kinds(found) == {kind} and finding.quantity == "y" and (first is None or finding.times[0] == first)
        assert found.recording.y[:, 0] == pytest.approx(np.round(values, 4), abs=1e-12)


def test_inputs_outside_of_their_bounds_are_doubtful():
    """The share of rows is given; a unit in which they would be within is proposed."""
    found = inspected(text(changed(range(ROWS), 1, 500)))
    (finding,) = [f for f in found.findings if f.kind == "out-of-bounds"]
    assert finding.severity == "doubtful" and finding.text.args["share"] == 1.0 and finding.proposal is None
    small = inspected(text([[t, q * 60, y] for t, q, y in rows()]))
    (finding,) = [f for f in small.findings if f.kind == "out-of-bounds"]
    assert finding.proposal == {"quantities": {"q": {"column": "q", "unit": "mL/min"}}}
    few = inspected(text(changed((7, 8), 1, 200)))
    assert [f.lines for f in few.findings if f.kind == "out-of-bounds"] == [(9, 10)]


@pytest.mark.parametrize(
    ("head", "cell", "proposal"),
    [
        ("t,q,y", lambda t, q, y: (t, q, y / 100), {"quantities": {"y": {"column": "y", "unit": "m"}}}),
        ("t,q,y", lambda t, q, y: (t, q * 0.06, y), {"quantities": {"q": {"column": "q", "unit": "L/min"}}}),
        ("t,q,y", lambda t, q, y: (t, q, y * 10), {"quantities": {"y": {"column": "y", "unit": "mm"}}}),
        ("t,q,y", lambda t, q, y: (t / 60, q, y), {"time": {"column": "t", "unit": "min"}}),
        ("t,q,y", lambda t, q, y: (t * 1000, q, y), {"time": {"column": "t", "unit": "ms"}}),
        ("t,q,y", lambda t, q, y: (t / 3600, q, y), {"time": {"column": "t", "unit": "h"}}),
    ],
)
def test_a_unit_that_does_not_suit_the_plant_is_doubtful(head, cell, proposal):
    """Another one is proposed, not taken; with it nothing is found."""
    data = text([cell(*row) for row in rows()], head)
    found = inspected(data)
    assert [(f.severity, f.proposal) for f in found.findings if f.proposal] == [("doubtful", proposal)]
    assert kinds(inspected(data, mapping=proposal)) == set()


@pytest.mark.parametrize("head", ["t [s],q,y [cm]", "t,q [cm3/s],y"])
def test_a_written_unit_is_believed(head):
    """It may not suit the plant, but nothing was guessed."""
    found = inspected(text([[t, q, y * 2.5] for t, q, y in rows()], head))
    assert all(f.kind != "unit" for f in found.findings)


def test_a_written_unit_of_another_kind_is_doubtful():
    """A column with the output's name and the unit of another kind is read as it is, and marked."""
    for unit in ("°C", "counts"):
        found = inspected(text(rows()).replace("\n", f"\ns,cm3/s,{unit}\n", 1))
        (finding,) = [f for f in found.findings if f.quantity == "y"]
        assert finding.kind == "unit" and finding.severity == "doubtful" and unit in str(finding.text)
        assert [t.certain for t in found.mapping.taken] == [True, False] and np.array_equal(found.recording.y[:, 0], Y)


def test_an_output_that_never_moves_is_doubtful():
    """An input that never moves is only noted."""
    found = inspected(text([[t, 50, 20] for t, *_ in rows()]))
    assert [(f.quantity, f.severity) for f in found.findings if f.kind == "never-moves"] == [
        ("q", "note"),
        ("y", "doubtful"),
    ]


LIBRARY = ["dc-motor", "quadruple-tank", "dts200", "contois-physical", "friction-motor"]


@pytest.mark.parametrize("name", LIBRARY)
def test_a_healthy_record_of_a_plant_of_the_library_is_clean(name):
    """Nothing is wrong, changed or doubtful in simulated measurements, and every quantity has its column."""
    spec = library.experiment(name)
    changes = {"faults": (), "observers": [], "figures": [], "diagnosis": {"enabled": False}}
    run = simulate(library.resolve(Experiment.model_validate(spec.model_dump() | changes)))
    names = [c for c in run.names if c == "t" or c.startswith(("u.", "signal.", "y."))]
    columns = tuple(number_column(n, np.round(run.column(n), 6)) for n in names)
    table = Table(columns, np.arange(len(run.column("t"))), "csv", Message("record.dialect.json"))
    found = inspected_table(table, library.plant(spec.plant))
    assert [str(f.text) for f in found.findings if f.severity != "note"] == [] and found.problem is None
    assert all(t.column is not None and t.certain for t in found.mapping.taken)


def test_time_constants_are_those_of_the_jacobian():
    """The leaky tank's is 2h/q at rest, a motor's as its eigenvalue says; the level is that at the beginning."""
    facts = plant_facts(library.plant("level-loop"))
    assert facts.slowest == pytest.approx(192.5, rel=1e-6) and facts.outputs["y"] == 25
    assert FACTS.slowest == pytest.approx(plant_facts_of_the_tank(), rel=0.01)


def plant_facts_of_the_tank() -> float:
    """Return A/(∂out/∂h) = 2 A h / out, by hand: A = 154 cm², s = 0.25 cm², h = 20 cm."""
    return 2 * 154 * 20 / (0.25 * np.sqrt(2 * 981 * 20))


def test_an_inspection_lists_what_was_looked_for():
    """Every kind is either found or among those that were checked; the document is complete JSON."""
    data = text(changed(range(100, 120), 2, -9999)).encode()
    document = inspect_file("rig.csv", data, library.plant("level-loop"))
    assert document.problem is not None and document.problem.code == "record.problem.no-output"
    from tests.records.tank import plant

    whole = inspect_file("rig.csv", data, plant())
    codes = {entry.code.rpartition(".")[2] for entry in whole.checked}
    assert "sentinel" not in codes and {"gap", "jitter", "frozen", "unit", "time-unit"} <= codes
    assert type(whole).model_validate_json(whole.model_dump_json()) == whole
    assert np.array_equal(Q, np.where(T // 60 % 2 == 0, 50, 65)) and len(Y) == ROWS
