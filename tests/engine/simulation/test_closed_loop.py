"""Closed loops: controllers read measured outputs, with the faults of the sensors, and observers know the applied u."""

import numpy as np
import pytest

from tests.engine.loops import experiment, level
from tests.reference.closed_loop import Case, solve
from thetascope.assembly.build.prepare import prepare
from thetascope.engine.inputs import random_streams
from thetascope.engine.inputs.sensors import noise_key
from thetascope.engine.simulation.experiment import Experiment
from thetascope.engine.simulation.loop import LoopRows
from thetascope.engine.simulation.simulation import Simulation

FAULTS = {
    "none": None,
    "stuck": {"shape": "stuck", "onset": 11.0, "end": 13.0, "value": 1.2},
    "freeze": {"shape": "freeze", "onset": 10.633, "end": 13.0},
    "freeze from the start": {"shape": "freeze", "onset": 0.0, "end": 3.0},
    "delay": {"shape": "delay", "onset": 8.0, "delay": 0.7},
    "delay of less than a step": {"shape": "delay", "onset": 10.5, "end": 11.5, "delay": 0.004},
    "dropout": {"shape": "dropout", "onset": 5.0, "probability": 0.4, "sample_time": 0.5},
}
END, ROWS = 18.0, 180


def rows_of(engine: Experiment, substeps: int = 1, chunk: int | None = None) -> tuple[np.ndarray, ...]:
    """Return level, reading, applied input and integral at all rows; ``chunk``: base steps of a call."""
    simulation, parts, left = Simulation(engine, substeps, remember=True), [], engine.steps + 1
    state = simulation.initial()
    while left:
        count = min(left, chunk or left)
        state, rows = simulation.advance(state, count)
        parts.append(rows)
        left -= count
    loop = LoopRows.concatenated([r.loop for r in parts if r.loop is not None])
    plant, y = np.concatenate([r.plant for r in parts]), np.concatenate([r.y for r in parts])
    place = engine.loop.states.index("c.e") if engine.loop is not None else 0
    return plant[:, 0], y[:, 0], loop.u[:, 0], loop.states[:, place]


def case_of(spec_fault: dict | None, period: float | None, sampling: float | None, noise: float) -> tuple:
    """Return the experiment and the independent case of one fault."""
    changes: dict = {
        "faults": [{"channel": "bias", "shape": "step", "onset": 12, "size": 0.2}],
        "seed": 3,
        "horizon": END,
    }
    changes["inputs"] = {"r": {"kind": "steps", "times": [10], "values": [1, 1.3]}}
    if spec_fault:
        changes["faults"].append({"output": "y", **spec_fault})
    if noise:
        changes["noise"] = {"y": {"std": noise, "sample_time": 0.5}}
    if sampling:
        changes["measurement"] = {"mode": "sampled", "period": sampling}
    spec = experiment(level(period), **changes)
    case = Case(period, sampling, spec_fault, bias=(12.0, 0.2))
    if noise:
        case.draws = noise * random_streams.normal(noise_key(3, 0), 0, 200)
    if spec_fault and spec_fault["shape"] == "dropout":
        fault = next(f for f in prepare(spec).engine.measurement.faults)
        key = (3, 5, random_streams.key_of(fault))
        case.lost = random_streams.uniform(key, 0, 200) < spec_fault["probability"]
    return spec, case


def set_point(t: float) -> float:
    """Return the set point of the experiments."""
    return 1.3 if t > 10 else 1.0


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize(("period", "sampling"), [(None, None), (0.25, None), (0.5, 0.1)])
def test_agrees_with_scipy(fault: str, period: float | None, sampling: float | None):
    """Level, reading, applied input and integral are those of solve_ivp from one discontinuity to the next."""
    spec, case = case_of(FAULTS[fault], period, sampling, 0.01)
    times = np.arange(ROWS) * 0.1
    expected = solve(case, set_point, times, END)
    level_, y, q, e = (c[:ROWS] for c in rows_of(prepare(spec).engine, 4))
    tolerance = 5e-6 if "delay" in fault else 5e-7  # a delay interpolates within a step
    np.testing.assert_allclose(level_, expected.h, atol=tolerance)
    np.testing.assert_allclose(y, expected.y, atol=tolerance)
    np.testing.assert_allclose(q, expected.q, atol=10 * tolerance)
    if period is None:  # at an instant, a row holds the integral before it
        np.testing.assert_allclose(e, expected.e, atol=tolerance)


def test_quantised_readings_reach_the_plant():
    """A sampled controller computes with the quantised reading."""
    fault = {"shape": "quantisation", "onset": 5.0, "resolution": 0.05}
    spec, case = case_of(fault, 0.5, None, 0.0)
    times = np.arange(ROWS) * 0.1
    expected = solve(case, set_point, times, END)
    level_, y, q, _ = (c[:ROWS] for c in rows_of(prepare(spec).engine))
    np.testing.assert_allclose(level_, expected.h, atol=2e-5)
    np.testing.assert_allclose(q, expected.q, atol=2e-4)
    assert len(np.unique(y[50:].round(9))) < 20


@pytest.mark.parametrize("period", [None, 0.25])
def test_a_bias_moves_the_true_level(period: float | None):
    """With a bias of 0.2, the reading returns to the set point 1.15 and the true level settles at 0.95."""
    bias = {"channel": "bias", "shape": "step", "onset": 20, "size": 0.2}
    spec = experiment(level(period), inputs={"r": {"kind": "constant", "value": 1.15}}, faults=[bias], horizon=100)
    level_, y, _, _ = rows_of(prepare(spec).engine)
    assert level_[-1] == pytest.approx(0.95, abs=1e-4)
    assert y[-1] == pytest.approx(1.15, abs=1e-4)


@pytest.mark.parametrize("fault", FAULTS)
@pytest.mark.parametrize(("period", "sampling"), [(None, None), (0.25, 0.1)])
def test_blocks_change_no_bit(fault: str, period: float | None, sampling: float | None):
    """However a run is divided into calls, its numbers are the same bit for bit."""
    spec, _ = case_of(FAULTS[fault], period, sampling, 0.01)
    engine = prepare(spec).engine
    whole = rows_of(engine)
    for chunk in (10, 70, 990):
        for one, other in zip(whole, rows_of(engine, chunk=chunk), strict=True):
            assert one.tobytes() == other.tobytes()


@pytest.mark.parametrize("period", [None, 0.25])
@pytest.mark.parametrize("jitter", [0.0, 0.07])
def test_late_and_lost_samples_reach_the_plant(period: float | None, jitter: float):
    """Where the true sensor loses samples or is late, the controller reads what observers read."""
    sensor = {"period": 0.2, "missing": 0.3, "jitter": jitter}
    changes = {"truth": {"outputs": {"y": sensor}}, "noise": {"y": {"std": 0.01, "sample_time": 0.5}}, "seed": 4}
    engine = prepare(experiment(level(period), **changes)).engine
    level_, y, u, e = rows_of(engine)
    for one, other in zip((level_, y, u, e), rows_of(engine, chunk=70), strict=True):
        assert one.tobytes() == other.tobytes()
    taken = engine.measurement.sampled_by[0].taken(0, engine.steps + 1)
    noise = 0.01 * random_streams.normal(noise_key(4, 0), 0, 200)
    rows = np.arange(len(y)) * engine.every
    latest = taken[np.searchsorted(taken, rows, side="right") - 1]
    on_row = latest % engine.every == 0
    sampled = level_[latest[on_row] // engine.every] + noise[(latest[on_row] * 0.01 / 0.5 + 1e-9).astype(int)]
    np.testing.assert_allclose(y[on_row], sampled, rtol=1e-12)
    assert 0.6 < len(taken) / (engine.steps / 20) < 0.8
    if period is None:
        r = np.array([set_point_of_three(t) for t in rows * 0.01])
        np.testing.assert_allclose(u, np.clip(2 * (r - y) + 0.5 * e + 0.5, 0, 2), rtol=1e-12)


def set_point_of_three(t: float) -> float:
    """Return the usual set point of `experiment`."""
    return 1.3 if 20 <= t < 40 else 1.0
