"""Simulate an experiment without the detector: most tests of the engine need only its columns."""

from thetascope.assembly import prepare
from thetascope.engine.execution.run_experiment import run
from thetascope.engine.model.result import Result
from thetascope_schemas import ResolvedExperiment


def simulate(spec: ResolvedExperiment) -> Result:
    """Run plant and observers as a run does, with their columns and checks, but without the diagnosis."""
    return run(prepare(spec).stages)
