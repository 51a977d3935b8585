"""`thetascope inspect`: list everything that is found in a record before anything is computed.

The options that change the mapping are those of `thetascope diagnose`, too.
"""

import argparse
from pathlib import Path

from thetascope.assembly.analyses.record_inspection import inspected_path
from thetascope.cli.terminal import number, table
from thetascope.cli.words import Words
from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.records.document import About, inspection_of
from thetascope.records.inspection import Inspected
from thetascope.runs.specs.plant_files import plant_named
from thetascope.runs.specs.refusals import from_engine, invalid, validated
from thetascope.runs.specs.spec_files import DocumentError, unreadable
from thetascope.settings import load
from thetascope_schemas.experiment.measurement import ColumnMapping
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.record_inspection import RecordColumn, RecordInspection

_HEAD = ("column", "first", "lowest", "highest", "use", "unit", "why")


def inspect_command(options: argparse.Namespace, say: Words) -> int:
    """Print the inspection of a file, or write it as JSON; the exit code is 1 if it cannot be diagnosed."""
    plant = plant_named(options.plant, load().max_body)
    inspected = inspected_record(plant, options.data, mapping_of_options(options))
    about = About("", options.data.name, options.data.stat().st_size, plant.id)
    document = inspection_of(inspected, about)
    if options.json is not None:
        options.json.write_text(document.model_dump_json(indent=1), encoding="utf-8")
    print(text(document, say))
    return 0 if document.ready else 1


def inspected_record(plant: Plant, path: Path, mapping: ColumnMapping) -> Inspected:
    """Return what is found in a file. Raises DocumentError for a file that cannot be read, InvalidSpec for options."""
    try:
        return inspected_path(plant, path, mapping)
    except OSError as error:
        raise unreadable(path, error) from None
    except SpecError as error:
        if error.field.startswith("mapping"):
            raise from_engine(error) from None
        raise DocumentError(error.problem, name=str(path), remedy=error.remedy) from None


def mapping_of_options(options: argparse.Namespace) -> ColumnMapping:
    """Return the changes of the mapping that the command line asks for. Raises InvalidSpec."""
    quantities: dict[str, dict[str, str]] = {}
    for field, texts in (("column", options.map), ("unit", options.unit)):
        for given in texts:
            name, sign, value = given.partition("=")
            if not sign or not name:
                raise invalid(f"--{'map' if field == 'column' else 'unit'}", given, Message("cli.mapping.form"))
            quantities.setdefault(name.strip(), {})[field] = value.strip()
    data: dict[str, object] = {"quantities": quantities}
    if options.time is not None or options.time_unit is not None or options.period is not None:
        data["time"] = {"column": options.time, "unit": options.time_unit, "period": options.period}
    return validated(ColumnMapping, data)


def text(document: RecordInspection, say: Words) -> str:
    """Return an inspection as text: the file, its columns, what was found, and what was looked for."""
    head = say("cli.inspect.file", name=document.name, rows=document.rows, dialect=say.text(document.dialect))
    parts = [head]
    if document.times is not None:
        times = document.times
        parts.append(say("cli.inspect.times", duration=times.duration, period=times.period))
    parts += ["", table(say.head(_HEAD), [_column(column, document, say) for column in document.columns]), ""]
    for quantity in document.quantities:
        if quantity.column is None:
            parts.append(f"{quantity.name}: {say.text(quantity.reason)}")
    for finding in document.findings:
        treatment = say.text(finding.treatment)
        parts.append(f"- {say.text(finding.text)}" + (f"; {treatment}" if treatment else ""))
    if not document.findings:
        parts.append(say("cli.inspect.nothing"))
    parts.append(say("cli.inspect.checked", list=[say.text(entry) for entry in document.checked]))
    if document.plant_text is not None:
        parts.append(say.text(document.plant_text))
    if document.problem is not None:
        problem = document.problem
        remedy = Message.from_data({"code": f"{problem.code}.remedy", "args": problem.args})
        parts += ["", say("cli.inspect.problem", problem=say.text(problem), remedy=say.text(remedy))]
    return "\n".join(parts)


def _column(column: RecordColumn, document: RecordInspection, say: Words) -> list[str]:
    """Return a column as a row of the table."""
    quantity = next((q for q in document.quantities if q.name == column.target), None)
    use, unit, why = "–", column.unit, say.text(column.note)
    if column.role == "time":
        use, unit, why = say("cli.inspect.time"), str(document.mapping.time and document.mapping.time.unit or ""), ""
    elif quantity is not None:
        use, unit, why = quantity.name, quantity.column_unit, say.text(quantity.reason)
        if quantity.column_unit != quantity.unit:
            unit = f"{quantity.column_unit} → {quantity.unit}"
        if not quantity.certain:
            why = say("cli.inspect.uncertain", reason=why)
    return [column.name, (*column.first, "–")[0], number(column.low, 5), number(column.high, 5), use, unit, why]


def assumed(inspected: Inspected, say: Words) -> list[str]:
    """Return in sentences what a diagnosis assumes about a record: doubtful columns, and cells that are changed."""
    lines = [
        say("cli.inspect.taken", name=t.quantity.name, column=t.column, reason=say.text(t.reason))
        for t in inspected.mapping.taken
        if t.column is not None and not t.certain
    ]
    for finding in inspected.findings:
        if finding.severity != "note":
            treatment = say.text(finding.treatment)
            lines.append(say.text(finding.text) + (f"; {treatment}" if treatment else ""))
    return lines
