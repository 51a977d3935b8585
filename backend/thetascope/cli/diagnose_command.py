"""`thetascope diagnose`: what was recorded on a plant, and which faults it shows."""

import argparse
from pathlib import Path

import numpy as np

from thetascope import library
from thetascope.assembly.analyses.csv_columns import columns_of_csv
from thetascope.assembly.analyses.record_diagnosis import diagnose_recording, recording
from thetascope.cli.terminal import number, table
from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.runs.specs.refusals import from_engine, validated
from thetascope.runs.specs.spec_files import DocumentError, read, unreadable
from thetascope.settings import load
from thetascope_schemas.experiment.diagnosis import DiagnosisSettings, ObserverDiagnosis
from thetascope_schemas.experiment.plant import Plant


def diagnose_command(options: argparse.Namespace) -> int:
    """Diagnose a recorded file and print, or write, what was found."""
    plant = plant_named(options.plant)
    asked = {"false_alarms": options.false_alarms, "doubt": options.doubt}
    settings = validated(DiagnosisSettings, {k: v for k, v in asked.items() if v is not None})
    try:
        found = diagnose_recording(plant, recording(plant, columns_of(options.data)), settings, options.learn)
    except SpecError as error:
        raise from_engine(error) from None
    if options.json is not None:
        options.json.write_text(found.model_dump_json(indent=1), encoding="utf-8")
    print(text(found))
    return 0


def plant_named(target: str) -> Plant:
    """A plant of the library, or of a file."""
    path = Path(target)
    if not path.suffix and not path.exists():
        return library.plant(target)
    return validated(Plant, read(path, load().max_body).data)


def columns_of(path: Path) -> dict[str, np.ndarray]:
    """The columns of a CSV file with a line of names. Raises DocumentError with the line that is no row of numbers."""
    try:
        return columns_of_csv(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise unreadable(path, error) from None
    except UnicodeDecodeError:
        raise DocumentError(Message("document.no-csv-utf8", name=str(path))) from None
    except SpecError as error:
        raise DocumentError(error.problem, name=str(path), remedy=error.remedy) from None


def text(found: ObserverDiagnosis) -> str:
    """What was found, as a table; then what it rests on."""
    parts = [found.sentence, ""]
    if found.alarms:
        rows = [
            [
                number(a.t, 5),
                a.channel or f"not explained ({a.output})",
                ", ".join(a.alternatives) or "–",
                number(a.onset, 5),
                f"{a.onset_from:.5g} to {a.onset_to:.5g}",
                number(a.size),
                "–" if a.size is None else f"{a.size_from:.4g} to {a.size_to:.4g}",
                number(a.cleared, 5),
            ]
            for a in found.alarms
        ]
        parts += [table(["ALARM AT", "FAULT", "OR AS WELL", "SINCE", "", "SIZE", "", "OVER AT"], rows), ""]
    parts += [f"noise of {n.output}: {number(n.estimated, 3)} (from the record)" for n in found.noise]
    if found.calibration is not None:
        c = found.calibration
        parts.append(
            f"thresholds for {c.false_alarms:g} false alarms an hour, from {c.seeds} simulated runs; judged from {c.from_time:.4g} s on"
        )
    if found.note:
        parts.append(found.note)
    if found.excitation is not None and found.excitation.text:
        parts.append(f"at the end: {found.excitation.text}")
    return "\n".join(parts)
