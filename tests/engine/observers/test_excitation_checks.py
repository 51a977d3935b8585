"""Checks of a theorem's conditions on extreme numbers: they report it, and the run is kept."""

from dataclasses import replace

import numpy as np

from tests.runs.samples import spec
from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.execution.run_experiment import run
from thetascope.engine.model.result import Check, ObserverReport
from thetascope.engine.observers.support.declaration import Observed
from thetascope.engine.observers.support.excitation_checks import closed_loop
from thetascope_schemas.experiment.experiment import Experiment


def reported(checks) -> ObserverReport:
    """Return the report of an adaptive Kalman observer with other checks."""
    experiment: Experiment = spec(observers=[{"label": "a", "kind": "adaptive-kalman"}], diagnosis={"enabled": False})
    (stage,) = prepare(library.resolve(experiment)).stages
    (watching,) = stage.experiment.estimators
    other = replace(watching, kind=replace(watching.kind, checks=checks))
    result = run((replace(stage, experiment=replace(stage.experiment, estimators=(other,))),))
    assert np.isfinite(result.column("a.theta.gain")).all()
    return result.observers[0]


def test_a_gain_that_overflows_is_named_with_its_remedy():
    """K = P Cᵀ R⁻¹ with P near the largest double and the smallest r has no eigenvalues, but a cause."""

    def checks(seen: Observed) -> list[Check]:
        return [
            closed_loop(
                replace(seen, values=seen.values | {"P.0.0": np.full(len(seen.values["t"]), 1e300), "g.r.0": 1e-30}),
                "Kalman",
            )
        ]

    (check,) = reported(checks).checks
    assert (str(check.name), check.verdict) == ("A − KC stable", "cannot tell") and "raise r" in str(check.text)


def test_checks_that_fail_on_their_numbers_do_not_lose_the_run():
    """A matrix without eigenvalues leaves the verdict open."""
    (check,) = reported(lambda seen: [np.linalg.eigvals(np.full((2, 2), np.nan))]).checks
    assert (str(check.name), check.verdict) == ("conditions of the theorem", "cannot tell")
