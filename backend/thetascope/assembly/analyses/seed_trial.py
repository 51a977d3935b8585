"""Seed trial: run an experiment with many seeds, with and without its faults, and count how decision rules perform."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from thetascope.assembly.build.diagnosis_settings import inspector
from thetascope.assembly.build.prepare import Prepared
from thetascope.diagnosis.monitor.detector import healthy
from thetascope.engine.execution.run_experiment import run
from thetascope.engine.execution.stages import Stage
from thetascope.engine.model.result import Result
from thetascope.engine.simulation.batch import with_seed
from thetascope.messages import Message
from thetascope_schemas.experiment.diagnosis import Alarm, Diagnosis
from thetascope_schemas.experiment.faults import ChannelFault, StepFault

BAND = 3.0  # half width of a fixed band in standard deviations
LATEST = 400  # number of values from which tutorials compute the band


@dataclass(frozen=True)
class Raised:
    """An alarm of a decision rule: its time, and the channels that it names (none: not explained).

    ``onset`` and ``size`` are the intervals that it reports for its first channel, if any; ``estimate`` is its size.
    """

    t: float
    channels: tuple[str, ...]
    onset: tuple[float, float] | None = None
    size: tuple[float, float] | None = None
    estimate: float | None = None


@dataclass(frozen=True)
class TrueFault:
    """A fault of the experiment; ``size`` is None unless it is a step, and the only fault of its channel."""

    channel: str
    onset: float
    size: float | None
    end: float = np.inf


@dataclass
class Coverage:
    """How many reported intervals there were, and how many of them held the truth."""

    reported: int = 0
    held: int = 0

    def count(self, interval: tuple[float, float] | None, truth: float | None) -> None:
        """Add an interval if it is known and its truth is a number."""
        if interval is not None and truth is not None:
            self.reported += 1
            self.held += within(interval, truth)


def within(interval: tuple[float, float], truth: float) -> bool:
    """Return whether an interval holds the truth."""
    low, high = interval
    slack = 1e-9 * max(abs(low), abs(high))  # rounding of a bound that is exactly the truth
    return low - slack <= truth <= high + slack


@dataclass
class Tally:
    """The counts of a decision rule over all seeds: runs with alarms, faults found, alarms that name a wrong fault."""

    name: Message
    without: int = 0  # runs without faults that had an alarm
    false: int = 0  # alarms in runs without faults
    before: int = 0  # runs with faults that had an alarm before the first fault
    found: dict[str, int] = field(default_factory=dict)  # by channel
    alternative: dict[str, int] = field(default_factory=dict)  # of these, named as an alternative
    wrong: int = 0
    delays: list[float] = field(default_factory=list)
    size_errors: list[float] = field(default_factory=list)  # relative to the true size, without sign
    onset: Coverage = field(default_factory=Coverage)
    size: Coverage = field(default_factory=Coverage)

    def count(self, alarms: list[Raised], faults: list[TrueFault]) -> None:
        """Add a run with faults. Sizes and intervals are those of the last alarm that names the fault first."""
        first = min((f.onset for f in faults), default=np.inf)
        self.before += any(a.t < first for a in alarms)
        for fault in faults:
            channel, onset = fault.channel, fault.onset
            present = (a for a in reversed(alarms) if onset <= a.t < fault.end)
            last = next((a for a in present if a.channels[:1] == (channel,)), None)
            if last is not None:
                self.onset.count(last.onset, onset)
                self.size.count(last.size, fault.size)
                if last.estimate is not None and fault.size:
                    self.size_errors.append(abs(last.estimate / fault.size - 1))
            hit = next((a for a in alarms if a.t >= onset and channel in a.channels), None)
            if hit is not None:
                self.found[channel] = self.found.get(channel, 0) + 1
                self.alternative[channel] = self.alternative.get(channel, 0) + (hit.channels[0] != channel)
                self.delays.append(hit.t - onset)
        self.wrong += sum(
            a.t >= first and not any(f.channel in a.channels for f in faults if f.onset <= a.t) for a in alarms
        )

    @property
    def delay(self) -> float | None:
        """Return the median delay in s of the faults found; None if none was found."""
        return float(np.median(self.delays)) if self.delays else None


@dataclass(frozen=True)
class Trial:
    """The tallies of all decision rules, in display order."""

    seeds: int
    faults: list[TrueFault]
    tallies: list[Tally]


def trial(
    prepared: Prepared,
    seeds: int,
    lock: float | None = None,
    progress: Callable[[float], None] | None = None,
    watch: Callable[[Result], None] | None = None,
) -> Trial:
    """Run an experiment without timed commands ``seeds`` times with its faults and as often without.

    ``lock``: time in s at which a band of three standard deviations about each estimate is fixed, as in tutorials;
    leaving the band is an alarm. ``watch`` is called with every result, one with faults and one without in turn.
    """
    spec = prepared.spec
    experiment = replace(prepared.stages[0].experiment, record=None)
    channel_faults = [f for f in spec.faults if isinstance(f, ChannelFault) and 0 < f.onset < spec.horizon]
    faults = [_true_fault(f, sum(o.site == f.site for o in channel_faults)) for f in channel_faults]
    inspect = inspector(spec)
    plain = replace(healthy(experiment), estimators=experiment.estimators)
    tallies: dict[Message, Tally] = {}
    for k in range(seeds):
        for base, faulty in ((experiment, True), (plain, False)):
            result = run([Stage(0, with_seed(base, spec.seed + k))], inspect=inspect)
            if watch is not None:
                watch(result)
            for name, alarms in _ways(result, lock):
                tally = tallies.setdefault(name, Tally(name))
                if faulty:
                    tally.count(alarms, faults)
                else:
                    tally.without += bool(alarms)
                    tally.false += len(alarms)
        if progress is not None:
            progress((k + 1) / seeds)
    return Trial(seeds, faults, list(tallies.values()))


def _true_fault(fault: ChannelFault, of_its_channel: int) -> TrueFault:
    """Return a fault as the trial counts it."""
    size = fault.size if isinstance(fault, StepFault) and of_its_channel == 1 else None
    return TrueFault(fault.channel, fault.onset, size, np.inf if fault.end is None else fault.end)


def _ways(result: Result, lock: float | None) -> Iterator[tuple[Message, list[Raised]]]:
    """Yield each decision rule with its alarms."""
    diagnosis = Diagnosis.model_validate(result.diagnosis) if result.diagnosis else None
    for own in (diagnosis.detector, *diagnosis.observers) if diagnosis else ():
        if own.calibration is not None:
            test = next(iter(own.calibration.thresholds))
            by_estimates = Message("trial.estimates", observer=own.observer, test=test)
            name = by_estimates if own.observer else Message("trial.detector")
            yield name, [_raised(a) for a in own.alarms]
    if lock is not None:
        for report in result.observers:
            if any(n.startswith(f"{report.label}.sigma.") for n in result.names):
                band = {"observer": report.label, "t": lock}
                yield Message("trial.band.all", **band), _locked(result, report.label, lock)
                yield (
                    Message("trial.band.latest", **band, n=LATEST),
                    _locked(result, report.label, lock, "latest"),
                )
                if any(n.startswith(f"{report.label}.claimed.") for n in result.names):
                    yield (
                        Message("trial.band.claimed", **band),
                        _locked(result, report.label, lock, "claimed"),
                    )


def _raised(alarm: Alarm) -> Raised:
    """Return an alarm of the detector or of an observer with the intervals that it reports."""
    if not alarm.channel:
        return Raised(alarm.t, ())
    size = None if alarm.size_from is None or alarm.size_to is None else (alarm.size_from, alarm.size_to)
    channels = (alarm.channel, *alarm.alternatives)
    return Raised(alarm.t, channels, (alarm.onset_from, alarm.onset_to), size, alarm.size)


def _locked(result: Result, label: str, lock: float, way: Literal["all", "latest", "claimed"] = "all") -> list[Raised]:
    """Return the first time at which each estimate leaves mean ± 3 standard deviations of its values up to ``lock``.

    ``way``: "latest" uses only the last values and tests only upwards, as in tutorials; "claimed" uses the standard
    deviation that the observer's covariance claims at ``lock``, about the estimate.
    """
    t = result.column("t")
    row = int(np.searchsorted(t, lock))
    alarms = []
    for name in result.names:
        if name.startswith(f"{label}.theta."):
            estimate, channel = result.column(name), name.split(".", 2)[2]
            known = estimate[max(0, row - LATEST) : row] if way == "latest" else estimate[:row]
            mean, deviation = known.mean(), known.std()
            if way == "claimed":
                mean, deviation = estimate[row], result.column(f"{label}.claimed.{channel}")[row]
            off = estimate[row:] - mean
            out = np.flatnonzero((off if way == "latest" else np.abs(off)) > BAND * deviation)
            if len(out):
                alarms.append(Raised(float(t[row + out[0]]), (channel,)))
    return alarms
