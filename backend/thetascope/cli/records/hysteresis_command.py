"""`thetascope hysteresis`: weights and thresholds of backlash operators from a record, as text of a plant."""

import argparse
from pathlib import Path

import numpy as np
import yaml

from thetascope.cli.terminal import number, table
from thetascope.cli.words import Words
from thetascope.engine.errors import SpecError
from thetascope.engine.estimation.hysteresis_fit import HysteresisFit, identify
from thetascope.messages import Message
from thetascope.records.readers.formats import read_table
from thetascope.records.table import MOST_BYTES, Table
from thetascope.runs.specs.refusals import from_engine, invalid
from thetascope.runs.specs.spec_files import DocumentError, unreadable
from thetascope_schemas.texts.refusal import suggestion


def hysteresis_command(options: argparse.Namespace, say: Words) -> int:
    """Print the operators that explain one column of a file by another; write them as text of a plant with --out."""
    read = _read(options.data)
    x, v = _column(read, options.input), _column(read, options.output)
    try:
        thresholds = _numbers(options.thresholds) if options.thresholds else None
        fit = identify(x, v, options.operators, thresholds)
    except SpecError as error:
        raise from_engine(error) from None
    head = [say(f"cli.hysteresis.{name}") for name in ("threshold", "weight", "deviation")]
    columns_of_fit = zip(fit.thresholds, fit.weights, fit.deviations, strict=True)
    print(table(head, [[number(value) for value in row] for row in columns_of_fit]))
    values = {name: number(getattr(fit, name)) for name in ("direct", "offset", "residual")}
    print(say("cli.hysteresis.rest", rows=fit.used, **values))
    if options.out is not None:
        options.out.write_text(plant_text(fit, options.input), encoding="utf-8")
        print(say("cli.hysteresis.written", name=str(options.out)))
    return 0


def plant_text(fit: HysteresisFit, x: str) -> str:
    """Return the operators as lines for a plant file: states of the memory, definitions up to v, and dynamics."""
    name = x.rsplit(".", 1)[-1]
    before, zs = f"{name}_before", [f"z{i + 1}" for i in range(len(fit.thresholds))]
    sizes = [repr(float(d)) for d in fit.thresholds]
    terms = [repr(fit.offset), f"{fit.direct!r}*{name}"]
    terms += [f"{float(w)!r}*{z}" for w, z in zip(fit.weights, zs, strict=True)]
    definitions = [
        {"name": z, "expression": f"backlash({name}, {name} - {before}, {z}_before, 1, 1, {d}, {d})"}
        for z, d in zip(zs, sizes, strict=True)
    ]
    parts = {
        "states": [{"name": before}, *({"name": f"{z}_before"} for z in zs)],
        "definitions": [*definitions, {"name": "v", "expression": " + ".join(terms)}],
        "dynamics": {before: name} | {f"{z}_before": z for z in zs},
    }
    return yaml.safe_dump(parts, sort_keys=False, allow_unicode=True, width=1000)


def _read(path: Path) -> Table:
    """Return the table of a file. Raises DocumentError."""
    try:
        if path.stat().st_size > MOST_BYTES:
            raise SpecError("file", path.name[-60:], Message("record.file.too-large", limit=MOST_BYTES // 1024**2))
        return read_table(path.name, path.read_bytes())
    except OSError as error:
        raise unreadable(path, error) from None
    except SpecError as error:
        raise DocumentError(error.problem, name=str(path), remedy=error.remedy) from None


def _column(read: Table, name: str) -> np.ndarray:
    """Return a column of numbers. Raises InvalidSpec for a name that the file lacks."""
    known = {column.name: column for column in read.columns}
    if name not in known:
        hint = Message.from_data(suggestion(name, known))
        raise invalid("column", name, Message("cli.hysteresis.no-column", name=name), hint)
    if known[name].kind != "number":
        raise invalid("column", name, Message("cli.hysteresis.no-numbers", name=name))
    return known[name].values


def _numbers(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",") if part.strip()]
    except ValueError:
        raise SpecError("thresholds", text[:80], Message("hysteresis.fit.thresholds")) from None
