"""What a study measures in one run, by column of its table."""

from collections.abc import Iterator, Mapping

import numpy as np

from thetascope.assembly.analyses.seed_trial import within
from thetascope.assembly.build.diagnosis_settings import findings
from thetascope.diagnosis.evaluation.metrics import event_times, settling, step_changes
from thetascope.diagnosis.evaluation.observer_comparison import DETECTOR, FOUND, error, judged
from thetascope.engine.model.result import Result
from thetascope.engine.programs.kernel_cost import operations
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.runs.results.measures import Readings, value_of
from thetascope_schemas.experiment.diagnosis import ObserverDiagnosis
from thetascope_schemas.experiment.experiment import ResolvedExperiment
from thetascope_schemas.experiment.faults import ChannelFault, StepFault
from thetascope_schemas.service.study.study import Study

Cell = float | int | str | None


def measured(study: Study, spec: ResolvedExperiment, engine: Engine, result: Result) -> dict[str, Cell]:
    """Return the measures of a run that the study asks for, and when the plant or an observer diverged."""
    cells: dict[str, Cell] = dict(_divergences(result))
    found = findings(result)
    for group in study.measures:
        if group in ("rmse", "peak"):
            cells |= dict(_errors(result, study.since, group))
        elif group == "settling":
            cells |= dict(_settling(result, spec))
        elif group == "operations":
            cells |= {f"operations.{e.label}": operations(e.program) for e in engine.estimators}
        else:
            for who, finding in found.items():
                cells |= dict(_detection(result, spec, who, finding))
    if study.numbers:
        readings = _readings(result, engine, found.get(DETECTOR))
        cells |= {f"number.{name}": value_of(measure, readings) for name, measure in study.numbers.items()}
    return cells


def _divergences(result: Result) -> Iterator[tuple[str, Cell]]:
    if result.diverged is not None:
        yield "diverged.plant", result.diverged.time
    for report in result.observers:
        if report.diverged is not None:
            yield f"diverged.{report.label}", report.diverged.time


def _errors(result: Result, since: float, group: str) -> Iterator[tuple[str, Cell]]:
    """Yield the root mean square or the largest error of each state and fault that an observer estimates."""
    t = result.column("t")
    rows = slice(int(np.searchsorted(t, since - 1e-9 * max(1.0, since))), None)
    for report in result.observers:
        for name in result.names:
            estimate = f"{report.label}.{name}"
            if name.startswith(("x.", "theta.")) and estimate in result.names:
                mean, peak = error(result.column(name)[rows], result.column(estimate)[rows])
                yield f"{group}.{estimate}", mean if group == "rmse" else peak


def _settling(result: Result, spec: ResolvedExperiment) -> Iterator[tuple[str, Cell]]:
    """Yield the seconds until each estimate stays within 10 % of the first step of its channel."""
    steps, events = step_changes(spec.faults, spec.horizon), event_times(spec.faults)
    for report in result.observers:
        first: dict[str, float | None] = {}
        for one in settling(result, report.label, steps, events):
            first.setdefault(one.channel, one.time)
        yield from ((f"settling.{report.label}.{channel}", value) for channel, value in first.items())


def _detection(
    result: Result, spec: ResolvedExperiment, who: str, finding: ObserverDiagnosis
) -> Iterator[tuple[str, Cell]]:
    """Yield counts of alarms, and for each fault whether, when and how it was found, by the rules of verdicts.py."""
    judgement = judged(result, spec.faults, who, finding)
    if judgement is None:
        return
    alarms = sorted(finding.alarms, key=lambda alarm: alarm.t)
    yield f"alarms.{who}", len(alarms)
    yield f"false.{who}", judgement.count("false")
    yield f"wrong.{who}", judgement.count("isolation-error")
    yield f"first.{who}", alarms[0].t if alarms else None
    yield f"name.{who}", alarms[0].channel if alarms else None
    seen: set[str] = set()
    for verdict in judgement.faults:
        if verdict.name in seen:
            continue  # the table has one column a channel: its first fault
        seen.add(verdict.name)
        yield f"found.{who}.{verdict.name}", int(verdict.outcome == FOUND)
        yield f"delay.{who}.{verdict.name}", verdict.delay
    for fault in spec.faults:
        if isinstance(fault, ChannelFault) and fault.channel in seen:
            seen.remove(fault.channel)
            yield from _size(who, fault, spec, finding)


def _size(
    who: str, fault: ChannelFault, spec: ResolvedExperiment, finding: ObserverDiagnosis
) -> Iterator[tuple[str, Cell]]:
    """Yield size and intervals of the last alarm that names a fault first, against the truth."""
    end = np.inf if fault.end is None else fault.end
    mine = [a for a in finding.alarms if a.channel == fault.channel and fault.onset <= a.t < end]
    if not mine:
        return
    last = max(mine, key=lambda alarm: alarm.t)
    yield f"onset_held.{who}.{fault.channel}", int(within((last.onset_from, last.onset_to), fault.onset))
    alone = sum(o.site == fault.site for o in spec.faults) == 1
    if last.size is None or not isinstance(fault, StepFault) or not alone:
        return
    yield f"size.{who}.{fault.channel}", last.size
    if fault.size:
        yield f"size_error.{who}.{fault.channel}", abs(last.size / fault.size - 1)
    if last.size_from is not None and last.size_to is not None:
        yield f"size_held.{who}.{fault.channel}", int(within((last.size_from, last.size_to), fault.size))


def _readings(result: Result, engine: Engine, finding: ObserverDiagnosis | None) -> Readings:
    gains: Mapping[str, Mapping[str, object]] = {
        e.label: {n.removeprefix("g."): v for n, v in e.parameters.items() if n.startswith("g.")}
        for e in engine.estimators
    }
    lost = {r.label: r.diverged.time for r in result.observers if r.diverged is not None}
    alarms = () if finding is None else tuple(finding.alarms)
    return Readings(result.column("t"), result.column, 0.0, alarms, lost, gains)
