"""Runs in the process of the caller, without a service: `from thetascope import run`."""

from collections.abc import Mapping

from thetascope.assembly import prepare
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.runs.specs.refusals import from_engine
from thetascope.runs.specs.resolve_spec import library_experiment, resolved, with_changes
from thetascope.runs.specs.run_requests import parse_request
from thetascope_schemas import Experiment


def run(experiment: str | Mapping[str, object] | Experiment, changes: Mapping[str, object] | None = None) -> Result:
    """Run an experiment and return its result, with the same numbers as the service and the command line.

    Nothing is stored, and none of the service's limits applies.

    Args:
        experiment: id of a library experiment, an experiment as data (as posted to /api/runs), or an `Experiment`.
        changes: path → new value, for example {"noise.y.std": 0, "observers.adaptive.gains.rho": 8}.

    Returns:
        The result: `names` of the columns, `data` of shape (columns, rows), `column(name)` of shape (rows,), and the
        reports of the observers.

    Raises:
        Unknown: the library has no such experiment.
        InvalidSpec: the experiment is refused; it names the fields, the problems and the remedies.
    """
    if isinstance(experiment, str):
        spec = library_experiment(experiment)
    else:
        spec = experiment if isinstance(experiment, Experiment) else parse_request(dict(experiment))
    try:
        return prepare(resolved(with_changes(spec, changes or {}))).run()
    except SpecError as error:
        raise from_engine(error, in_plant=True) from None
