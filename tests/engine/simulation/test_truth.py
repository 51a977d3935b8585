"""Runs whose true plant differs from the model."""

from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from tests.engine.plants import oscillator
from tests.engine.plants import spec as oscillator_spec
from tests.simulate import simulate
from thetascope.assembly import prepare
from thetascope.assembly.build.diagnosis_settings import calibration_key
from thetascope.engine.errors import SpecError
from thetascope.engine.simulation.batch import run_batch, with_seed
from thetascope.messages import words
from thetascope_schemas import Experiment, ResolvedExperiment, field_errors
from thetascope_schemas.service.field_error import sentences

LAG = {
    "id": "lag",
    "states": [{"name": "x"}],
    "inputs": [{"name": "u"}],
    "outputs": [{"name": "y", "expression": "x"}],
    "parameters": [{"name": "a", "value": 2.0}],
    "dynamics": {"x": "u - a*x"},
    "channels": [{"name": "force", "kind": "actuator", "enters": {"x": "1"}}],
}


def resolved(**changes: Any) -> ResolvedExperiment:
    """Return the oscillator's experiment with changes."""
    experiment = Experiment.model_validate(oscillator_spec(**changes))
    return experiment.with_plant(experiment.plant)


def lag(**changes: Any) -> ResolvedExperiment:
    """Return a run of a first-order lag with changes."""
    data = {"plant": LAG, "horizon": 10.0, "step": 0.01, "evaluate": 0.1} | changes
    experiment = Experiment.model_validate(data)
    return experiment.with_plant(experiment.plant)


def test_without_a_truth_an_experiment_keeps_its_hash():
    """An empty truth is the same spec."""
    assert resolved(truth={}).spec_hash() == resolved().spec_hash()
    assert resolved(truth={"deviation": 0.02}).spec_hash() != resolved().spec_hash()


def test_true_parameters_move_the_plant_and_not_the_model():
    """The plant has the bits of a run with these parameters; the observer keeps the model's."""
    true = resolved(truth={"parameters": {"k": 5.0}})
    other = resolved(parameters={"k": 5.0})
    a, b = simulate(true), simulate(other)
    for name in ("x.x1", "x.x2", "y.y"):
        assert (a.column(name) == b.column(name)).all()
    estimate = next(n for n in a.names if n.endswith(".theta.force"))
    assert np.abs(a.column(estimate) - b.column(estimate)).max() > 0.01
    engine = prepare(true).engine
    assert engine.parameters["p.k"] == 5.0
    assert engine.modelled.parameters["p.k"] == engine.estimators[0].parameters["m.k"] == 4.0


def test_a_deviation_moves_every_parameter_by_that_share_in_a_direction_of_the_seed():
    """Each parameter is off by exactly the share, up or down; a named one is as named; bounds hold."""
    seen = set()
    for seed in range(12):
        spec = resolved(seed=seed, truth={"deviation": 0.02, "parameters": {"d": 0.31}})
        values = prepare(spec).engine.parameters
        assert values["p.d"] == 0.31
        seen.add(round(values["p.k"] / 4.0, 12))
    assert seen == {0.98, 1.02}
    plant = oscillator(parameters=[{"name": "k", "value": 4.0, "bounds": [3.99, 4.01]}, {"name": "d", "value": 0.3}])
    assert prepare(resolved(plant=plant, truth={"deviation": 0.1})).engine.parameters["p.k"] in (3.99, 4.01)


@pytest.mark.parametrize("step", [0.01, 0.2])
def test_process_noise_has_the_variance_of_an_ornstein_uhlenbeck_process(step: float):
    """x' = −ax + σ·white noise has the variance σ²/2a, times tanh(z/2)/(z/2) with z = a·step, at every later row."""
    sigma, a = 0.3, 2.0
    spec = lag(step=step, evaluate=0.2, truth={"process_noise": {"x": sigma}})
    engine = prepare(spec).engine
    batch = run_batch([with_seed(engine, seed) for seed in range(300)])
    late = batch.plant[:, 15:, 0]
    z = a * step
    expected = sigma**2 / (2 * a) * np.tanh(z / 2) / (z / 2)
    assert late.var() == pytest.approx(expected, rel=0.05)
    lag_one = np.mean(late[:, 1:] * late[:, :-1]) / late.var()
    assert lag_one == pytest.approx(np.exp(-a * 0.2), abs=0.03)


def test_process_noise_depends_neither_on_rows_nor_on_substeps():
    """Another spacing of rows gives the same bits, four substeps the same path to integration error."""
    truth = {"process_noise": {"x1": 0.05, "x2": 0.2}}
    fine, coarse = simulate(resolved(truth=truth)), simulate(resolved(truth=truth, evaluate=0.25))
    assert (fine.column("x.x1")[::5] == coarse.column("x.x1")).all()
    divided = simulate(resolved(truth=truth, substeps=4))
    assert np.abs(divided.column("x.x1") - fine.column("x.x1")).max() < 1e-8
    assert np.abs(fine.column("x.x1") - simulate(resolved()).column("x.x1")).max() > 0.01


def test_process_noise_of_a_discrete_plant_is_that_of_a_period():
    """x(k+1) = x(k) + noise is a random walk of standard deviation std·√t."""
    plant = LAG | {"time": {"kind": "discrete", "period": 0.1}, "dynamics": {"x": "x + 0*u*a"}}
    spec = lag(plant=plant, step=0.1, evaluate=None, truth={"process_noise": {"x": 0.3}})
    batch = run_batch([with_seed(prepare(spec).engine, seed) for seed in range(400)])
    assert batch.plant[:, -1, 0].std() == pytest.approx(0.3 * np.sqrt(10.0), rel=0.15)


def test_unmodelled_dynamics_are_the_equations_written_out():
    """A lag of the actuator and an unmodelled part of the output give the columns of a plant that has them."""
    truth = {
        "states": [{"name": "valve", "initial": 0.2}],
        "dynamics": {"valve": "(u - valve)/0.1", "x2": "valve - u"},
        "outputs": {"y": {"adds": "0.1*valve"}},
    }
    base = oscillator()
    written = oscillator(
        states=[*base["states"], {"name": "valve", "initial": 0.2}],
        dynamics={"x1": "x2", "x2": "-k*x1 - d*x2 - 0.2*x1^3 + valve", "valve": "(u - valve)/0.1"},
        outputs=[{"name": "y", "expression": "x1 + 0.1*valve"}],
    )
    true, expected = simulate(resolved(truth=truth, observers=[])), simulate(resolved(plant=written, observers=[]))
    for name in ("x.x1", "x.x2", "x.valve", "y.y"):
        assert np.abs(true.column(name) - expected.column(name)).max() < 1e-12
    assert prepare(resolved(truth=truth)).engine.modelled.plant == prepare(resolved()).engine.plant


def test_sampled_outputs_hold_their_values_and_lose_samples():
    """Between samples y stays; with a share of samples lost, that share of instants has no new value."""
    truth = {"outputs": {"y": {"period": 0.1, "missing": 0.3, "jitter": 0.02}}}
    result = simulate(resolved(truth=truth, evaluate=0.005, horizon=60.0))
    changes = np.flatnonzero(np.diff(result.column("y.y"))) + 1
    assert len(changes) == pytest.approx(0.7 * 600, abs=50)
    assert np.unique(changes % 20).tolist() == [0, 1, 2, 3, 4]
    assert np.isfinite(result.column("y.y")).all()


def test_a_truth_does_not_change_what_the_detector_assumes():
    """Thresholds belong to the model: their key is that of the experiment without the truth, sample periods apart."""
    truth = {"deviation": 0.05, "process_noise": {"x1": 1.0}, "outputs": {"y": {"correlation": 1.0}}}
    assert calibration_key(resolved(truth=truth)) == calibration_key(resolved())
    sampled = [resolved(truth={"outputs": {"y": {"period": 0.1, "missing": m}}}) for m in (0.1, 0.4)]
    assert calibration_key(sampled[0]) == calibration_key(sampled[1]) != calibration_key(resolved())


@pytest.mark.parametrize(
    ("truth", "field"),
    [
        ({"parameters": {"kk": 1.0}}, "truth.parameters.kk"),
        ({"process_noise": {"x1": -1.0}}, "truth.process_noise.x1"),
        ({"process_noise": {"x3": 1.0}}, "truth.process_noise.x3"),
        ({"states": [{"name": "u"}], "dynamics": {"u": "1"}}, "truth.states[0].name"),
        ({"states": [{"name": "z"}]}, "truth.dynamics"),
        ({"dynamics": {"z": "1"}}, "truth.dynamics.z"),
        ({"outputs": {"y": {"period": 0.0123}}}, "truth.outputs.y.period"),
        ({"outputs": {"y": {"period": 0.1, "jitter": 0.2}}}, "truth.outputs.y.jitter"),
        ({"outputs": {"y": {"missing": 1.0}}}, "truth.outputs.y.missing"),
        ({"outputs": {"z": {"correlation": 1.0}}}, "truth.outputs.z"),
        ({"deviation": 2.0}, "truth.deviation"),
        ({"noise": 2.0}, "truth.noise"),
    ],
)
def test_a_wrong_truth_is_refused_with_field_and_remedy(truth: dict, field: str):
    """The refusal names the field in full and how to correct it, in both languages."""
    with pytest.raises(ValidationError) as caught:
        resolved(truth=truth)
    (error,) = field_errors(caught.value.errors())
    assert error.field == field
    for language in ("en", "zh"):
        problem, remedy = sentences(error.code, error.args, words(language))
        assert problem
        assert remedy


def test_a_wrong_text_of_the_truth_points_at_its_field():
    """An expression with an unknown name is refused with the field in the truth, not in the plant."""
    with pytest.raises(SpecError) as caught:
        prepare(resolved(truth={"dynamics": {"x1": "0.1*q"}}))
    assert caught.value.field == "truth.dynamics.x1"
    with pytest.raises(SpecError) as caught:
        prepare(resolved(truth={"outputs": {"y": {"adds": "x1 +"}}}))
    assert caught.value.field == "truth.outputs.y.adds"


def test_samples_without_a_period_are_refused_where_nothing_gives_one():
    """Lost samples of a continuous output without noise need a period; correlated noise needs noise."""
    for field in ("missing", "jitter", "correlation"):
        with pytest.raises(ValidationError) as caught:
            resolved(noise={}, truth={"outputs": {"y": {field: 0.1}}})
        assert field_errors(caught.value.errors())[0].field == f"truth.outputs.y.{field}"
    assert prepare(resolved(truth={"outputs": {"y": {"missing": 0.1}}})).engine.measurement.samplings[0].every == 2
