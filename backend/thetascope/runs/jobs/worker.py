"""Process jobs in worker threads: prepare (check, compile), compare the cost with the limits, run."""

import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING

from thetascope.engine.errors import Cancelled, SpecError
from thetascope.engine.model.result import Result
from thetascope.messages import Message
from thetascope.runs.jobs.job import Ended, Finished, Job, Snapshot
from thetascope.runs.results.summary import summarise
from thetascope.runs.specs.problem_documents import problem
from thetascope.runs.specs.refusals import InvalidSpec, from_engine, invalid
from thetascope.settings import Settings
from thetascope_schemas.experiment.experiment import ResolvedExperiment

if TYPE_CHECKING:
    from thetascope.assembly import Cost, Prepared

log = logging.getLogger(__name__)

_PREPARERS = 2
End = Callable[[Job, Ended | InvalidSpec], None]


def allow(spec: ResolvedExperiment, cost: "Cost", settings: Settings) -> None:
    """Refuse a run with more steps or numbers than the settings allow. Raises InvalidSpec with the figures."""
    if cost.steps > settings.max_steps:
        raise invalid(
            "horizon",
            spec.horizon,
            Message("run.steps.over-limit", steps=cost.steps, limit=settings.max_steps),
        )
    if cost.bytes > settings.max_result:
        raise invalid(
            "record",
            spec.record,
            Message(
                "run.result.over-limit",
                rows=cost.rows,
                columns=cost.columns,
                bytes=cost.bytes,
                limit=settings.max_result,
            ),
        )


class Execution:
    """The worker threads. `end` is called once for each started job, with its outcome.

    Kernels run outside Python's lock, so the workers use several cores. Preparation has separate threads, so that a
    wrong spec is refused immediately even while long runs occupy the workers.
    """

    def __init__(self, settings: Settings, end: End) -> None:
        self._settings = settings
        self._end = end
        self._preparers = ThreadPoolExecutor(_PREPARERS, thread_name_prefix="prepare")
        self._workers = ThreadPoolExecutor(max(1, settings.workers), thread_name_prefix="run")

    def start(self, job: Job, spec: ResolvedExperiment) -> None:
        """Queue a job; `spec` is its experiment, resolved."""
        self._preparers.submit(self._guarded, job, lambda: self._prepare(job, spec))

    def close(self) -> None:
        """Wait for the threads; cancel the jobs first."""
        self._preparers.shutdown(wait=True)
        self._workers.shutdown(wait=True)

    def _prepare(self, job: Job, spec: ResolvedExperiment) -> None:
        if job.cancelled:
            raise Cancelled
        from thetascope.assembly import prepare  # imports SymPy, so it is not imported at the start of the service

        prepared = prepare(spec)
        allow(spec, prepared.cost, self._settings)
        self._workers.submit(self._guarded, job, lambda: self._run(job, prepared))

    def _run(self, job: Job, prepared: "Prepared") -> None:
        if job.cancelled:
            raise Cancelled
        job.begin(self._settings.max_seconds)
        result = prepared.run(job.report, job.stopped)
        self._end(job, completed(job.snapshot(), result, prepared.spec))

    def _guarded(self, job: Job, stage: Callable[[], None]) -> None:
        """Run a stage; any exception becomes the job's outcome, so that nobody waits forever."""
        try:
            stage()
        except SpecError as error:
            self._end(job, from_engine(error, in_plant=True))
        except InvalidSpec as error:
            self._end(job, error)
        except Cancelled:
            self._end(job, self._stopped(job))
        except MemoryError:
            self._end(job, failed(job, Message("run.no-memory")))
        except Exception:
            log.exception("Run %s failed", job.id)
            self._end(job, failed(job, Message("run.internal-error")))

    def _stopped(self, job: Job) -> Ended:
        if job.cancelled:
            return Ended(replace(job.snapshot(), status="cancelled"))
        limit = self._settings.max_seconds
        return failed(job, Message("run.too-slow", seconds=limit, share=job.progress))


def completed(snapshot: Snapshot, result: Result, spec: ResolvedExperiment) -> Finished:
    """Return the outcome of a run that has a result."""
    return Finished(replace(snapshot, status="done", progress=1.0, summary=summarise(result, spec)), result)


def failed(job: Job, why: Message) -> Ended:
    """Return the outcome of a run that has no result."""
    return Ended(replace(job.snapshot(), status="failed", problem=problem(500, why)))
