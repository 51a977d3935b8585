"""Compare runs: settings that differ, measures of one observer of each, and curves overlaid."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from thetascope.messages import Message
from thetascope.runs.jobs.job import Snapshot
from thetascope.runs.results.run_facts import facts_of_run
from thetascope.runs.specs.refusals import invalid
from thetascope.runs.specs.spec_changes import differing
from thetascope_schemas.service.run import ObserverSummary, RunSummary

FEWEST, MOST = 2, 6


def parse_ids(text: str) -> list[str]:
    """Return the ids of two to six runs, separated by commas, each once. Raises InvalidSpec for another number."""
    ids = list(dict.fromkeys(id.strip() for id in text.split(",") if id.strip()))
    if not FEWEST <= len(ids) <= MOST:
        raise invalid("ids", text[:80], Message("run.compare-count", n=len(ids)))
    return ids


@dataclass(frozen=True)
class Compared:
    """Runs that are compared, with the observer of each: the one that was chosen if the run has it, else its first."""

    runs: Sequence[Snapshot]
    labels: Sequence[str | None]


def compare_runs(runs: Sequence[Snapshot], observer: str | None) -> Compared:
    """Return runs with the observers that are compared; without a choice those whose measures the list shows."""
    labels = []
    for run in runs:
        has = observer is not None and observer in run.spec.observer_configs()
        labels.append(observer if has else facts_of_run(run.spec, run.summary).shown["observer"])
    return Compared(runs, labels)


def choices(compared: Compared) -> list[str]:
    """Return the observers that can be compared: those of all runs first, then those of some."""
    of_runs = [list(run.spec.observer_configs()) for run in compared.runs]
    labels = dict.fromkeys(label for one in of_runs for label in one)
    return sorted(labels, key=lambda label: -sum(label in one for one in of_runs))


def differences(compared: Compared) -> dict[str, Any]:
    """Return the settings that differ, with the values of each run, and the number of the others."""
    rows, same = differing([run.spec for run in compared.runs])
    return {"differences": rows, "same": same}


def measures(compared: Compared) -> list[dict[str, Any]]:
    """Return the measures that at least one run has: label, unit, and values of each run; less is better in all."""
    found = [_measures(run.summary, label) for run, label in zip(compared.runs, compared.labels, strict=True)]
    keys = dict.fromkeys(key for one in found for key in one)
    return [
        {
            "label": Message(code, name=name).as_data(),
            "unit": unit,
            "values": [one.get((code, name, unit)) for one in found],
        }
        for code, name, unit in keys
    ]


def _measures(summary: RunSummary | None, label: str | None) -> dict[tuple[str, str, str], float | None]:
    """Return the measures of an observer by code, name of the quantity, and unit."""
    observer = next((one for one in summary.observers if one.label == label), None) if summary else None
    if summary is None or observer is None:
        return {}
    values: dict[tuple[str, str, str], float | None] = {}
    values |= {("measure.rmse", state, ""): value for state, value in observer.rmse_end.items()}
    values |= _of_faults(observer)
    row = (
        next((row for row in summary.comparison.observers if row.label == label), None) if summary.comparison else None
    )
    if row is not None:
        values[("measure.delay", "", "s")] = row.delay
        counts = {"missed": row.missed, "false-alarms": row.false_alarms, "wrong": row.isolation_errors}
        values |= {(f"measure.{name}", "", ""): count for name, count in counts.items()}
    return values


def _of_faults(observer: ObserverSummary) -> dict[tuple[str, str, str], float | None]:
    """Return how soon estimates settled after each fault's first step, and their noise at the end."""
    values: dict[tuple[str, str, str], float | None] = {}
    for step in observer.settling:
        values.setdefault(("measure.settling", step.channel, "s"), step.time)
    return values | {("measure.noise", channel, ""): final.std for channel, final in observer.theta.items()}
