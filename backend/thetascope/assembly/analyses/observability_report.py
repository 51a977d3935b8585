"""Observability of states and faults from the outputs of an experiment: structurally, and along the run."""

import math

from thetascope.assembly.analyses.record_run import with_rows
from thetascope.assembly.build.prepare import prepare
from thetascope.engine.observability.empirical_gramian import empirical
from thetascope.engine.observability.identifiability import structure
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.diagnosis import Observability

WINDOW = 0.1  # of the horizon
_INSTANTS = 6


def observability(spec: ResolvedExperiment) -> Observability:
    """Return the symbolic rank, valid for some input, and the empirical Gramian along the run with this one."""
    plain = with_rows(spec).model_copy(update={"observers": (), "figures": (), "commands": ()})
    experiment = prepare(plain).engine
    found, along = (
        structure(spec.plant.model_dump(mode="json")),
        empirical(experiment, WINDOW * spec.horizon, _INSTANTS),
    )
    answer = {
        "rank": found.rank if found.decided else None,
        "size": found.size,
        "text": found.text,
        "window": along.window,
        "t": along.t.tolist(),
        "ranks": [int(r) if r >= 0 else None for r in along.rank],
        "conditions": [float(c) if math.isfinite(c) else None for c in along.condition],
        "along": along.text,
    }
    return Observability.model_validate(answer)
