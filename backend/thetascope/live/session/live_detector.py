"""The detector in a live session: the one that runs are diagnosed with, over rows as they come."""

from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass, replace
from threading import Lock

from thetascope.assembly.build.diagnosis_settings import calibration_key, detector_settings, span
from thetascope.diagnosis.input_design.input_proposal import propose
from thetascope.diagnosis.isolation.decision_state import DecisionState, Finding
from thetascope.diagnosis.monitor.detector import Detector, DetectorSettings, prepare_detector, unwatchable
from thetascope.diagnosis.monitor.monitor import MonitorState
from thetascope.diagnosis.outcome.diagnose_run import RunDiagnosis, advance_over_rows, with_noise_of
from thetascope.diagnosis.outcome.findings import WINDOW, alarm, of_detector
from thetascope.engine.errors import Unwatchable
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.engine.simulation.experiment import Rows, State
from thetascope_schemas import Experiment
from thetascope_schemas.experiment.diagnosis import Alarm, DiagnosisSettings, InputProposal, ObserverDiagnosis
from thetascope_schemas.service.session import DiagnosisNow, Event

_MOST_WAITING = 8  # pieces of rows that wait to be watched in passing
_MOST_PIECES, _MOST_ROWS = 256, 20_000  # that may wait for somebody else to watch them
_KEPT = 16  # detectors, shared by the sessions on the same experiment
_made: OrderedDict[str, Detector] = OrderedDict()
_lock = Lock()


@dataclass(frozen=True)
class DetectorProgress:
    """What was watched, and rows that wait to be: (experiment, rows, values along them)."""

    watched: MonitorState
    waiting: tuple[tuple[Engine, Rows, dict], ...] = ()

    @property
    def rows(self) -> int:
        """How many rows wait."""
        return sum(len(rows.index) for _, rows, _ in self.waiting)

    def follows(self, earlier: "DetectorProgress") -> bool:
        """Whether this is an earlier value with more rows waiting."""
        same = zip(self.waiting, earlier.waiting, strict=False)
        return (
            self.watched is earlier.watched
            and len(self.waiting) >= len(earlier.waiting)
            and all(a is b for a, b in same)
        )


@dataclass(frozen=True)
class LiveDetector:
    """What watches a session: the detector, or why there is none."""

    detector: Detector | None
    detector_settings: DetectorSettings
    settings: DiagnosisSettings
    horizon: float
    record: float
    note: str = ""

    @classmethod
    def create(cls, spec: Experiment, experiment: Engine, record: float) -> "LiveDetector":
        """For a session on a spec (with its plant in full) that begins as ``experiment``."""
        settings, wanted = spec.diagnosis, detector_settings(spec)
        note = (
            "none is asked for"
            if not settings.enabled
            else unwatchable(replace(experiment, steps=round(span(spec) / spec.step)), experiment.context)
        )
        made = None
        if not note:
            try:
                made = _shared(spec, experiment, wanted)
            except Unwatchable as error:
                note = str(error)
        return cls(made, wanted, settings, span(spec), record, note)

    def begin(self) -> "DetectorProgress | None":
        """Before the first row."""
        return DetectorProgress(self.detector.begin()) if self.detector else None

    def observe(
        self,
        seen: "DetectorProgress | None",
        experiment: Engine,
        rows: Rows,
        values: dict,
        now: bool,
        left: bool = False,
    ) -> tuple["DetectorProgress | None", list[Event]]:
        """The newest rows taken in, and what was found; unless ``now``, they wait: a command is not to be kept waiting.

        ``left``: somebody else is to watch them (`catch_up`).
        """
        if seen is None:
            return None, []
        seen = DetectorProgress(seen.watched, (*seen.waiting, (experiment, rows, values)))
        if left:
            later = len(seen.waiting) <= _MOST_PIECES and seen.rows <= _MOST_ROWS
        else:
            later = not now and len(seen.waiting) < _MOST_WAITING
        if later:
            return seen, []
        after = self.catch_up(seen)
        return DetectorProgress(after), self.events(seen, after)

    def events(self, seen: "DetectorProgress", after: MonitorState) -> list[Event]:
        """What was found in rows that waited."""
        return list(self._events(seen.watched.decisions.findings, after.decisions))

    def catch_up(self, seen: "DetectorProgress") -> MonitorState:
        """With the rows that waited."""
        watched = seen.watched
        for experiment, rows, values in seen.waiting:
            watched = advance_over_rows(
                with_noise_of(self.detector, experiment, self.detector_settings.doubt),
                watched,
                experiment,
                rows,
                values,
            )
        return watched

    def _events(self, before: tuple[Finding, ...], now: DecisionState) -> Iterator[Event]:
        for i, found in enumerate(now.findings):
            old = before[i] if i < len(before) else None
            if old is None:
                yield self._event(_as_named(replace(found, cleared=None)), i, found.raised_at, "alarm")
            elif found.channel != old.channel or (old.cleared is not None and found.cleared is None):
                yield self._event(
                    _as_named(found), i, now.at, "alarm"
                )  # it has got another name, or was not over after all
            if found.cleared is not None and (old is None or old.cleared is None):
                yield self._event(found, i, found.cleared, "alarm-over")

    def _event(self, found: Finding, place: int, decision: int, kind: str) -> Event:
        told = alarm(found, self.detector, self.settings.confidence, place)
        row = decision * self.detector.stride
        told["estimate"] = told["size"]
        told["sigma"] = None if found.channel is None else found.deviation
        subject = told["channel"] or told["output"].removeprefix("y.")
        text = told["text"] if kind == "alarm" else f"alarm over: {subject}"
        value = {k: list(v) if isinstance(v, tuple) else v for k, v in told.items() if k != "text"}
        return Event(
            row=row, t=row * self.record, kind=kind, subject=subject, observer="detector", value=value, text=text
        )

    def alarms(
        self, seen: "DetectorProgress | None", until: float, known: dict[int, tuple[Finding, Alarm]]
    ) -> tuple[Alarm, ...]:
        """Return the alarms raised up to a time in s, in order of time, as they were on at that time.

        known: alarms by place, with the findings that they were made of; a cache that the caller keeps.
        """
        if seen is None or self.detector is None:
            return ()
        last = (until + 1e-9) / self.detector.interval
        answer = []
        for place, finding in enumerate(seen.watched.decisions.findings):
            if finding.raised_at > last:
                continue
            if finding.cleared is not None and finding.cleared > last:
                finding = replace(finding, cleared=None)
            if place not in known or known[place][0] != finding:
                told = alarm(finding, self.detector, self.settings.confidence, place)
                known[place] = finding, Alarm.model_validate(told)
            answer.append(known[place][1])
        return tuple(sorted(answer, key=lambda one: one.t))

    def propose_input(self, experiment: Engine, state: State) -> InputProposal:
        """An input that tells the faults of the observers apart, from here on. Raises Unwatchable."""
        if self.detector is None:
            raise Unwatchable(self.note)
        made = with_noise_of(self.detector, experiment, self.detector_settings.doubt)
        among = tuple(dict.fromkeys(c for e in experiment.estimators for c in e.channels)) or None
        window = WINDOW * self.horizon
        found = propose(made.filter, experiment, state.plant, state.k, window, self.settings.accuracy, among)
        return InputProposal.model_validate(vars(found))

    def report(self, seen: "DetectorProgress | None", left: bool) -> DiagnosisNow:
        """The diagnosis as it stands; rows that are ``left`` to somebody else are not waited for."""
        watched = (seen.watched if left else self.catch_up(seen)) if seen else None
        found = RunDiagnosis(self.detector, watched, (), self.detector.interval if self.detector else 0.0, self.note)
        told = of_detector(found, self.settings.confidence, self.settings.accuracy, self.horizon)
        return DiagnosisNow(diagnosis=ObserverDiagnosis.model_validate(told))


def _as_named(found: Finding) -> Finding:
    """With the size that it was named with, whatever was found out since: an event does not depend on how rows come in."""
    size, deviation = found.initial or (found.size, found.deviation)
    return replace(found, size=size, deviation=deviation)


def pinned(spec: Experiment) -> DiagnosisSettings:
    """What is asked of the diagnosis, with the span that it has now: a run of a part of the session is judged alike."""
    return spec.diagnosis.model_copy(update={"span": span(spec)})


def bare(seen: DetectorProgress | None) -> DetectorProgress | None:
    """What is kept for going far back: where the filter and the decisions stand. Windows then begin anew."""
    if seen is None:
        return None
    watched = seen.watched
    rest = len(watched.t) - (watched.sums.last - watched.sums.first) * watched.stride
    now = watched.decisions
    left = MonitorState(
        replace(now, start=max(now.start, watched.sums.last), detected=None, tentative=None),
        watched.sums.recent(1),
        watched.states[-1:].copy(),
        watched.table[len(watched.t) - rest :].copy(),
        watched.t[len(watched.t) - rest :].copy(),
        watched.stride,
    )
    return DetectorProgress(left, seen.waiting)


def _shared(spec: Experiment, experiment: Engine, wanted: DetectorSettings) -> Detector:
    key = calibration_key(spec)
    with _lock:
        found = _made.get(key)
        if found is not None:
            _made.move_to_end(key)
            return found
    whole = replace(experiment, steps=round(span(spec) / spec.step))
    found = prepare_detector(whole, whole.context, wanted, key)
    found.prepare()
    with _lock:
        _made[key] = found
        while len(_made) > _KEPT:
            _made.popitem(last=False)
    return found
