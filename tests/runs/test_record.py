"""The spacing of a result's rows, `record`, changes no check, finding, band or estimate."""

from functools import cache

import numpy as np
import pytest

from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.model.result import Result
from thetascope.live.session.session import Session
from thetascope_schemas import Experiment, ResolvedExperiment

HORIZONS = {"zhao-2012": 8, "dc-motor": 3, "quadruple-tank": 300, "loop-sensor": 100, "friction-motor": 5}
HELD = (".sigma.", ".excitation")

DISCRETE = {
    "plant": {
        "id": "rotation",
        "time": {"kind": "discrete", "period": 0.1},
        "states": [{"name": "x1", "initial": 1}, {"name": "x2"}],
        "inputs": [{"name": "u", "default": 1}],
        "outputs": [{"name": "y", "expression": "x1"}],
        "dynamics": {"x1": "0.9*x1 + 0.2*x2", "x2": "-0.2*x1 + 0.9*x2 + 0.1*u"},
        "channels": [{"name": "loss", "kind": "actuator", "enters": {"x2": "0.1*u"}, "typical": 0.3}],
    },
    "inputs": {"u": {"kind": "sine", "amplitude": 1, "offset": 1, "frequency": 0.3}},
    "noise": {"y": {"std": 0.01, "sample_time": 0.1}},
    "faults": [{"channel": "loss", "shape": "step", "onset": 30, "size": -0.4}],
    "observers": [{"label": "kalman", "kind": "adaptive-kalman-discrete"}],
    "horizon": 60,
    "step": 0.1,
    "evaluate": 1,
}
STIFF = {  # substeps change along the run, an observer comes and goes between the rows
    "plant": {
        "id": "oscillator",
        "states": [{"name": "x1", "initial": 2}, {"name": "x2"}],
        "inputs": [{"name": "u", "default": 0}],
        "outputs": [{"name": "y", "expression": "x1"}],
        "dynamics": {"x1": "x2", "x2": "30*(1 - x1^2)*x2 - x1 + u"},
        "channels": [{"name": "push", "kind": "actuator", "enters": {"x2": "1"}, "typical": 0.3}],
    },
    "inputs": {"u": {"kind": "pulse", "period": 7.3, "width": 3.1, "low": 0, "high": 0.5}},
    "noise": {"y": {"std": 0.01, "sample_time": 0.01}},
    "observers": [{"label": "first", "kind": "joint-ekf"}],
    "commands": [
        {"command": "add-observer", "at": 5.03, "observer": {"label": "second", "kind": "joint-ekf"}},
        {"command": "remove-observer", "at": 20.07, "label": "second"},
    ],
    "horizon": 40,
    "step": 0.01,
    "evaluate": 0.1,
    "diagnosis": {"enabled": False},
}
CASES = {"discrete": DISCRETE, "stiff": STIFF}


@cache
def spec(name: str) -> ResolvedExperiment:
    """Return an experiment, short, with at most three observers."""
    if name in CASES:
        return library.resolve(Experiment.model_validate(CASES[name]))
    given = library.experiment(name)
    short = {"horizon": HORIZONS[name], "figures": (), "record": None, "observers": given.observers[:3]}
    return library.resolve(given.model_copy(update=short))


@cache
def examined(name: str) -> Result:
    """Return the run of an experiment with the rows at which it is examined."""
    return prepare(spec(name)).run()


def checks(result: Result) -> list[tuple]:
    """Return name, verdict, value and sentence of all checks of all observers."""
    return [(o.label, c.name, c.verdict, c.value, c.text) for o in result.observers for c in o.checks]


@pytest.mark.parametrize("name", [*HORIZONS, *CASES])
@pytest.mark.parametrize("ratio", [5, 25, 0.2, 1.5, 0.7])
def test_no_number_depends_on_the_spacing_of_rows(name: str, ratio: float):
    """Checks, diagnosis and accuracy are those of the examined rows, and so are all columns at common rows, to the bit;
    between examined rows plant and estimates are finite, and bands hold their last value."""
    given, reference = spec(name), examined(name)
    every = given.evaluate_every
    record = max(1, round(ratio * every))
    result = prepare(given.model_copy(update={"record": record * given.step})).run()
    assert checks(result) == checks(reference)
    assert result.diagnosis == reference.diagnosis
    assert (result.accuracy, result.names) == (reference.accuracy, reference.names)
    index = np.arange(0, round(given.horizon / given.step) + 1, record)
    assert result.data.shape[1] == len(index)
    common = index % every == 0
    np.testing.assert_array_equal(result.data[:, common], reference.data[:, index[common] // every])
    np.testing.assert_allclose(result.column("t"), index * given.step, rtol=0, atol=1e-9)
    held = [n for n in result.names if any(part in n for part in HELD)]
    for column in held:
        known = np.isfinite(result.column(column))
        assert np.array_equal(result.column(column)[known], reference.column(column)[index // every][known])
    exact = [n for n in result.names if n.startswith("x.") or (".theta." in n and "second" not in n)]
    assert exact and all(np.isfinite(result.column(n)).all() for n in exact)


def test_states_between_examined_rows_are_those_of_a_run_that_is_examined_there():
    """With the same substeps, as a linear plant and its observer need none."""
    given = spec("quadruple-tank").model_copy(update={"substeps": 1})
    fine = {"record": given.step * 2, "diagnosis": given.diagnosis.model_copy(update={"enabled": False})}
    between = prepare(given.model_copy(update=fine)).run()
    there = prepare(given.model_copy(update=fine | {"evaluate": given.step * 2})).run()
    names = [n for n in between.names if n.startswith(("x.", "y.", "u.", "theta.")) or ".theta." in n or ".x." in n]
    for name in names:
        np.testing.assert_array_equal(between.column(name), there.column(name), err_msg=name)


@pytest.mark.parametrize("ratio", [5, 0.2])
def test_a_session_shows_the_examined_rows_whatever_is_recorded(ratio: float):
    """Its rows, alarms and the run that is saved from it are those of the experiment without `record`."""
    given = spec("dc-motor")
    record = round(ratio * given.evaluate_every) * given.step
    session = Session(given.model_copy(update={"record": record}))
    rows, data = 0, []
    while rows < 400:
        data.append(session.advance(400 - rows))
        rows += data[-1].shape[1]
    columns = np.concatenate(data, axis=1)
    run = examined("dc-motor")
    for name, column in zip(session.columns, columns, strict=True):
        np.testing.assert_array_equal(column, run.column(name)[:400], err_msg=name)
    assert session.record == given.evaluate_interval
    saved = session.spec.model_copy(update={"horizon": 399 * session.record})
    assert prepare(saved).run().data.shape[1] == 400
