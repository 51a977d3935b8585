"""The report of a run, for the service and the command line."""

from collections.abc import Callable
from datetime import UTC, datetime

from thetascope.runs.jobs.job import Finished
from thetascope.runs.specs.resolve_spec import plant_of
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.diagnosis import Observability
from thetascope_schemas.experiment.plant import Plant


def report_html(finished: Finished, command: str | None = None, language: str = "en") -> str:
    """Return the run as one HTML file in a language; `command` is the command line that reproduces it, if known."""
    from thetascope.report.html_report import report  # imported only for reports

    return report(finished.result, finished.snapshot.spec, _plant(finished), _about(finished, command), language)


def report_with(finished: Finished, seen: Observability | None, language: str) -> str:
    """Return the same with an observability that was computed elsewhere; None: it was not."""
    from thetascope.report.html_report import report

    about = _about(finished, None)
    return report(finished.result, finished.snapshot.spec, _plant(finished), about, language, lambda spec: seen)


Observed = tuple[Callable[[ResolvedExperiment], Observability], ResolvedExperiment]


def observed(finished: Finished) -> Observed | None:
    """Return the function and the argument that give the observability in a report; None: the report shows none."""
    from thetascope.assembly.analyses.observability_report import observability  # imports SymPy

    if finished.result.diagnosis is None:
        return None
    return observability, finished.snapshot.spec.with_plant(_plant(finished))


def _plant(finished: Finished) -> Plant:
    spec = finished.snapshot.spec
    plant = plant_of(spec.plant)
    return plant if spec.truth.record is None else plant.without_controllers


def _about(finished: Finished, command: str | None) -> dict[str, str | None]:
    created = datetime.fromtimestamp(finished.snapshot.created, UTC).strftime("%Y-%m-%d %H:%M UTC")
    return {"id": finished.snapshot.id, "created": created, "command": command}
