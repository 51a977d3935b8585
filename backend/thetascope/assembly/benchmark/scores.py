"""Scores of the detector and of every observer on benchmark problems, counted over seeds.

Each observer runs alone, with its default gains, on the runs of `trial`, and is judged by the tests on its estimates.
It estimates the channels that the experiment's own observers estimate, or all where it cannot. One that cannot be
built, that stops with an error, that diverges or that has no tests stays in the table, with the reason.
"""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from typing import Any

import numpy as np

from thetascope import library
from thetascope.assembly.analyses.seed_trial import Tally, Trial, trial
from thetascope.assembly.build.prepare import prepare
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.engine.observers.registry import kinds, observer
from thetascope.messages import Message
from thetascope_schemas import ObserverConfig, ResolvedExperiment

PROBLEMS = ("friction-motor", "quadruple-tank", "dts200", "cstr", "two-heaters", "hydraulic-servo", "pmsm")
DETECTOR = "detector"


@dataclass(frozen=True)
class Score:
    """One row: a problem and the detector, or an observer by its kind.

    Args:
        problem: id of the experiment.
        rule: DETECTOR, or the kind of observer.
        seeds: runs with faults, and as many without.
        faults: faults in a run.
        tally: the counts; None: nothing was counted, `note` says why.
        diverged: runs, of twice `seeds`, in which the observer or the plant left the finite numbers.
        cost: median processor time in s per simulated s; None for the detector.
        note: why there are no counts, or a failed assumption.
    """

    problem: str
    rule: str
    seeds: int
    faults: int
    tally: Tally | None = None
    diverged: int = 0
    cost: float | None = None
    note: Message | None = None


@dataclass(frozen=True)
class Job:
    """One row to compute. Jobs share nothing, so that their order and the number of workers change no count."""

    problem: str
    rule: str
    seeds: int


def scoreboard(
    problems: Sequence[str],
    seeds: int,
    rules: Sequence[str] = (),
    workers: int = 1,
    progress: Callable[[float], None] | None = None,
) -> list[Score]:
    """Return the rows of all problems, each with the detector first; `rules`: only these. Raises SpecError."""
    for problem in problems:
        library.experiment(problem)
    for rule in rules:
        if rule != DETECTOR:
            observer(rule)
    jobs = [Job(problem, rule, seeds) for problem in problems for rule in (rules or (DETECTOR, *kinds()))]
    scores: dict[Job, Score] = {}
    for job, one in _computed(jobs, workers):
        scores[job] = one
        if progress is not None:
            progress(len(scores) / len(jobs))
    return [scores[job] for job in jobs]


def _computed(jobs: Sequence[Job], workers: int) -> Iterator[tuple[Job, Score]]:
    if workers == 1:
        yield from ((job, score(job)) for job in jobs)
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        begun = {pool.submit(score, job): job for job in jobs}
        yield from ((begun[done], done.result()) for done in as_completed(begun))


def score(job: Job) -> Score:
    """Compute one row."""
    spec = library.resolve(library.experiment(job.problem))
    if job.rule == DETECTOR:
        return _counted(job, _with(spec, ()))
    refusal: SpecError | None = None
    for options in _options(spec):
        config = {"label": job.rule, "kind": job.rule, "options": options, "initial": _start(spec)}
        try:
            return _counted(job, _with(spec, (ObserverConfig.model_validate(config),)))
        except SpecError as error:
            refusal = error  # the last: without options, whose absence would otherwise be the reason
    assert refusal is not None
    why = Message("refusal.sentence", problem=refusal.problem, remedy=refusal.remedy)
    return Score(job.problem, job.rule, job.seeds, len(spec.faults), note=why)


def _with(spec: ResolvedExperiment, observers: tuple[ObserverConfig, ...]) -> ResolvedExperiment:
    return ResolvedExperiment.model_validate(dict(spec) | {"observers": observers, "figures": (), "commands": ()})


def _options(spec: ResolvedExperiment) -> list[dict[str, Any]]:
    """Return the options to try in turn: the channels of the experiment's observers, then the kind's own choice."""
    chosen = [dict(own.options)["channels"] for own in spec.observers if "channels" in dict(own.options)]
    return [{"channels": chosen[0]}, {}] if chosen else [{}]


def _start(spec: ResolvedExperiment) -> dict[str, float]:
    """Return the estimates with which the experiment's observers begin."""
    return dict(spec.observers[0].initial) if spec.observers else {}


def _counted(job: Job, spec: ResolvedExperiment) -> Score:
    """Run all seeds. Raises SpecError for an observer that cannot be built."""
    costs: list[float] = []
    failed: list[Message] = []
    diverged = 0

    def watch(result: Result) -> None:
        nonlocal diverged
        reports = [report for report in result.observers if report.label == job.rule]
        diverged += result.diverged is not None or any(report.diverged is not None for report in reports)
        costs.extend(result.costs[report.label] for report in reports if report.label in result.costs)
        failed.extend(check.name for report in reports for check in report.checks if check.verdict == "fails")

    counted = trial(prepare(spec), job.seeds, watch=watch)
    tally = _tally(counted, job.rule)
    note = Message("bench.fails", name=failed[0]) if failed else None
    if tally is None:
        note = Message("bench.no-tests")
    cost = float(np.median(costs)) if costs else None
    return Score(job.problem, job.rule, job.seeds, len(counted.faults), tally, diverged, cost, note)


def _tally(counted: Trial, rule: str) -> Tally | None:
    """Return the counts of the detector, or of the tests on the estimates of an observer."""
    code = "trial.detector" if rule == DETECTOR else "trial.estimates"
    return next((tally for tally in counted.tallies if tally.name.code == code), None)
