"""The diagnosis of closed loops: it knows the applied input, and its analyses are those of the plant alone."""

import numpy as np
import pytest

from tests.engine.loops import experiment, level
from tests.simulate import simulate
from thetascope.assembly.analyses.record_diagnosis import diagnose_columns
from thetascope.assembly.build.prepare import prepare
from thetascope.diagnosis.input_design.input_proposal import propose
from thetascope.diagnosis.residuals.innovation_filter import InnovationFilter
from thetascope.engine.execution.run_experiment import spans_of
from thetascope.engine.observability.empirical_gramian import empirical
from thetascope.engine.observability.opened import opened
from thetascope.engine.simulation.simulation import row_values

NOISE = {"y": {"std": 0.01, "sample_time": 0.1}}
CHANGES = {"noise": NOISE, "seed": 2}


@pytest.mark.parametrize("period", [None, 0.5])
def test_innovations_are_white_in_a_closed_loop(period: float | None):
    """Without faults, the filter's innovations have variance one and no correlation from row to row."""
    engine = prepare(experiment(level(period), horizon=400, **CHANGES)).engine
    filter_ = InnovationFilter(engine, engine.context)
    (_, rows), *_ = spans_of(engine)
    table = filter_.table(rows.index, rows.y, row_values(engine, rows.index, rows.plant, rows.loop), engine.signals)
    nu = filter_.run(filter_.start(), np.zeros(filter_.p), table, rows.index * engine.step).nu[500:, 0]
    assert 0.8 < nu.var() < 1.1
    assert abs(np.corrcoef(nu[1:], nu[:-1])[0, 1]) < 0.1


def test_an_opened_loop_has_the_same_course():
    """The plant alone, with the applied input of a sampled controller, has the states of the closed loop."""
    closed = prepare(experiment(level(0.5), **CHANGES)).engine
    one, two = (spans_of(e)[0][1] for e in (closed, opened(closed)))
    assert opened(closed).loop is None
    np.testing.assert_allclose(one.plant, two.plant, rtol=1e-10)


def test_the_gramian_is_that_of_the_plant_alone():
    """The controller, which answers a change of the state, hides nothing from an observer that knows its input."""
    closed = prepare(experiment(level(0.5), **CHANGES)).engine
    one, two = empirical(closed, 10.0), empirical(opened(closed), 10.0)
    np.testing.assert_allclose(one.singular, two.singular, rtol=1e-9)
    assert (one.rank == 3).any()


def test_a_set_point_is_proposed():
    """At a constant set point, leak and bias cannot be distinguished; a course of the set point helps."""
    spec = experiment(level(0.5), inputs={}, **CHANGES)
    engine = prepare(spec).engine
    filter_ = InnovationFilter(engine, engine.context)
    (state, *_) = [rows for _, rows in spans_of(engine)]
    last = int(state.index[-1])
    proposal = propose(filter_, engine, state.plant[-1], last, 20.0, 0.05, loop=state.loop.states[-1])
    assert proposal.input == "r" and proposal.level > 2 * proposal.before
    swing = [v for k, v in proposal.signal.items() if k in ("low", "high")]
    assert all(0.5 <= v <= 1.5 for v in swing)


def test_a_record_of_a_loop_is_diagnosed_with_the_applied_input():
    """It is diagnosed with the recorded input; without it no fault is named."""
    bias = [{"channel": "bias", "shape": "step", "onset": 30, "size": 0.1}]
    spec = experiment(level(0.5), faults=bias, **CHANGES)
    run = simulate(spec)
    columns = {n: run.column(n) for n in ("t", "u.q", "y.y")}
    found = diagnose_columns(spec.plant, columns)
    assert [f.best.channel for f in found.faults] == ["bias"]
    assert found.faults[0].best.size.value == pytest.approx(0.1, abs=0.02)


def test_a_discrete_plant_has_controllers():
    """They act at every step, or at a multiple of it; the difference equation computed by hand agrees."""
    plant = level(
        time={"kind": "discrete", "period": 0.1},
        dynamics={"h": "0.9*h + 0.1*q"},
        channels=[{"name": "bias", "kind": "sensor", "enters": {"y": 1}}],
        parameters=[],
    )
    for period, every in ((None, 1), (0.3, 3)):
        law = {"name": "i", "period": period, "states": [{"name": "e"}], "dynamics": {"e": "e + r - y"}}
        law["outputs"] = [{"input": "q", "expression": "0.5*e + 1", "saturation": [0, 1.4]}]
        fault = [{"channel": "bias", "shape": "step", "onset": 2, "size": 0.1}]
        data = {"inputs": {"r": {"kind": "constant", "value": 1.2}}, "horizon": 6, "step": 0.1, "evaluate": 0.1}
        run = simulate(experiment(plant | {"controllers": [law]}, faults=fault, **data))
        h, e, q, course = 1.0, 0.0, 0.5, []
        for k in range(61):
            if k % every == 0:
                q, e = min(max(0.5 * e + 1, 0), 1.4), e + 1.2 - (h + (0.1 if k >= 20 else 0.0))
            course.append((h, q))
            h = 0.9 * h + 0.1 * q
        np.testing.assert_allclose(run.column("x.h"), [c[0] for c in course], rtol=1e-12)
        np.testing.assert_allclose(run.column("u.q"), [c[1] for c in course], rtol=1e-12)


def test_hypotheses_use_the_applied_input():
    """A leak while the sensor is sound is named, with its size; the loop has brought y back to the set point."""
    leak = [{"channel": "leak", "shape": "step", "onset": 70, "size": 0.1}]
    inputs = {"r": {"kind": "pulse", "low": 1, "high": 1.3, "period": 20, "width": 10}}
    spec = experiment(level(0.5), faults=leak, inputs=inputs, horizon=120, diagnosis={}, **CHANGES)
    run = prepare(spec).run()
    assert run.diagnosis is not None
    alarms = run.diagnosis["detector"]["alarms"]
    assert [a["channel"] for a in alarms] == ["leak"] and alarms[0]["size"] == pytest.approx(0.1, abs=0.02)
    assert run.column("y.y")[-20:].mean() == pytest.approx(1.0, abs=0.02)
