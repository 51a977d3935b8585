"""The report of a run, for the service and the command line."""

from datetime import UTC, datetime

from thetascope.runs.jobs.job import Finished
from thetascope.runs.specs.resolve_spec import plant_of


def report_html(finished: Finished, command: str | None = None, language: str = "en") -> str:
    """Return the run as one HTML file in a language; `command` is the command line that reproduces it, if known."""
    from thetascope.report.html_report import report  # imported only for reports

    snapshot = finished.snapshot
    created = datetime.fromtimestamp(snapshot.created, UTC).strftime("%Y-%m-%d %H:%M UTC")
    about = {"id": snapshot.id, "created": created, "command": command}
    plant = plant_of(snapshot.spec.plant)
    if snapshot.spec.truth.record is not None:
        plant = plant.without_controllers
    return report(finished.result, snapshot.spec, plant, about, language)
