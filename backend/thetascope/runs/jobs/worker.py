"""Carry out jobs in worker processes: prepare (check, compile), compare the cost with the limits, run."""

import logging
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.messages import Message
from thetascope.runs.jobs.job import Ended, Finished, Job
from thetascope.runs.results.summary import summarise
from thetascope.runs.specs.problem_documents import problem
from thetascope.runs.specs.refusals import Busy, InvalidSpec, Refusal, from_engine, invalid
from thetascope.runs.workers import limits
from thetascope.runs.workers.child import Reporter
from thetascope.runs.workers.limits import Limits
from thetascope.runs.workers.pool import Workers
from thetascope.settings import Settings
from thetascope_schemas.experiment.experiment import ResolvedExperiment
from thetascope_schemas.service.run import RunSummary

if TYPE_CHECKING:
    from thetascope.assembly import Cost

log = logging.getLogger(__name__)

_LONG = 2_000_000
"""Steps of a run that takes long on any plant."""
_COPIES = 6
"""How many times the bytes of its result a run may need at its end, when columns are gathered and diagnosed."""
End = Callable[[Job, Ended | InvalidSpec], None]


def allow(spec: ResolvedExperiment, cost: "Cost", max_steps: int, max_result: int) -> None:
    """Refuse a run with more steps or numbers than the settings allow. Raises InvalidSpec with the figures."""
    if cost.steps > max_steps:
        raise invalid(
            "horizon",
            spec.horizon,
            Message("run.steps.over-limit", steps=cost.steps, limit=max_steps),
        )
    if cost.bytes > max_result:
        intervals = {"record": spec.record_interval, "evaluate": spec.evaluate_interval}
        field = min(intervals, key=lambda name: intervals[name])
        raise invalid(
            field,
            intervals[field],
            Message(
                "run.result.over-limit",
                rows=cost.rows,
                columns=cost.columns,
                bytes=cost.bytes,
                limit=max_result,
            ),
        )


def compute(
    reporter: Reporter, spec: ResolvedExperiment, max_steps: int, max_result: int, running: Limits
) -> tuple[Result, RunSummary]:
    """Carry out a run in a worker; return the result and its summary.

    The worker's limits hold until its kernels are compiled, `running` from then on.

    Raises:
        SpecError, InvalidSpec: the experiment is refused.
    """
    from thetascope.assembly import carry_out, prepare, with_rows  # imports SymPy

    spec = with_rows(spec)
    prepared = prepare(spec)
    allow(spec, prepared.cost, max_steps, max_result)
    begun = False

    def progress(share: float) -> None:
        nonlocal begun
        if not begun:
            reporter.other_limits(running)
        begun = True
        reporter.progress(share)

    result = carry_out(prepared, progress)
    return result, summarise(result, spec)


class Execution:
    """The runs in worker processes. `end` is called once for each started job, with its outcome."""

    def __init__(self, settings: Settings, workers: Workers, end: End) -> None:
        self._settings, self._workers, self._end = settings, workers, end
        seconds = settings.max_seconds
        self._running = Limits(seconds, seconds, settings.job_memory)

    def start(self, job: Job, spec: ResolvedExperiment) -> None:
        """Queue a job; `spec` is its experiment, resolved. Raises Busy."""
        settings = self._settings
        computation = self._workers.submit(
            compute,
            spec,
            settings.max_steps,
            settings.max_result,
            self._running,
            client=job.client,
            report=partial(self._reported, job),
            long=spec.horizon / spec.step * (spec.substeps or 1) > _LONG,
        )
        job.ends(computation.cancel)
        computation.result.add_done_callback(lambda done: self._ended(job, spec, done.exception() or done.result()))

    def _reported(self, job: Job, name: str, value: Any) -> None:
        if name == "limits":
            job.begin()
        elif name == "progress":
            job.report(value)

    def _ended(self, job: Job, spec: ResolvedExperiment, outcome: Any) -> None:
        """Turn the outcome of the computation into that of the job."""
        job.forget_computation()
        if isinstance(outcome, SpecError):
            self._end(job, from_engine(outcome, in_plant=True))
        elif isinstance(outcome, InvalidSpec):
            self._end(job, outcome)
        elif isinstance(outcome, limits.Ended) or isinstance(outcome, Busy) and job.cancelled:
            self._end(job, Ended(replace(job.snapshot(), status="cancelled")))
        elif isinstance(outcome, limits.LimitReached):
            self._fail(job, self._limit(job, outcome), 422)
        elif isinstance(outcome, Refusal):
            self._fail(job, outcome.problem)
        elif isinstance(outcome, BaseException):
            log.error("Run %s failed", job.id, exc_info=outcome)
            self._fail(job, Message("run.internal-error"))
        else:
            self._end(job, completed(job, *outcome))

    def _fail(self, job: Job, why: Message, status: int = 500) -> None:
        self._end(job, failed(job, why, status))

    def _limit(self, job: Job, reached: limits.LimitReached) -> Message:
        """Return which limit a run reached: once it has begun, in the words of runs."""
        code = reached.problem.code
        if code == "work.memory-limit":
            return Message("run.no-memory")
        if job.status == "running":
            return Message("run.too-slow", seconds=self._settings.max_seconds, share=job.progress)
        return reached.problem


def completed(job: Job, result: Result, summary: RunSummary) -> Finished:
    """Return the outcome of a run that has a result."""
    return Finished(replace(job.snapshot(), status="done", progress=1.0, summary=summary), result)


def failed(job: Job, why: Message, status: int = 500) -> Ended:
    """Return the outcome of a run that has no result."""
    return Ended(replace(job.snapshot(), status="failed", problem=problem(status, why)))
