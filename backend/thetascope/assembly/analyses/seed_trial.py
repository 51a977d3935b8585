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
from thetascope_schemas.experiment.diagnosis import Diagnosis

BAND = 3.0  # half width of a fixed band in standard deviations
LATEST = 400  # number of values from which tutorials compute the band


@dataclass(frozen=True)
class Raised:
    """An alarm of a decision rule: its time, and the channels that it names (none: not explained)."""

    t: float
    channels: tuple[str, ...]


@dataclass
class Tally:
    """The counts of a decision rule over all seeds: runs with alarms, faults found, alarms that name a wrong fault."""

    name: Message
    without: int = 0  # runs without faults that had an alarm
    before: int = 0  # runs with faults that had an alarm before the first fault
    found: dict[str, int] = field(default_factory=dict)  # by channel
    alternative: dict[str, int] = field(default_factory=dict)  # of these, named as an alternative
    wrong: int = 0
    delays: list[float] = field(default_factory=list)

    def count(self, alarms: list[Raised], faults: list[tuple[str, float]]) -> None:
        """Add a run with faults (channel, onset)."""
        first = min((at for _, at in faults), default=np.inf)
        self.before += any(a.t < first for a in alarms)
        for channel, onset in faults:
            hit = next((a for a in alarms if a.t >= onset and channel in a.channels), None)
            if hit is not None:
                self.found[channel] = self.found.get(channel, 0) + 1
                self.alternative[channel] = self.alternative.get(channel, 0) + (hit.channels[0] != channel)
                self.delays.append(hit.t - onset)
        self.wrong += sum(a.t >= first and not any(c in a.channels for c, at in faults if at <= a.t) for a in alarms)

    @property
    def delay(self) -> float | None:
        """Return the median delay in s of the faults found; None if none was found."""
        return float(np.median(self.delays)) if self.delays else None


@dataclass(frozen=True)
class Trial:
    """The tallies of all decision rules, in display order; faults as (channel, onset)."""

    seeds: int
    faults: list[tuple[str, float]]
    tallies: list[Tally]


def trial(
    prepared: Prepared, seeds: int, lock: float | None = None, progress: Callable[[float], None] | None = None
) -> Trial:
    """Run an experiment without timed commands ``seeds`` times with its faults and as often without.

    ``lock``: time in s at which a band of three standard deviations about each estimate is fixed, as in tutorials;
    leaving the band is an alarm.
    """
    spec = prepared.spec
    experiment = prepared.stages[0].experiment
    channel_faults = [f for f in spec.faults if f.site.kind == "channel" and 0 < f.onset < spec.horizon]
    faults = [(f.site.name, f.onset) for f in channel_faults]
    inspect = inspector(spec)
    plain = replace(healthy(experiment), estimators=experiment.estimators)
    tallies: dict[Message, Tally] = {}
    for k in range(seeds):
        for base, faulty in ((experiment, True), (plain, False)):
            result = run([Stage(0, with_seed(base, spec.seed + k))], inspect=inspect)
            for name, alarms in _ways(result, lock):
                tally = tallies.setdefault(name, Tally(name))
                if faulty:
                    tally.count(alarms, faults)
                else:
                    tally.without += bool(alarms)
        if progress is not None:
            progress((k + 1) / seeds)
    return Trial(seeds, faults, list(tallies.values()))


def _ways(result: Result, lock: float | None) -> Iterator[tuple[Message, list[Raised]]]:
    """Yield each decision rule with its alarms."""
    diagnosis = Diagnosis.model_validate(result.diagnosis) if result.diagnosis else None
    for own in (diagnosis.detector, *diagnosis.observers) if diagnosis else ():
        if own.calibration is not None:
            test = next(iter(own.calibration.thresholds))
            by_estimates = Message("trial.estimates", observer=own.observer, test=test)
            name = by_estimates if own.observer else Message("trial.detector")
            yield name, [Raised(a.t, (a.channel, *a.alternatives) if a.channel else ()) for a in own.alarms]
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
