"""The facts of a run or live session at one time: active observers, faults and noise, and verdicts on the detector."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from thetascope.assembly.build.timed_commands import after_commands
from thetascope.diagnosis.evaluation.summary_message import Situation, summary
from thetascope.diagnosis.evaluation.verdicts import Judgement, fault_ids
from thetascope.messages import Message
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.experiment.commands import AddObserver
from thetascope_schemas.experiment.diagnosis import Alarm, ObserverDiagnosis
from thetascope_schemas.service.comparison import AlarmOutcome, FaultOutcome
from thetascope_schemas.service.facts import Facts, FaultNow, ObserverLost, ObserverNow


@dataclass(frozen=True)
class DetectorState:
    """The detector's side of the facts.

    Attributes:
        alarms: up to the time of the facts, in order of time.
        judgement: the verdicts on them; None without a detector.
        diagnosis: its newest report: resolution of the channels, and the note if there is no detector.
        settled: time in s before which nothing is judged.
        note: why there is no detector; None or empty if there is one.
        judged: time in s up to which rows are judged; None: all are.
    """

    alarms: Sequence[Alarm] = ()
    judgement: Judgement | None = None
    diagnosis: ObserverDiagnosis | None = None
    settled: float = 0.0
    note: Message | Text | str | None = None
    judged: float | None = None


@dataclass(frozen=True)
class Losses:
    """Divergences: label → (time in s, likely cause), and the time at which the plant diverged."""

    observers: Mapping[str, tuple[float, Message]] = field(default_factory=dict)
    plant: float | None = None


def facts(spec: ResolvedExperiment, t: float, at: float, detector: DetectorState, losses: Losses) -> Facts:
    """Return the facts of an experiment (with its plant in full).

    Args:
        t: time in s of the last row.
        at: time in s at which faults and commands count as acting: t of a run; the next row of a session.
    """
    observers = observers_at(spec, at, losses.observers)
    judgement, present = detector.judgement, after_commands(spec, at)
    return Facts(
        t=t,
        observers=observers,
        faults=faults_at(spec, at),
        noise=present.noise,
        truth=present.truth,
        broken=losses.plant,
        alarms=tuple(detector.alarms),
        alarm_verdicts=tuple(AlarmOutcome(**vars(v)) for v in judgement.alarms) if judgement else (),
        fault_outcomes=tuple(FaultOutcome(**vars(v)) for v in judgement.faults) if judgement else (),
        undetected=tuple(p.ids[0] for p in judgement.undetected) if judgement else (),
        judged=detector.judged,
        summary=Text.of(summary(_situation(spec, t, detector, losses, observers))),
    )


def _situation(
    spec: ResolvedExperiment, t: float, detector: DetectorState, losses: Losses, observers: Sequence[ObserverNow]
) -> Situation:
    resolution = detector.diagnosis.resolution if detector.diagnosis else ()
    return Situation(
        t,
        detector.alarms,
        detector.judgement,
        Message.from_data(note.model_dump()) if isinstance(note := detector.note, Text) else note or "",
        detector.settled,
        frozenset(r.channel for r in resolution if not r.identifiable and not r.resolvable),
        {channel.name: channel.kind for channel in spec.plant.channels},
        len(observers),
        [(o.label, o.diverged.t) for o in observers if o.diverged],
        losses.plant,
        detector.judged,
    )


def observers_at(
    spec: ResolvedExperiment, at: float, lost: Mapping[str, tuple[float, Message]] | None = None
) -> tuple[ObserverNow, ...]:
    """Return the observers that run at a time in s, with their present gains.

    lost: label → time in s and cause of the divergence; observers restarted later do not count as diverged.
    """
    begun = {o.label: (o, 0.0) for o in spec.observers}
    for command in spec.commands:
        if isinstance(command, AddObserver) and command.at <= at:
            begun[command.observer.label] = command.observer, command.at
    answer = []
    for now in after_commands(spec, at).observers:
        config, since = begun[now.label]
        when = (lost or {}).get(now.label)
        ended = when is not None and when[0] >= since
        diverged = ObserverLost(t=when[0], cause=Text.of(when[1])) if when is not None and ended else None
        answer.append(
            ObserverNow(
                label=now.label,
                kind=now.kind,
                gains=now.gains,
                options={**now.options},
                config=config,
                since=since,
                diverged=diverged,
            )
        )
    return tuple(answer)


def faults_at(spec: ResolvedExperiment, at: float) -> tuple[FaultNow, ...]:
    """Return all faults of the experiment, and whether they act at a time in s."""
    return tuple(
        FaultNow(
            id=id,
            subject=fault.site.name,
            kind=fault.site.kind,
            shape=fault.shape,
            fault=fault,
            onset=fault.onset,
            end=fault.end,
            active=fault.onset <= at and (fault.end is None or fault.end > at),
            ended=fault.end is not None and fault.end <= at,
        )
        for id, fault in zip(fault_ids(spec.faults), spec.faults, strict=True)
    )
