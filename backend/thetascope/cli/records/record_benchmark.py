"""`thetascope bench FOLDER`: the detector on recorded data with known faults, beside published scores."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from thetascope.assembly.analyses.record_diagnosis import diagnose_recording
from thetascope.assembly.analyses.record_inspection import recording_in
from thetascope.cli.records.inspect_command import inspected_record
from thetascope.diagnosis.evaluation.verdicts import FOUND, Judgement, judge, presences
from thetascope.engine.errors import SpecError
from thetascope.messages import Message, text_of
from thetascope.runs.specs.plant_files import plant_named
from thetascope.runs.specs.refusals import InvalidSpec, from_engine, invalid, validated
from thetascope.runs.specs.spec_files import DocumentError, read
from thetascope.settings import load
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.record_benchmark import BenchmarkRecord, RecordBenchmark, RecordedFault
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis, RecordFault

FILE = "benchmark.yaml"
RECORD_HEAD = (
    "record",
    "fault",
    "found",
    "delay",
    "size-error",
    "size-held",
    "onset-held",
    "false",
    "published",
    "note",
)
_PIECE = 1 << 20


@dataclass(frozen=True)
class FaultScore:
    """What was found of one known fault."""

    fault: RecordedFault
    found: bool
    delay: float | None
    size_error: float | None
    size_held: bool | None
    onset_held: bool | None


@dataclass(frozen=True)
class RecordScore:
    """The scores of one file; `note` says why there are none, or what the diagnosis says of the model."""

    record: BenchmarkRecord
    faults: tuple[FaultScore, ...] = ()
    false: int | None = None
    note: Message | str = ""


@dataclass(frozen=True)
class _Alarm:
    """A fault that a record shows, as the rules of verdicts see an alarm."""

    id: str
    t: float
    channel: str
    alternatives: tuple[str, ...]
    onset: float
    onset_from: float
    onset_to: float
    size: float | None
    size_from: float | None
    size_to: float | None
    cleared: float | None
    kind: str = "fault"
    output: str = ""


def scored(folder: Path, progress: Callable[[float], None]) -> list[RecordScore]:
    """Return the scores of all files of a folder with a `benchmark.yaml`. Raises DocumentError, InvalidSpec."""
    benchmark = validated(RecordBenchmark, read(folder / FILE, load().max_body).data)
    scores = []
    for k, record in enumerate(benchmark.records):
        _check_name(record.file, f"records[{k}].file")
        scores.append(_score(folder, record, k))
        progress((k + 1) / len(benchmark.records))
    return scores


def _check_name(name: str, field: str) -> None:
    if Path(name).name != name:
        raise invalid(field, name, Message("bench.record.outside"))


def _score(folder: Path, record: BenchmarkRecord, k: int) -> RecordScore:
    path = folder / record.file
    if not path.is_file():
        return RecordScore(record, note=Message("bench.record.missing"))
    found = _sha256(path)
    if found != record.sha256:
        return RecordScore(record, note=Message("bench.record.other", found=found[:16], wanted=record.sha256[:16]))
    plant = _plant(folder, record, k)
    try:
        recording = recording_in(inspected_record(plant, path, record.mapping))
        diagnosis = diagnose_recording(plant, recording, record.settings)
    except SpecError as error:
        return RecordScore(record, note=from_engine(error).text())
    except InvalidSpec as refused:
        return RecordScore(record, note=refused.text())
    except DocumentError as refused:
        return RecordScore(record, note=refused.problem)
    return judged(record, diagnosis)


def _plant(folder: Path, record: BenchmarkRecord, k: int) -> Plant:
    """Return the plant of a record, with all known faults among its channels."""
    file = folder / record.plant
    if file.suffix:
        _check_name(record.plant, f"records[{k}].plant")
    plant = plant_named(str(file) if file.suffix else record.plant, load().max_body)
    names = plant.names("channels")
    for i, fault in enumerate(record.faults):
        if fault.channel not in names:
            field = f"records[{k}].faults[{i}].channel"
            raise invalid(field, fault.channel, Message("bench.record.channel", name=fault.channel, names=list(names)))
    return plant


def judged(record: BenchmarkRecord, diagnosis: RecordDiagnosis) -> RecordScore:
    """Return the scores of a diagnosis by the rules of `verdicts`, with no grace: the detector has no estimates."""
    alarms = [_alarm(fault) for fault in diagnosis.faults]
    present = presences(record.faults, diagnosis.duration, lambda channel, start, end: True)
    own = {channel for alarm in alarms for channel in (alarm.channel, *alarm.alternatives)}
    own |= {fault.channel for fault in record.faults}
    judgement = judge(alarms, record.faults, present, own, 0.0)
    by_id = {alarm.id: alarm for alarm in alarms}
    faults = tuple(_of_fault(fault, judgement, by_id) for fault in record.faults)
    fits = diagnosis.fit.verdict != "does-not-fit"
    note = "" if fits else Message.from_data(diagnosis.fit.text.model_dump(include={"code", "args"}))
    return RecordScore(record, faults, judgement.count("false") + judgement.count("isolation-error"), note)


def _alarm(fault: RecordFault) -> _Alarm:
    best = fault.best
    others = tuple(one.channel for one in fault.alternatives if not one.separable)
    size = (best.size.value, best.size.low, best.size.high) if best.bound is None else (None, None, None)
    onset = (best.onset.value, best.onset.low, best.onset.high)
    return _Alarm(fault.id, fault.alarm, best.channel, others, *onset, *size, fault.ended)


def _of_fault(fault: RecordedFault, judgement: Judgement, alarms: dict[str, _Alarm]) -> FaultScore:
    verdict = next(
        (v for v in judgement.faults if (v.name, v.onset) == (fault.channel, fault.onset) and v.outcome == FOUND), None
    )
    if verdict is None:
        return FaultScore(fault, False, None, None, None, None)
    alarm = alarms[verdict.alarm]
    error = held = None
    if alarm.channel == fault.channel and fault.size and alarm.size is not None:
        error = abs(alarm.size / fault.size - 1)
        assert alarm.size_from is not None and alarm.size_to is not None
        held = alarm.size_from <= fault.size <= alarm.size_to
    return FaultScore(fault, True, verdict.delay, error, held, alarm.onset_from <= fault.onset <= alarm.onset_to)


def _sha256(path: Path) -> str:
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while piece := file.read(_PIECE):
            digest.update(piece)
    return digest.hexdigest()


# ---- the table -------------------------------------------------------------------------------------------------------


def score_records(scores: Sequence[RecordScore], language: str) -> list[dict[str, Any]]:
    """Return a flat dictionary for each known fault, and for each file without one."""
    rows = []
    for score in scores:
        said = score.note if isinstance(score.note, str) else text_of(score.note, language)
        published = "; ".join(_published(one) for one in score.record.published)
        known = score.faults or tuple(FaultScore(f, False, None, None, None, None) for f in score.record.faults)
        for one in known or (None,):
            done = score.false is not None and one is not None
            rows.append(
                {
                    "record": score.record.file,
                    "fault": None if one is None else one.fault.channel,
                    "onset_s": None if one is None else one.fault.onset,
                    "found": one.found if one is not None and done else None,
                    "delay_s": one.delay if one is not None else None,
                    "size_error": one.size_error if one is not None else None,
                    "size_held": one.size_held if one is not None else None,
                    "onset_held": one.onset_held if one is not None else None,
                    "false": score.false,
                    "published": published,
                    "note": said,
                }
            )
    return rows


def _published(score: Any) -> str:
    parts = [] if score.delay is None else [f"{score.delay:g} s"]
    parts += [] if score.found is None else ["✓" if score.found else "✗"]
    return f"{score.method} {' '.join(parts)} ({score.source})".replace("  ", " ")


def record_cells(scores: Sequence[RecordScore], language: str) -> list[tuple[str, ...]]:
    """Return the rows of the table under RECORD_HEAD."""
    return [_cells(row) for row in score_records(scores, language)]


def _cells(row: dict[str, Any]) -> tuple[str, ...]:
    def mark(value: bool | None) -> str:
        return "–" if value is None else ("✓" if value else "✗")

    fault = "–" if row["fault"] is None else f"{row['fault']} {row['onset_s']:g} s"
    delay = "–" if row["delay_s"] is None else f"{row['delay_s']:.3g}"
    error = "–" if row["size_error"] is None else f"{100 * row['size_error']:.2g} %"
    held = (mark(row["size_held"]), mark(row["onset_held"]))
    false = "–" if row["false"] is None else str(row["false"])
    return (
        row["record"],
        fault,
        mark(row["found"]),
        delay,
        error,
        *held,
        false,
        row["published"] or "–",
        row["note"] or "–",
    )
