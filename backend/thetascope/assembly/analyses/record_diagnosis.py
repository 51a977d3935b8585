"""Diagnose a recording of a plant: the answer of diagnosis/records as the schema that REST and the page show."""

from collections.abc import Callable, Mapping

import numpy as np
import orjson

from thetascope.assembly.analyses import record_words as words
from thetascope.assembly.analyses.record_curves import curves, statistic
from thetascope.assembly.analyses.record_inspection import inspected_file, recording_in
from thetascope.diagnosis.recording import Recording
from thetascope.diagnosis.records.diagnose import (
    AUTO,
    NEVER,
    NotIntegrable,
    RecordAnswer,
    RecordSettings,
    diagnose,
)
from thetascope.diagnosis.records.findings import Candidate, Estimate, RecordFault
from thetascope.diagnosis.records.fit_check import FitCheck
from thetascope.diagnosis.records.naming import EQUAL
from thetascope.diagnosis.sentences import joined
from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope_schemas import Plant
from thetascope_schemas.experiment.measurement import ColumnMapping
from thetascope_schemas.experiment.measurement import RecordSettings as Settings
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis, RecordFit

FEWEST_ROWS = 100  # of a record
_MORE = 1.5  # times the accepted rate: a larger promised one is mentioned
_STRONG = 4.0  # times the threshold: a fault that the healthy stretch does not cover counts only above it


def diagnose_file(name: str, data: bytes, plant: Plant, mapping: ColumnMapping, settings: Settings) -> RecordDiagnosis:
    """Return the diagnosis of a file. Raises SpecError as `inspected_file`, `recording_in` and `diagnose_recording`."""
    return diagnose_recording(plant, recording_in(inspected_file(name, data, plant, mapping)), settings)


def diagnose_columns(
    plant: Plant,
    columns: Mapping[str, np.ndarray | list],
    settings: Settings | None = None,
    mapping: ColumnMapping | None = None,
) -> RecordDiagnosis:
    """Return the diagnosis of columns by name, read as those of a file; raises as `diagnose_file`."""
    data, changes = columns_as_json(columns), mapping or ColumnMapping()
    return diagnose_file("record.json", data, plant, changes, settings or Settings())


def columns_as_json(columns: Mapping[str, np.ndarray | list]) -> bytes:
    """Return columns by name as the content of a JSON file."""
    return orjson.dumps({name: np.asarray(c).tolist() for name, c in columns.items()})


def fit_file(name: str, data: bytes, plant: Plant, mapping: ColumnMapping, settings: Settings) -> RecordFit:
    """Return the fit of a plant to the healthy stretch of a file; raises as `diagnose_file`."""
    recording = recording_in(inspected_file(name, data, plant, mapping))
    report, fitted = fitted_plant(plant, recording, settings)
    return RecordFit.model_validate({"report": report, "plant": fitted})


def diagnose_recording(
    plant: Plant, recording: Recording, settings: Settings, progress: Callable[[int], None] = lambda row: None
) -> RecordDiagnosis:
    """Return the diagnosis of a recording.

    Raises SpecError for a recording that is too short, for a plant with events or one that cannot be integrated along
    it, and for names of parameters that the plant does not have.
    """
    return RecordDiagnosis.model_validate(_report(plant, answer_of(plant, recording, settings, progress)))


def fitted_plant(plant: Plant, recording: Recording, settings: Settings) -> tuple[dict, Plant]:
    """Return the fit of a plant (the shape of FitReport), and the plant with the fitted parameters."""
    answer = answer_of(plant, recording, settings)
    fitted = {p.name: p.value for p in answer.parameters.parameters} if answer.parameters else {}
    data = plant.model_dump()
    for parameter in data["parameters"]:
        parameter["value"] = fitted.get(parameter["name"], parameter["value"])
    return _fit(plant, answer), Plant.model_validate(data)


def answer_of(
    plant: Plant, recording: Recording, settings: Settings, progress: Callable[[int], None] = lambda row: None
) -> RecordAnswer:
    """Return the answer of the engine's side; raises as `diagnose_recording`."""
    if len(recording) < FEWEST_ROWS:
        raise SpecError("t", len(recording), Message("record.too-short", rows=len(recording), least=FEWEST_ROWS))
    if plant.events:
        raise SpecError("plant.events", plant.events[0].when, Message("record.events"))
    names = plant.names("parameters")
    for i, name in enumerate(settings.parameters):
        if name not in names:
            field = f"settings.parameters.{i}"
            raise SpecError(field, name, Message("record.parameter.unknown", name=name, known=names))
    fit = {"auto": AUTO, "never": NEVER}.get(settings.fit, settings.parameters or tuple(names))
    stretch = settings.healthy
    if stretch is not None and stretch.begin >= min(stretch.end, float(recording.t[-1] - recording.t[0])):
        raise SpecError("settings.healthy.begin", stretch.begin, Message("record.healthy.outside"))
    given = None if stretch is None else (stretch.begin, stretch.end)
    engine_settings = RecordSettings(given, settings.false_alarms, fit)
    try:
        with np.errstate(all="ignore"):
            return diagnose(plant.model_dump(mode="json"), recording, engine_settings, progress)
    except NotIntegrable:
        raise SpecError("plant", plant.id, Message("record.not-integrable")) from None


def _report(plant: Plant, answer: RecordAnswer) -> dict:
    """Return the diagnosis as plain data."""
    faults = [_fault(plant, answer, fault, i) for i, fault in enumerate(answer.faults)]
    begin, end = answer.healthy
    return {
        "sentence": _summary(answer, faults),
        "fit": _fit(plant, answer),
        "healthy": {
            "begin": answer.begin,
            "end": _time(answer, end - begin - 1),
            "given": answer.given,
            "rows": end - begin,
        },
        "faults": faults,
        "missing": _missing(plant, answer, faults),
        "visible": [
            {
                "channel": channel.name,
                "unit": channel.unit,
                "smallest": float(smallest) if np.isfinite(smallest) else None,
                "typical": channel.typical,
            }
            for channel, smallest in zip(plant.channels, answer.smallest, strict=False)
        ],
        "decisions": [_decision(plant, answer, d) for d in answer.decisions],
        "threshold": answer.threshold or None,
        "false_alarms": answer.rate,
        "promised_false_alarms": answer.promised or None,
        "rows": len(answer.rows.t),
        "duration": float(answer.rows.t[-1] - answer.rows.t[0]),
        "statistic": statistic(answer),
        **curves(plant, answer),
        "between": answer.course,
        "notes": _notes(answer),
    }


def _time(answer: RecordAnswer, row: int) -> float:
    """Return the time of a row after the first judged one, in s."""
    return float(answer.rows.t[min(row, len(answer.rows.t) - 1)])


def _summary(answer: RecordAnswer, faults: list[dict]) -> Message:
    """Return the result in a sentence."""
    if not answer.fits:
        return Message("record.summary.misfit")
    confirmed = [f["text"] for f in faults if f["confirmed"]]
    if confirmed:
        return Message("record.summary.faults", faults=joined(confirmed))
    return Message("record.summary.none", end=float(answer.rows.t[-1]))


# ---- the fit -------------------------------------------------------------------------------------------------------


def _fit(plant: Plant, answer: RecordAnswer) -> dict:
    """Return the shape of FitReport."""
    check = answer.check
    reasons = [_reason(answer, finding) for finding in check.findings]
    suspects = [*check.suspects, *answer.suspects]
    verdict = "does-not-fit" if not answer.fits else "fits-after-fit" if answer.parameters else "fits"
    units = {p.name: p.unit for p in plant.parameters}
    noise = answer.noise
    steps = np.sqrt(noise.noise.q * np.median(answer.rows.width)) if noise else np.zeros(0)
    return {
        "verdict": verdict,
        "text": words.verdict_sentence(answer, [r["text"] for r in reasons]),
        "outputs": _outputs(plant, answer, check),
        "before": _outputs(plant, answer, answer.before) if answer.before else (),
        "reasons": reasons,
        "suspects": [
            {
                "kind": getattr(s, "kind", "parameter"),
                "name": s.name,
                "factor": s.factor if np.isfinite(s.factor) else None,
                "gain": s.gain,
                "simulated": getattr(s, "simulated", None),
                "text": words.suspect_sentence(s),
            }
            for s in suspects
        ],
        "parameters": [
            {
                "name": p.name,
                "unit": units[p.name],
                "before": p.before,
                "value": p.value,
                "std": p.std if np.isfinite(p.std) else None,
                "held": p.held,
            }
            for p in (answer.parameters.parameters if answer.parameters else ())
        ],
        "process_noise": {n: float(s) for n, s in zip(plant.names("states"), steps, strict=False)},
        "advice": words.advice(answer) if not answer.fits else (),
    }


def _outputs(plant: Plant, answer: RecordAnswer, check: FitCheck) -> list[dict]:
    """Return how well each output fits."""
    reports = []
    for k, (output, fit) in enumerate(zip(plant.outputs, check.outputs, strict=True)):
        memory = 0.0
        if answer.noise is not None and answer.noise.coloured:
            noise, period = answer.noise.noise, float(np.median(answer.rows.width))
            share = noise.s2[k] / (noise.s2[k] + noise.r[k])
            memory = float(share * np.exp(-noise.rate[k] * period))
        reports.append(
            {
                "output": output.name,
                "unit": output.unit,
                "predicted": fit.predicted,
                "simulated": fit.simulated if np.isfinite(fit.simulated) else None,
                "noise": fit.noise,
                "memory": memory,
                "innovation": fit.innovation,
                "bias": fit.bias,
                "whiteness": fit.whiteness,
                "text": words.output_sentence(output.name, fit),
            }
        )
    return reports


def _reason(answer: RecordAnswer, finding) -> dict:
    t = None if finding.row is None else float(answer.rows.t[min(finding.row, len(answer.rows.t) - 1)])
    return {"kind": finding.kind, "name": finding.name, "t": t, "text": words.reason_sentence(finding, t)}


# ---- faults --------------------------------------------------------------------------------------------------------


def _title(plant: Plant, answer: RecordAnswer, channel: int) -> tuple[str, str | Message, str]:
    """Return name, title and unit of a channel; an additive fault that the plant lacks has no name."""
    if channel < answer.model.own:
        c = plant.channels[channel]
        return c.name, c.title or c.name, c.unit
    target = answer.model.targets[channel - answer.model.own]
    outputs = {o.name: o.unit for o in plant.outputs}
    if target in outputs:
        return "", Message("record.fault.additive-output", target=target), outputs[target]
    unit = next(s.unit for s in plant.states if s.name == target)
    return "", Message("record.fault.additive-state", target=target), f"{unit}/s" if unit else "1/s"


def _interval(estimate: Estimate) -> dict:
    return {"value": estimate.value, "low": estimate.low, "high": estimate.high}


def _candidate(plant: Plant, answer: RecordAnswer, candidate: Candidate, ended: float | None) -> dict:
    name, title, unit = _title(plant, answer, candidate.event.channel)
    return {
        "channel": name,
        "title": title,
        "unit": unit,
        "shape": candidate.event.shape,
        "onset": _interval(candidate.onset),
        "size": _interval(candidate.size),
        "rate": candidate.rate,
        "bound": candidate.bound,
        "behind": candidate.behind,
        "separable": candidate.behind == 0 or candidate.behind > EQUAL,
        "text": words.candidate_sentence(candidate, title, unit, ended, float(answer.rows.t[-1])),
    }


def _fault(plant: Plant, answer: RecordAnswer, fault: RecordFault, place: int) -> dict:
    """Return a fault as plain data."""
    best = _candidate(plant, answer, fault.best, fault.ended)
    others = sorted(fault.others, key=lambda o: o.behind)
    equal = [_title(plant, answer, o.event.channel)[1] for o in others if o.behind <= EQUAL]
    covered = answer.covered(fault.best.event.onset)
    doubtful = not covered and fault.statistic < _STRONG * answer.threshold
    note = None
    if fault.best.size.holds_zero:
        note = Message("record.fault.holds-zero")
    elif doubtful:
        note = Message("record.fault.uncovered")
    elif equal:
        note = Message("record.fault.not-separable", others=equal)
    return {
        "id": f"fault-{place + 1}",
        "best": best,
        "alternatives": [_candidate(plant, answer, o, fault.ended) for o in others],
        "alarm": fault.alarm,
        "statistic": fault.statistic,
        "ended": fault.ended,
        "confirmed": fault.confirmed and not doubtful,
        "covered": covered,
        "text": best["text"],
        "note": note,
    }


def _missing(plant: Plant, answer: RecordAnswer, faults: list[dict]) -> list[dict]:
    """Return the faults that no channel of the plant explains."""
    missing = []
    for fault, data in zip(answer.faults, faults, strict=True):
        channel = fault.best.event.channel
        if channel >= answer.model.own:
            target = answer.model.targets[channel - answer.model.own]
            own = [o.behind for o in fault.others if o.event.channel < answer.model.own]
            part = "output" if target in plant.names("outputs") else "state"
            missing.append(
                {
                    "target": target,
                    "fault": data["id"],
                    "gain": min(own, default=fault.statistic),
                    "size": fault.best.size.value,
                    "unit": data["best"]["unit"],
                    "text": Message(f"record.missing.{part}", target=target),
                }
            )
    return missing


def _decision(plant: Plant, answer: RecordAnswer, decision) -> dict:
    event, t = decision.story.event, answer.rows.t
    return {
        "t": float(t[decision.row]),
        "statistic": decision.statistic,
        "judged": float(t[min(decision.judged, len(t)) - 1]),
        "action": "revised" if decision.revised else "added",
        "channel": _title(plant, answer, event.channel)[0],
        "onset": event.onset,
    }


def _notes(answer: RecordAnswer) -> list[Message]:
    """Return assumptions and limitations."""
    notes = []
    if answer.promised > _MORE * answer.rate:
        begin, end = answer.healthy
        notes.append(Message("record.note.promised", rate=answer.promised, asked=answer.rate, n=end - begin))
    if not answer.given and answer.fits:
        end = float(answer.rows.t[min(answer.healthy[1] - answer.healthy[0], len(answer.rows.t)) - 1])
        notes.append(Message("record.note.found-stretch", end=end))
    if answer.noise is not None and answer.noise.coloured:
        notes.append(Message("record.note.coloured"))
    gaps = int((answer.rows.extra_at >= 0).sum())
    if gaps:
        notes.append(Message("record.note.gaps", n=gaps))
    return notes
