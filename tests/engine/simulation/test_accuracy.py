"""The accuracy of runs against SciPy's LSODA at 1e-11, on plants that a fixed step gets wrong or cannot run at all.

LSODA takes a hundredth of the time of Radau, to which `python -m benchmarks.accuracy` compares.
"""

import numpy as np
import pytest
from scipy.linalg import expm

from benchmarks.accuracy import CASES
from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.compiler.instructions import implicit_method
from thetascope.engine.model.result import TOLERANCE
from thetascope.engine.programs.propagation import exponentials
from thetascope_schemas import Experiment

LONG = "the Oregonator"


@pytest.mark.parametrize(("name", "step"), [(n, case.steps[-1]) for n, case in CASES.items() if n != LONG])
def test_the_plant_is_right_at_a_step_that_is_too_long(name: str, step: float):
    """Each state agrees with LSODA to the tolerance of its scale, and the run states an accuracy."""
    case = CASES[name]
    result = case.run(step)
    assert case.error(result, "LSODA") < TOLERANCE
    assert result.accuracy is not None and result.accuracy_message is not None


@pytest.mark.parametrize("name", ["Robertson", "a ball on a stiff floor", "a lag of 10 μs"])
def test_two_methods_of_scipy_agree(name: str):
    """LSODA and Radau differ by less than a hundredth of the tolerance to which runs are compared with them."""
    exact = CASES[name].exact()
    assert (np.abs(CASES[name].exact("LSODA") - exact) < TOLERANCE / 100 * np.abs(exact).max(axis=0)).all()


def test_the_stated_accuracy_covers_a_kept_error():
    """The stated error of an oscillation without damping, which keeps every error, is within a factor of three."""
    case = CASES["Lotka and Volterra"]
    result = case.run(0.1)
    error = case.error(result, "LSODA")
    assert result.accuracy is not None
    assert error / 3 < result.accuracy.plant < 10 * error


def test_the_growth_of_errors_does_not_depend_on_the_rest_of_a_span():
    """The exponential of a matrix is SciPy's, and the same bits beside a matrix of 1e40 as alone."""
    small = np.random.default_rng(0).normal(size=(20, 3, 3))
    together = exponentials(np.concatenate([small, np.full((1, 3, 3), 1e40)]))
    np.testing.assert_array_equal(together[:-1], exponentials(small))
    np.testing.assert_allclose(together[:-1], expm(small), rtol=1e-6, atol=1e-9)
    assert np.isinf(together[-1]).all()


def test_the_implicit_method_has_order_five_and_is_stiffly_accurate():
    """The coefficients satisfy the order conditions to the precision with which they are published."""
    A = np.zeros((8, 8))
    for i, row in enumerate(implicit_method.A):
        A[i, : len(row)] = row
        A[i, i] = implicit_method.GAMMA if i else 0.0
    b, c = A[-1], np.array(implicit_method.C)
    conditions = {
        1.0: b,
        1 / 2: b * c,
        1 / 3: b * c**2,
        1 / 6: b * (A @ c),
        1 / 4: b * c**3,
        1 / 8: b * c * (A @ c),
        1 / 12: b * (A @ c**2),
        1 / 24: b * (A @ A @ c),
        1 / 5: b * c**4,
        1 / 20: b * (A @ c**3),
        1 / 60: b * (A @ A @ c**2),
        1 / 120: b * (A @ A @ A @ c),
    }
    assert np.abs(A.sum(axis=1) - c).max() < 1e-9 and c[-1] == 1
    for value, terms in conditions.items():
        assert terms.sum() == pytest.approx(value, abs=1e-9)


@pytest.mark.parametrize("rows", [1, 7, 40])
def test_splitting_a_run_changes_no_number(rows: int):
    """Substeps are chosen alike however many rows each call advances, where they change often."""
    from thetascope.engine.simulation.controlled import simulation_of

    case = CASES["a reactor that ignites"]
    spec = {
        "id": "case",
        "plant": {
            "id": "case",
            "states": [{"name": n, "initial": v} for n, (v, _) in case.states.items()],
            "outputs": [{"name": "y", "expression": "T"}],
            "dynamics": {n: text for n, (_, text) in case.states.items()},
        },
        "horizon": 3,
        "step": 0.01,
        "evaluate": 0.02,
    }
    e = prepare(library.resolve(Experiment.model_validate(spec))).engine
    whole = np.concatenate([r.plant for _, r in simulation_of(e).spans(e.steps)])
    state, parts = simulation_of(e).initial(), []
    while state.k < e.steps:
        state, part = simulation_of(e).advance(state, min(rows * e.every, e.steps - state.k))
        parts.append(part.plant)
    np.testing.assert_array_equal(np.concatenate(parts), whole)


def test_an_observer_that_is_stiff_while_it_settles_finds_its_fault():
    """Its covariance settles in a ten-thousandth of a base step, which is divided; later, implicit steps suffice."""
    plant = {
        "id": "vat",
        "states": [{"name": "x", "initial": 1}],
        "inputs": [{"name": "u", "default": 1}],
        "outputs": [{"name": "y", "expression": "x"}],
        "dynamics": {"x": "u - x/1e5"},
        "channels": [{"name": "loss", "kind": "actuator", "enters": {"x": "-u"}, "typical": 0.2}],
    }
    spec = {
        "id": "case",
        "plant": plant,
        "observers": [{"label": "o", "kind": "adaptive-kalman"}],
        "noise": {"y": {"std": 0.01, "sample_time": 1e3}},
        "faults": [{"channel": "loss", "shape": "step", "onset": 5e5, "size": 0.2}],
        "horizon": 1e6,
        "step": 1e3,
        "diagnosis": {"enabled": False},
    }
    result = prepare(library.resolve(Experiment.model_validate(spec))).run()
    assert result.column("o.theta.loss")[-1] == pytest.approx(0.2, abs=1e-3)
    assert result.accuracy is not None and result.accuracy.implicit and result.accuracy.observers < 1e-3
