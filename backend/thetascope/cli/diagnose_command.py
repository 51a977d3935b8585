"""`thetascope diagnose`: find the faults in a record of a plant."""

import argparse
import sys
from pathlib import Path

import numpy as np

from thetascope.assembly.analyses.record_diagnosis import diagnose_recording, recording
from thetascope.assembly.analyses.record_inspection import recording_in
from thetascope.cli.inspect_command import assumed, inspected_record, mapping_of_options
from thetascope.cli.terminal import number, table
from thetascope.cli.words import Words
from thetascope.diagnosis.recording import Recording
from thetascope.engine.errors import SpecError
from thetascope.records.inspection import Inspected
from thetascope.runs.specs.plant_files import plant_named
from thetascope.runs.specs.refusals import from_engine, validated
from thetascope.settings import load
from thetascope_schemas.experiment.diagnosis import Alarm, DiagnosisSettings, ObserverDiagnosis
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.record_inspection import ColumnMapping

_HEAD = ("alarm-at", "fault", "alternatives", "since", "blank", "size", "blank", "cleared")


def diagnose_command(options: argparse.Namespace, say: Words) -> int:
    """Diagnose a recorded file; print the findings, and write them to a file if requested."""
    plant = plant_named(options.plant, load().max_body)
    given = {"false_alarms": options.false_alarms, "doubt": options.doubt}
    settings = validated(DiagnosisSettings, {k: v for k, v in given.items() if v is not None})
    try:
        columns = columns_of(*recording_of(plant, options.data, mapping_of_options(options), say))
        diagnosis = diagnose_recording(plant, recording(plant, columns), settings, options.learn)
    except SpecError as error:
        raise from_engine(error) from None
    if options.json is not None:
        options.json.write_text(diagnosis.model_dump_json(indent=1), encoding="utf-8")
    print(text(diagnosis, say))
    return 0


def recording_of(plant: Plant, path: Path, mapping: ColumnMapping, say: Words) -> tuple[Inspected, Recording]:
    """Return the recording in a file and what was found in it; print what is assumed on standard error."""
    inspected = inspected_record(plant, path, mapping)
    try:
        found = recording_in(inspected)
    except SpecError as error:
        raise from_engine(error) from None
    for line in assumed(inspected, say):
        print(line, file=sys.stderr)
    return inspected, found


def columns_of(inspected: Inspected, found: Recording) -> dict[str, np.ndarray]:
    """Return the columns of a recording that the file has, by the plant's names."""
    columns = {"t": found.t}
    prefixes = {"input": "u", "signal": "signal", "output": "y"}
    for values, roles in ((found.u, ("input", "signal")), (found.y, ("output",))):
        taken = [t for t in inspected.mapping.taken if t.quantity.role in roles]
        for k, t in enumerate(taken):
            if t.column is not None:
                columns[f"{prefixes[t.quantity.role]}.{t.quantity.name}"] = values[:, k]
    return columns


def text(diagnosis: ObserverDiagnosis, say: Words) -> str:
    """Return the findings as a table, then the basis of the decisions."""
    parts = [say.text(diagnosis.sentence), ""]
    if diagnosis.alarms:
        parts += [table(say.head(_HEAD), [_alarm(alarm, say) for alarm in diagnosis.alarms]), ""]
    parts += [say("cli.diagnose.noise", output=n.output, std=number(n.estimated, 3)) for n in diagnosis.noise]
    if diagnosis.calibration is not None:
        c = diagnosis.calibration
        basis = {"rate": c.false_alarms, "seeds": c.seeds, "begin": c.from_time}
        parts.append(say("cli.diagnose.thresholds", **basis))
    if diagnosis.note:
        parts.append(say.text(diagnosis.note))
    if diagnosis.excitation is not None and diagnosis.excitation.text:
        parts.append(say("cli.diagnose.excitation", text=say.text(diagnosis.excitation.text)))
    return "\n".join(parts)


def _alarm(alarm: Alarm, say: Words) -> list[str]:
    """Return an alarm as a row of the table."""
    sized = alarm.size is not None
    return [
        number(alarm.t, 5),
        alarm.channel or say("cli.diagnose.unexplained", output=alarm.output),
        ", ".join(alarm.alternatives) or "–",
        number(alarm.onset, 5),
        say("report.interval", low=number(alarm.onset_from, 5), high=number(alarm.onset_to, 5)),
        number(alarm.size),
        say("report.interval", low=number(alarm.size_from), high=number(alarm.size_to)) if sized else "–",
        number(alarm.cleared, 5),
    ]
