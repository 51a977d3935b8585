"""Between the snapshots of the run manager and the rows of the store."""

from thetascope.messages import Message
from thetascope.runs.jobs.job import Snapshot
from thetascope.runs.results.engine_version import engine_version
from thetascope.runs.specs.problem_documents import problem
from thetascope.store import Record
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.run import Problem, RunSummary


def record_of(snapshot: Snapshot) -> Record:
    """The row that keeps a run."""
    return Record(
        id=snapshot.id,
        spec=snapshot.spec.model_dump_json(),
        title=snapshot.spec.title or snapshot.spec.id,
        status=snapshot.status,
        engine=engine_version(),
        created=snapshot.created,
        error=snapshot.problem and snapshot.problem.model_dump(mode="json"),
        summary=snapshot.summary and snapshot.summary.model_dump(mode="json"),
        pinned=snapshot.pinned,
    )


def snapshot_of(record: Record) -> Snapshot:
    """The run that a row keeps."""
    return Snapshot(
        id=record.id,
        spec=Experiment.model_validate_json(record.spec),
        status=record.status,
        created=record.created,
        progress=1.0 if record.status == "done" else 0.0,
        summary=record.summary and RunSummary.model_validate(record.summary),
        problem=record.error and Problem.model_validate(record.error),
        pinned=record.pinned,
    )


#: The problem of a run that an earlier server accepted and did not finish.
INTERRUPTED = problem(500, Message("run.interrupted"))
