"""Convert between snapshots of the run manager and rows of the store."""

import json

from pydantic import ValidationError

from thetascope.engine.model.result import Result
from thetascope.messages import Message
from thetascope.runs.jobs.job import Snapshot
from thetascope.runs.results.engine_version import engine_version
from thetascope.runs.results.run_facts import facts_of_run
from thetascope.runs.specs.problem_documents import problem
from thetascope.store import Record
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.run import Problem, RunSummary
from thetascope_schemas.texts.local_text import ALL, LocalText, in_language

_SEVERAL = "\x1f"


def record_of(snapshot: Snapshot, result: Result | None = None) -> Record:
    """Return the row that stores a run, with the facts of its line in lists."""
    return Record(
        id=snapshot.id,
        spec=snapshot.spec.model_dump_json(context={"language": ALL}),
        title=_written(snapshot.spec.title or snapshot.spec.id),
        status=snapshot.status,
        engine=engine_version(),
        created=snapshot.created,
        error=snapshot.problem and snapshot.problem.model_dump(mode="json"),
        summary=snapshot.summary and snapshot.summary.model_dump(mode="json"),
        pinned=snapshot.pinned,
        facts=facts_of_run(snapshot.spec, snapshot.summary, result),
    )


def title_of(run: Snapshot | Record, language: str) -> str:
    """Return the title of a run in a language."""
    if isinstance(run, Snapshot):
        return in_language(run.spec.title or run.spec.id, language)
    if not run.title.startswith(_SEVERAL):
        return run.title
    return in_language(LocalText(json.loads(run.title.removeprefix(_SEVERAL))), language)


def _written(title: str) -> str:
    """Return the text that stores a title; one in several languages as JSON behind a mark that no title begins with."""
    return _SEVERAL + json.dumps(title.texts, ensure_ascii=False) if isinstance(title, LocalText) else title


def snapshot_of(record: Record) -> Snapshot:
    """Return the run that a row stores; one whose outcome is damaged has failed, and can be run again."""
    spec = Experiment.model_validate_json(record.spec)
    if record.damaged:
        why = problem(500, Message("store.run-damaged", id=record.id))
        return Snapshot(record.id, spec, "failed", record.created, problem=why, pinned=record.pinned)
    return Snapshot(
        id=record.id,
        spec=spec,
        status=record.status,
        created=record.created,
        progress=1.0 if record.status == "done" else 0.0,
        summary=_summary_of(record),
        problem=None if record.error is None else Problem.model_validate(record.error),
        pinned=record.pinned,
    )


def _summary_of(record: Record) -> RunSummary | None:
    """Return the stored summary; None if an earlier version wrote it in a form that the schema no longer accepts."""
    if record.summary is None:
        return None
    try:
        return RunSummary.model_validate(record.summary)
    except ValidationError:
        return None


#: The problem of a run that an earlier server accepted and did not finish.
INTERRUPTED = problem(500, Message("run.interrupted"))
