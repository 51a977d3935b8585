"""Plant, measurement and observers together: order, blocks, discontinuities, and the inputs of observers."""

from dataclasses import replace

import numpy as np
import pytest

from tests.engine.plants import adaptive, engine, oscillator
from thetascope.engine.execution.run_experiment import run
from thetascope.engine.model.result import Result
from thetascope.engine.observers.registry import kinds, observer
from thetascope.engine.simulation.simulation import Simulation


def rows_of(e, chunks: list[int]):
    """Return the rows of a simulation advanced in the given blocks."""
    simulation = Simulation(e)
    state, parts = simulation.initial(), []
    for count in chunks:
        state, rows = simulation.advance(state, count)
        parts.append(rows)
    return [
        np.concatenate(c) for c in ([p.plant for p in parts], [p.y for p in parts], [p.observers[0] for p in parts])
    ]


def test_the_coupling_of_plant_and_observer_is_of_fourth_order():
    """Halving a fixed step divides the noise-free error by about 16."""
    quiet = {"noise": {}, "faults": [], "evaluate": 0.5, "horizon": 5.0, "substeps": 1}
    fine = run(engine(**quiet, step=0.0005)).column("adaptive.x.x2")
    coarse, half = (np.abs(run(engine(**quiet, step=h)).column("adaptive.x.x2") - fine).max() for h in (0.02, 0.01))
    assert 13 < coarse / half < 19


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"measurement": {"mode": "sampled", "period": 0.05}},
        {
            "faults": [
                {"output": "y", "shape": "dropout", "onset": 1.0, "probability": 0.4, "sample_time": 0.1},
                {"output": "y", "shape": "delay", "onset": 4.0, "delay": 0.12},
                {"channel": "force", "shape": "random-walk", "onset": 2.0, "intensity": 0.3, "sample_time": 0.07},
            ]
        },
        {
            "observers": [
                adaptive(),
                {"label": "ekf", "kind": "joint-ekf", "options": {"channels": "force", "period": 0.05}},
            ]
        },
    ],
)
def test_chunks_change_no_number(change):
    """However a run is divided into advances, every recorded number has the same bits."""
    e = engine(**change)
    whole = rows_of(e, [e.steps + 1])
    cut = rows_of(e, [1, 2, 7, 90, 400, 13, e.steps + 1 - 513])
    for a, b in zip(whole, cut, strict=True):
        np.testing.assert_array_equal(a, b)


def test_joined_and_separate_kernels_agree_bit_for_bit():
    """Plant and observer in one kernel, or y passed in a table: the same numbers."""
    e = engine()
    separate = replace(
        e,
        measurement=replace(
            e.measurement, faults=({"output": "y.y", "shape": "delay", "onset": 99.0, "end": None, "delay": 0.1},)
        ),
    )
    assert Simulation(e).joined and not Simulation(separate).joined
    for a, b in zip(rows_of(e, [e.steps + 1]), rows_of(separate, [e.steps + 1]), strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_discontinuity_off_the_grid_is_met_exactly():
    """A fault at 1.0037 s with h = 5 ms: the states agree with h = 0.1 ms, whose grid contains it,
    to rounding of RK4."""
    change = {
        "noise": {},
        "faults": [{"channel": "force", "shape": "step", "onset": 1.0037, "size": 2.0}],
        "horizon": 2.0,
    }
    coarse, fine = run(engine(**change)), run(engine(**change, step=0.0001))
    assert np.abs(coarse.column("x.x2") - fine.column("x.x2")).max() < 1e-8


def test_columns_have_the_documented_order():
    """t, u, signal, x, theta, y, then each observer's x, theta, y and diagnostics."""
    result = run(engine(horizon=1.0))
    assert result.names == (
        "t",
        "u.u",
        "x.x1",
        "x.x2",
        "theta.force",
        "theta.bias",
        "y.y",
        "adaptive.x.x1",
        "adaptive.x.x2",
        "adaptive.theta.force",
        "adaptive.y.y",
        "adaptive.pe",
        "adaptive.gramian.1",
        "adaptive.V",
        "adaptive.V1",
        "adaptive.V2",
        "adaptive.sigma.force",
    )
    np.testing.assert_array_equal(result.column("t"), np.arange(21) * 10 * 0.005)


def test_signals_are_recorded_as_right_limits():
    """A step at 3 s shows its new value in the row at 3 s."""
    result = run(engine())
    at = np.searchsorted(result.column("t"), 3.0 - 1e-9)
    assert result.column("theta.force")[at - 1 : at + 1].tolist() == [0.0, 0.5]


@pytest.mark.parametrize("kind", [k for k in kinds()])
def test_an_observer_has_no_symbol_for_the_plant_state_or_the_true_fault(kind):
    """Its inputs are t, u, known signals and y at its own times; never x or theta."""
    from thetascope import library
    from thetascope.assembly import prepare

    found = [e for e in library.experiments().values() if any(o.kind == kind for o in e.observers)]
    assert found, f"no library experiment uses {kind}"
    assert observer(kind).id == kind
    for estimator in prepare(library.resolve(found[0])).engine.estimators:
        program = estimator.program
        seen = {n for n in program.graph.index if n[0] == "var"}
        outside = {n[1] for n in seen} - set(program.states) - set(program.parameters) - {"t"}
        bare = {n.removeprefix("mid.").removeprefix("end.").removeprefix("now.") for n in outside}
        assert all(n.startswith(("u.", "signal.", "y.")) for n in bare), bare


def test_the_observer_depends_on_y_only():
    """Two different plants with the same y, and the same steps, give the same estimates."""
    stuck = [{"output": "y", "shape": "stuck", "onset": 0.0, "value": 0.25}]
    one = run(engine(faults=stuck, substeps=1))
    two = run(engine(faults=stuck, substeps=1, initial={"x1": -2.0, "x2": 1.0}))
    assert np.abs(one.column("x.x1") - two.column("x.x1")).max() > 1
    for name in ("adaptive.x.x1", "adaptive.x.x2", "adaptive.theta.force"):
        np.testing.assert_array_equal(one.column(name), two.column(name))


def diverged(result: Result):
    return result.observers[0].diverged


def test_a_diverged_observer_is_reported_and_the_other_continues():
    """Forgetting without excitation lets Γ grow without bound; the second observer is unaffected."""
    unexcited = oscillator(channels=[{"name": "force", "kind": "actuator", "enters": {"x2": "0*x1"}}])
    observers = [
        adaptive("lost", gamma0=1.0) | {"gains": {"rho": 3.0, "lambda": 9.0}},
        adaptive("kept", **{"lambda": 0.0}),
    ]
    result = run(engine(plant=unexcited, observers=observers, faults=[]))
    lost, kept = result.observers
    assert lost.diverged is not None and "Γ" in str(lost.diverged.cause) and kept.diverged is None
    assert np.isnan(result.column("lost.x.x1")[-1]) and np.isfinite(result.column("kept.x.x1")).all()


def test_a_diverged_plant_is_reported():
    """x' = x² escapes at t = 1/x(0); later rows are NaN and the report has the time."""
    plant = oscillator(dynamics={"x1": "x2", "x2": "6*x1^2"}, channels=[])
    result = run(engine(plant=plant, observers=[], faults=[], initial={"x1": 1.0, "x2": 2.0}, inputs={}, horizon=2.0))
    assert result.diverged is not None and 0.9 < result.diverged.time < 1.1
    assert np.isnan(result.column("x.x1")[-1])


def test_stiff_gains_are_substepped_to_the_numbers_of_a_fine_step():
    """A large Γ(0) makes Γ stiff: the run takes substeps and agrees with a step fifty times finer."""
    pulse = {"kind": "pulse", "low": 0, "high": 1, "period": 1.0, "width": 0.5, "start": 0}
    plant = oscillator(
        signals=[{"name": "s", "default": pulse}], channels=[{"name": "bias", "kind": "sensor", "enters": {"y": "s"}}]
    )
    change = {
        "plant": plant,
        "faults": [{"channel": "bias", "shape": "step", "onset": 3.0, "size": 0.5}],
        "noise": {},
        "observers": [adaptive(gamma0=3e3, channels="bias")],
        "horizon": 6.0,
    }
    result, fine = run(engine(**change)), run(engine(**change, step=0.0001, substeps=1))
    assert result.substeps > 1 and diverged(result) is None and fine.substeps == 1
    settled = result.column("t") > 1.0
    difference = result.column("adaptive.theta.bias") - fine.column("adaptive.theta.bias")
    assert np.abs(difference[settled]).max() < 1e-5


def test_gains_too_stiff_for_any_step_end_the_observer_only():
    """With Γ(0) = 1e9 no substeps suffice: the observer is reported as diverged, and the plant continues."""
    result = run(engine(observers=[adaptive(gamma0=1e9, channels="bias")], horizon=1.0))
    assert diverged(result) is not None and result.diverged is None
    assert np.isfinite(result.column("x.x1")).all()
