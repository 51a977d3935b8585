"""`thetascope diagnose` and `thetascope fit`: find the faults in a record of a plant, and fit the plant to it."""

import argparse
import shlex
import sys

import yaml

from thetascope.assembly import RecordBytes, carry_out, prepare, record_experiment, with_rows
from thetascope.assembly.analyses.record_diagnosis import diagnose_recording, fitted_plant
from thetascope.assembly.analyses.record_inspection import recording_in
from thetascope.cli.records.inspect_command import assumed, inspected_record, mapping_of_options
from thetascope.cli.run_command import write
from thetascope.cli.terminal import number, table
from thetascope.cli.words import Words
from thetascope.diagnosis.recording import Recording
from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.runs.jobs.job import Job
from thetascope.runs.jobs.worker import completed
from thetascope.runs.results.summary import summarise
from thetascope.runs.specs.plant_files import plant_named
from thetascope.runs.specs.refusals import from_engine, invalid, validated
from thetascope.runs.specs.resolve_spec import resolved
from thetascope.settings import load
from thetascope.store import record_id
from thetascope_schemas import ObserverConfig
from thetascope_schemas.experiment.measurement import RecordSettings
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.record_diagnosis import FitReport, Interval, RecordDiagnosis, RecordFault, VisibleFault

_HEAD = ("alarm-at", "fault", "shape", "since", "blank", "size", "blank", "rate", "alternatives")
_PARAMETERS = ("parameter", "before", "fitted", "std")


def diagnose_command(options: argparse.Namespace, say: Words) -> int:
    """Diagnose a recorded file; print the findings, and write them to a file if requested.

    The exit code is 1 if the model does not fit, so that no fault could be named.
    """
    plant, recording, settings = _read(options, say)
    try:
        diagnosis = diagnose_recording(plant, recording, settings)
    except SpecError as error:
        raise from_engine(error) from None
    if options.json is not None:
        options.json.write_text(diagnosis.model_dump_json(indent=1), encoding="utf-8")
    if options.observer or options.out:
        _write_run(options, plant, settings, diagnosis, say)
    print(text(diagnosis, say))
    return 0 if diagnosis.fit.verdict != "does-not-fit" else 1


def _write_run(
    options: argparse.Namespace, plant: Plant, settings: RecordSettings, diagnosis: RecordDiagnosis, say: Words
) -> None:
    """Run observers on the record, and write the run to the files of the options."""
    data = options.data.read_bytes()
    file, id = RecordBytes(options.data.name, data, diagnosis), record_id(data)
    observers = [validated(ObserverConfig, {"label": kind, "kind": kind}) for kind in options.observer]
    try:
        spec, _ = record_experiment(id, file, plant, mapping_of_options(options), settings, observers)
        whole = with_rows(resolved(spec).with_readings(file))
        result = carry_out(prepare(whole))
    except SpecError as error:
        raise from_engine(error) from None
    finished = completed(Job(whole.spec_hash(), spec), result, summarise(result, whole))
    for path in options.out:
        kinds = [part for kind in options.observer for part in ("--observer", kind)]
        command = ["thetascope", "diagnose", options.plant, options.data.name, *kinds, "--out", path.name]
        write(finished, path, shlex.join(command), say.language)


def fit_command(options: argparse.Namespace, say: Words) -> int:
    """Fit parameters of a plant to the healthy stretch of a recorded file; write the fitted plant if requested.

    The exit code is 1 if the model does not fit with them either.
    """
    options.fit = options.parameters or "all"
    options.false_alarms = None
    plant, recording, settings = _read(options, say)
    try:
        report, fitted = fitted_plant(plant, recording, settings)
    except SpecError as error:
        raise from_engine(error) from None
    report = FitReport.model_validate(report)
    print("\n".join([*_fit(report, say), *_parameters(report, say)]))
    if options.out is not None:
        data = fitted.model_dump(mode="json", exclude_defaults=True)
        options.out.write_text(yaml.safe_dump(data, allow_unicode=True, sort_keys=False), encoding="utf-8")
    return 0 if report.verdict != "does-not-fit" else 1


def _read(options: argparse.Namespace, say: Words) -> tuple[Plant, Recording, RecordSettings]:
    """Return plant, recording and settings of the options; print what is assumed on standard error."""
    plant = plant_named(options.plant, load().max_body)
    settings = validated(RecordSettings, settings_of(options))
    inspected = inspected_record(plant, options.data, mapping_of_options(options))
    try:
        recording = recording_in(inspected)
    except SpecError as error:
        raise from_engine(error) from None
    for line in assumed(inspected, say):
        print(line, file=sys.stderr)
    return plant, recording, settings


def settings_of(options: argparse.Namespace) -> dict:
    """Return the settings as plain data. Raises InvalidSpec for a stretch that is not BEGIN..END."""
    data: dict = {}
    if options.healthy is not None:
        begin, dots, end = options.healthy.partition("..")
        try:
            data["healthy"] = {"begin": float(begin), "end": float(end)}
        except ValueError:
            raise invalid("--healthy", options.healthy, Message("cli.healthy.form")) from None
    if options.false_alarms is not None:
        data["false_alarms"] = options.false_alarms
    if options.fit in ("auto", "never"):
        data["fit"] = options.fit
    elif options.fit is not None:
        names = [] if options.fit == "all" else [n.strip() for n in options.fit.split(",") if n.strip()]
        data |= {"fit": "chosen", "parameters": names}
    return data


def text(diagnosis: RecordDiagnosis, say: Words) -> str:
    """Return the result in a sentence, how the model fits, the faults as a table, and the basis of the decisions."""
    parts = [say.text(diagnosis.sentence), "", *_fit(diagnosis.fit, say), *_parameters(diagnosis.fit, say)]
    if diagnosis.faults:
        parts += ["", table(say.head(_HEAD), [_fault(fault, say) for fault in diagnosis.faults])]
        parts += [
            f"{fault.best.channel or say.text(fault.best.title)}: {say.text(fault.note)}"
            for fault in diagnosis.faults
            if fault.note
        ]
    parts += [say.text(missing.text) for missing in diagnosis.missing]
    if diagnosis.threshold is not None:
        parts += ["", say("cli.diagnose.threshold", rate=diagnosis.false_alarms, threshold=diagnosis.threshold)]
        seen = [v for v in diagnosis.visible if v.smallest is not None]
        parts += [_smallest(v, say) for v in seen]
    parts += [say.text(note) for note in diagnosis.notes]
    return "\n".join(parts)


def _smallest(visible: VisibleFault, say: Words) -> str:
    """Return the smallest fault of a channel that would have been found."""
    text = say("cli.diagnose.smallest", channel=visible.channel, smallest=visible.smallest, unit=visible.unit)
    return text.replace("  ", " ")  # a channel without a unit


def _fit(fit: FitReport, say: Words) -> list[str]:
    """Return how the model fits, and what would help."""
    parts = [say.text(fit.text), *(f"  {say.text(o.text)}" for o in fit.outputs)]
    parts += [f"  {say.text(s.text)}" for s in fit.suspects[:3]]
    return parts + [say.text(a) for a in fit.advice]


def _parameters(fit: FitReport, say: Words) -> list[str]:
    """Return fitted parameters as a table."""
    rows = [
        [
            f"{p.name} [{p.unit}]" if p.unit else p.name,
            number(p.before, 6),
            say("cli.fit.held") if p.held else number(p.value, 6),
            "–" if p.held else number(p.std, 2),
        ]
        for p in fit.parameters
    ]
    return ["", table(say.head(_PARAMETERS), rows)] if rows else []


def _interval(interval: Interval, say: Words, digits: int = 4) -> str:
    return say("report.interval", low=number(interval.low, digits), high=number(interval.high, digits))


def _fault(fault: RecordFault, say: Words) -> list[str]:
    """Return a fault as a row of the table."""
    best = fault.best
    unit = f" {best.unit}" if best.unit else ""
    bound = best.bound is not None
    return [
        number(fault.alarm, 5),
        best.channel or say.text(best.title),
        say(f"cli.shape.{best.shape}"),
        number(best.onset.value, 5),
        _interval(best.onset, say, 5),
        say("cli.diagnose.bound", bound=best.bound) if bound else number(best.size.value) + unit,
        "–" if bound else _interval(best.size, say),
        number(best.rate) if best.rate else "–",
        ", ".join(a.channel for a in fault.alternatives if not a.separable) or "–",
    ]
