"""`thetascope diagnose`: find the faults in a record of a plant."""

import argparse
from pathlib import Path

import numpy as np

from thetascope import library
from thetascope.assembly.analyses.csv_columns import columns_of_csv
from thetascope.assembly.analyses.record_diagnosis import diagnose_recording, recording
from thetascope.cli.terminal import number, table
from thetascope.cli.words import Words
from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.runs.specs.refusals import from_engine, validated
from thetascope.runs.specs.spec_files import DocumentError, read, unreadable
from thetascope.settings import load
from thetascope_schemas.experiment.diagnosis import Alarm, DiagnosisSettings, ObserverDiagnosis
from thetascope_schemas.experiment.plant import Plant

_HEAD = ("alarm-at", "fault", "alternatives", "since", "blank", "size", "blank", "cleared")


def diagnose_command(options: argparse.Namespace, say: Words) -> int:
    """Diagnose a recorded file; print the findings, and write them to a file if requested."""
    plant = plant_named(options.plant)
    given = {"false_alarms": options.false_alarms, "doubt": options.doubt}
    settings = validated(DiagnosisSettings, {k: v for k, v in given.items() if v is not None})
    try:
        diagnosis = diagnose_recording(plant, recording(plant, columns_of(options.data)), settings, options.learn)
    except SpecError as error:
        raise from_engine(error) from None
    if options.json is not None:
        options.json.write_text(diagnosis.model_dump_json(indent=1), encoding="utf-8")
    print(text(diagnosis, say))
    return 0


def plant_named(target: str) -> Plant:
    """Return a plant of the library, or of a file."""
    path = Path(target)
    if not path.suffix and not path.exists():
        return library.plant(target)
    return validated(Plant, read(path, load().max_body).data)


def columns_of(path: Path) -> dict[str, np.ndarray]:
    """Return the columns of a CSV file with a header line. Raises DocumentError for a line that is not numbers."""
    try:
        return columns_of_csv(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise unreadable(path, error) from None
    except UnicodeDecodeError:
        raise DocumentError(Message("document.no-csv-utf8", name=str(path))) from None
    except SpecError as error:
        raise DocumentError(error.problem, name=str(path), remedy=error.remedy) from None


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
