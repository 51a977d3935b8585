"""The detector in a live session: the one that diagnoses runs, over rows as they come."""

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
from thetascope.diagnosis.outcome.findings import WINDOW, alarm, detector_report
from thetascope.diagnosis.yield_points import Steps, run_to_end
from thetascope.engine.errors import Unwatchable
from thetascope.engine.observers.support.declaration import Context
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.engine.simulation.experiment import Rows, State
from thetascope.messages import Message
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.experiment.diagnosis import Alarm, DiagnosisSettings, InputProposal, ObserverDiagnosis
from thetascope_schemas.service.event import EventKind
from thetascope_schemas.service.session import DiagnosisNow, Event

_BATCHES_INSIDE = 8  # small batches of rows that wait until a larger one comes
_BATCHES_OUTSIDE, _ROWS_OUTSIDE = 256, 20_000  # that may wait for somebody else to test them
_ROUNDING = 1e-6  # of a decision
_SHARED = 16  # detectors kept for sessions on the same experiment
_detectors: OrderedDict[str, Detector] = OrderedDict()
_lock = Lock()


@dataclass(frozen=True)
class DetectorProgress:
    """How far a session's rows have been tested.

    Args:
        monitor: the detector's state after the last tested row.
        waiting: batches of rows still to be tested: (experiment, rows, values along them).
    """

    monitor: MonitorState
    waiting: tuple[tuple[Engine, Rows, dict], ...] = ()

    @property
    def rows(self) -> int:
        """How many rows wait."""
        return sum(len(rows.index) for _, rows, _ in self.waiting)

    def beginning(self, rows: int) -> "DetectorProgress":
        """Return the same with the first waiting batches only: at least one, and more up to `rows` rows."""
        count, total = 0, 0
        for _, batch, _ in self.waiting:
            total += len(batch.index)
            if count and total > rows:
                break
            count += 1
        return DetectorProgress(self.monitor, self.waiting[:count])

    def continues(self, earlier: "DetectorProgress") -> bool:
        """Return whether this is `earlier` with more rows waiting."""
        pairs = zip(self.waiting, earlier.waiting, strict=False)
        return (
            self.monitor is earlier.monitor
            and len(self.waiting) >= len(earlier.waiting)
            and all(a is b for a, b in pairs)
        )


@dataclass(frozen=True)
class LiveDetector:
    """The detector of one session.

    Args:
        detector: the detector, shared by sessions on the same experiment; None without a diagnosis.
        detector_settings: its settings.
        settings: the diagnosis settings of the spec.
        horizon: time that thresholds were simulated over, s.
        record: time between rows, s.
        note: why there is no detector.
    """

    detector: Detector | None
    detector_settings: DetectorSettings
    settings: DiagnosisSettings
    horizon: float
    record: float
    note: Message | None = None

    @classmethod
    def create(cls, spec: ResolvedExperiment, experiment: Engine, record: float) -> "LiveDetector":
        """Return the detector for a session on a spec that begins as `experiment`."""
        settings, wanted = spec.diagnosis, detector_settings(spec)
        if spec.truth.record is not None:
            return cls(None, wanted, settings, spec.horizon, record, Message("diagnosis.none.record"))
        whole = replace(experiment, steps=round(span(spec) / spec.step))
        note = unwatchable(whole, _context(experiment)) if settings.enabled else Message("diagnosis.none.disabled")
        detector = None
        if note is None:
            try:
                detector = _shared(spec, whole, wanted)
            except Unwatchable as error:
                note = error.reason
        return cls(detector, wanted, settings, span(spec), record, note)

    def begin(self) -> DetectorProgress | None:
        """Return the progress before the first row; None without a detector."""
        return DetectorProgress(self.detector.begin()) if self.detector else None

    def observe(
        self,
        progress: DetectorProgress | None,
        experiment: Engine,
        rows: Rows,
        values: dict,
        large: bool,
        outside: bool = False,
    ) -> tuple[DetectorProgress | None, list[Event]]:
        """Return the progress after new rows, and the alarms in them.

        Args:
            large: the batch is large, so no command waits for it and it is tested now; small ones wait.
            outside: rows are left to somebody else, who calls `catch_up`.
        """
        if progress is None:
            return None, []
        progress = DetectorProgress(progress.monitor, (*progress.waiting, (experiment, rows, values)))
        if outside:
            later = len(progress.waiting) <= _BATCHES_OUTSIDE and progress.rows <= _ROWS_OUTSIDE
        else:
            later = not large and len(progress.waiting) < _BATCHES_INSIDE
        if later:
            return progress, []
        after = run_to_end(self.catch_up(progress))
        return DetectorProgress(after), self.events(progress, after)

    def catch_up(self, progress: DetectorProgress) -> Steps[MonitorState]:
        """Return the detector's state after the rows that wait."""
        monitor = progress.monitor
        for experiment, rows, values in progress.waiting:
            monitor = yield from advance_over_rows(self._with_noise_of(experiment), monitor, experiment, rows, values)
        return monitor

    def judged_until(self, progress: DetectorProgress | None, t: float) -> float | None:
        """Return the time in s up to which rows have been judged; None if less than one decision is missing at t (s),
        or without a detector."""
        if progress is None or self.detector is None:
            return None
        until = progress.monitor.sums.last * self.detector.interval
        return until if t - until >= (1 - _ROUNDING) * self.detector.interval else None

    def events(self, progress: DetectorProgress, after: MonitorState) -> list[Event]:
        """Return the alarms in rows that waited; `after`: the detector's state after them."""
        return list(self._events(progress.monitor.decisions.findings, after.decisions))

    def _events(self, before: tuple[Finding, ...], after: DecisionState) -> Iterator[Event]:
        for i, finding in enumerate(after.findings):
            old = before[i] if i < len(before) else None
            if old is None:
                yield self._event(_as_raised(replace(finding, cleared=None)), i, finding.raised_at, "alarm")
            elif finding.channel != old.channel or (old.cleared is not None and finding.cleared is None):
                yield self._event(_as_raised(finding), i, after.at, "alarm")  # another fault, or active after all
            if finding.cleared is not None and (old is None or old.cleared is None):
                yield self._event(finding, i, finding.cleared, "alarm-over")

    def _event(self, finding: Finding, place: int, decision: int, kind: EventKind) -> Event:
        detector = self._required()
        data = alarm(finding, detector, self.settings.confidence, place)
        row = decision * detector.stride
        data["estimate"] = data["size"]
        data["sigma"] = None if finding.channel is None else finding.deviation
        subject = data["channel"] or data["output"].removeprefix("y.")
        message = data["text"] if kind == "alarm" else Message("event.alarm-over", fault=subject)
        return Event(
            row=row,
            t=row * self.record,
            kind=kind,
            subject=subject,
            observer="detector",
            value={name: list(v) if isinstance(v, tuple) else v for name, v in data.items() if name != "text"},
            message=Text.of(message),
        )

    def alarms(
        self, progress: DetectorProgress | None, until: float, known: dict[int, tuple[Finding, Alarm]]
    ) -> tuple[Alarm, ...]:
        """Return the alarms raised up to a time in s, in order of time, as they were at that time.

        Args:
            known: alarms by place, with the findings that they were made from; a cache that the caller keeps.
        """
        if progress is None or self.detector is None:
            return ()
        last = until / self.detector.interval + _ROUNDING
        alarms = []
        for place, finding in enumerate(progress.monitor.decisions.findings):
            if finding.raised_at > last:
                continue
            if finding.cleared is not None and finding.cleared > last:
                finding = replace(finding, cleared=None)
            if place not in known or known[place][0] != finding:
                data = alarm(finding, self.detector, self.settings.confidence, place)
                known[place] = finding, Alarm.model_validate(data)
            alarms.append(known[place][1])
        return tuple(sorted(alarms, key=lambda one: one.t))

    def propose_input(self, experiment: Engine, state: State) -> InputProposal:
        """Return an input that separates the observers' faults, from a state on.

        Raises:
            Unwatchable: there is no detector.
        """
        if self.detector is None:
            raise Unwatchable(self.note or Message("diagnosis.none.disabled"))
        among = tuple(dict.fromkeys(c for e in experiment.estimators for c in e.channels)) or None
        window, filter_ = WINDOW * self.horizon, self._with_noise_of(experiment).filter
        proposal = propose(filter_, experiment, state.plant, state.k, window, self.settings.accuracy, among, state.loop)
        return InputProposal.model_validate(vars(proposal))

    def report(self, progress: DetectorProgress | None, outside: bool) -> DiagnosisNow:
        """Return the diagnosis of all rows so far; rows that are left to somebody else (`outside`) are not waited
        for."""
        monitor = None
        if progress is not None:
            monitor = progress.monitor if outside else run_to_end(self.catch_up(progress))
        interval = self.detector.interval if self.detector else 0.0
        diagnosis = RunDiagnosis(self.detector, monitor, (), interval, self.note)
        data = detector_report(diagnosis, self.settings.confidence, self.settings.accuracy, self.horizon)
        return DiagnosisNow(diagnosis=ObserverDiagnosis.model_validate(data))

    def _with_noise_of(self, experiment: Engine) -> Detector:
        """Return the detector with the filter for an experiment whose noise may have been changed."""
        return with_noise_of(self._required(), experiment, self.detector_settings.doubt)

    def _required(self) -> Detector:
        if self.detector is None:
            raise TypeError("the session has no detector")
        return self.detector


def _as_raised(finding: Finding) -> Finding:
    """Return a finding with the size it was first reported with: an event must not depend on how rows are grouped."""
    size, deviation = finding.initial or (finding.size, finding.deviation)
    return replace(finding, size=size, deviation=deviation)


def with_fixed_span(spec: ResolvedExperiment) -> DiagnosisSettings:
    """Return the diagnosis settings with the present span, so that a run of a part of the session is judged alike."""
    return spec.diagnosis.model_copy(update={"span": span(spec)})


def without_windows(progress: DetectorProgress | None) -> DetectorProgress | None:
    """Return a progress for seeking far back: filter and decisions only. Windows of tests begin again there."""
    if progress is None:
        return None
    monitor = progress.monitor
    rest = len(monitor.t) - (monitor.sums.last - monitor.sums.first) * monitor.stride
    decisions = monitor.decisions
    bare = MonitorState(
        replace(decisions, start=max(decisions.start, monitor.sums.last), detected=None, tentative=None),
        monitor.sums.recent(1),
        monitor.states[-1:].copy(),
        monitor.table[len(monitor.t) - rest :].copy(),
        monitor.t[len(monitor.t) - rest :].copy(),
        monitor.stride,
    )
    return DetectorProgress(bare, progress.waiting)


def _shared(spec: ResolvedExperiment, whole: Engine, settings: DetectorSettings) -> Detector:
    """Return the detector for a spec, from those that are kept or a new one; `whole`: the experiment over its span."""
    key = calibration_key(spec)
    with _lock:
        detector = _detectors.get(key)
        if detector is not None:
            _detectors.move_to_end(key)
            return detector
    detector = run_to_end(prepare_detector(whole, _context(whole), settings, key))
    detector.prepare()
    with _lock:
        _detectors[key] = detector
        while len(_detectors) > _SHARED:
            _detectors.popitem(last=False)
    return detector


def _context(experiment: Engine) -> Context:
    """Return the context of the plant. A built experiment always has it."""
    if experiment.context is None:
        raise TypeError("the experiment has no context of its plant")
    return experiment.context
