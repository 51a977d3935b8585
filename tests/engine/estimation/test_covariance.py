"""The uncertainty of θ̂: the computed covariance against simulations."""

from dataclasses import replace

import numpy as np
import pytest

from tests.simulate import simulate
from thetascope import library
from thetascope.assembly import prepare
from thetascope.diagnosis.monitor.detector import healthy
from thetascope.engine.execution.run_experiment import run
from thetascope.engine.execution.stages import Stage
from thetascope.engine.model.result import Result
from thetascope.engine.simulation.batch import with_seed
from thetascope_schemas import Experiment

SEEDS = 10


def results(name: str) -> tuple[list[Result], tuple]:
    """Return runs of an experiment without its faults and with its observers, for several seeds."""
    experiment = prepare(library.resolve(library.experiment(name))).stages[0].experiment
    plain = replace(healthy(experiment), estimators=experiment.estimators)
    return [run([Stage(0, with_seed(plain, 300 + k))]) for k in range(SEEDS)], experiment.estimators


@pytest.mark.parametrize("name", ["zhao-2012", "dc-motor", "contois-physical", "shen-hu-2015"])
def test_the_95_percent_band_covers_the_truth(name: str):
    """In the last two thirds of ten runs the band contains θ 93 to 97 % of the time,
    over all estimates of an observer."""
    runs, estimators = results(name)
    for e in (e for e in estimators if e.channels):
        inside = []
        for r in runs:
            late = len(r.column("t")) // 3
            for c in e.channels:
                error = r.column(f"{e.label}.theta.{c}") - r.column(f"theta.{c}")
                inside.append((np.abs(error) < 1.96 * r.column(f"{e.label}.sigma.{c}"))[late:])
        assert 0.93 <= np.mean(inside) <= 0.97, e.label


def test_the_band_of_a_kalman_filter_agrees_with_its_own_covariance():
    """If all its assumptions hold, the independent recursion for S agrees with the filter's P to a tenth."""
    runs, _ = results("friction-motor")
    late = len(runs[0].column("t")) // 2
    computed, claimed = (np.mean([r.column(f"ekf.{w}.friction")[late:] for r in runs]) for w in ("sigma", "claimed"))
    assert computed < 1.1 * claimed


def test_the_band_widens_when_excitation_is_lost():
    """At zero voltage the joint EKF of a motor has no information on its gain: that band is five times as wide."""
    spec = library.experiment("dc-motor").model_dump(mode="json")
    kept = [o for o in spec["observers"] if o["label"] == "ekf"]
    spec |= {"faults": [], "figures": [], "diagnosis": {"enabled": False}, "observers": kept}
    still = spec | {"inputs": {name: {"kind": "constant", "value": 0.0} for name in spec["inputs"]}}
    moving, rest = (
        simulate(library.resolve(Experiment.model_validate(s))).column("ekf.sigma.gain_loss")[-1] for s in (spec, still)
    )
    assert rest > 5 * moving


def test_a_precise_measurement_keeps_the_band():
    """A twentieth of the noise makes the motor's adaptive observer stiff: its bands are finite and hold the truth."""
    spec = library.experiment("dc-motor").model_dump(mode="json")
    kept = [o for o in spec["observers"] if o["label"] == "adaptive"]
    noise = {"y_current": {"std": 0.0025, "sample_time": 0.005}, "y_speed": {"std": 0.025, "sample_time": 0.005}}
    spec |= {"noise": noise, "figures": [], "diagnosis": {"enabled": False}, "observers": kept, "faults": []}
    result = simulate(library.resolve(Experiment.model_validate(spec)))
    names = [n.removeprefix("adaptive.sigma.") for n in result.names if n.startswith("adaptive.sigma.")]
    sigma = np.array([result.column(f"adaptive.sigma.{n}") for n in names])
    error = np.array([result.column(f"adaptive.theta.{n}") for n in names])
    assert np.isfinite(sigma).all()
    late = sigma.shape[1] // 3
    assert np.mean(np.abs(error) < 1.96 * sigma, axis=1, where=np.arange(sigma.shape[1]) >= late).min() > 0.8
