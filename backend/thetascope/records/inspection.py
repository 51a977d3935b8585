"""Inspect a table beside a plant: the mapping, everything found, and the recording that observers get."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from thetascope.diagnosis.recording import Recording
from thetascope.messages import Message
from thetascope.records.columns.mapping import Mapping, Quantity, Taken, mapping_of
from thetascope.records.columns.times import seconds_of
from thetascope.records.defects.finding import Finding, Rows, lines_text
from thetascope.records.defects.plausibility import PlantFacts, doubtful_unit, foreign_unit, motionless, outside, pace
from thetascope.records.defects.readings import frozen, quantised, saturated, spikes
from thetascope.records.defects.row_order import Ordered, ordered
from thetascope.records.defects.sampling import Sampling, sampling_findings, sampling_of
from thetascope.records.defects.sentinels import sentinels
from thetascope.records.table import Table
from thetascope_schemas.experiment.measurement import ColumnMapping

LEAST_ROWS = 3
LARGEST = 1e30
"""Values beyond are no measurements."""
_KINDS = (
    *("no-time", "reversed", "unordered", "repeated", "gap", "jitter", "missing", "sentinel", "quantised", "frozen"),
    *("saturated", "spikes", "never-moves", "out-of-bounds", "outside-domain", "unit", "time-unit"),
)
"""Kinds of findings that are looked for in every record."""


@dataclass(frozen=True)
class Inspected:
    """A table as it is understood.

    Attributes:
        recording: rows for observers and detector, or None; then `problem` gives the reason.
        begin: the date of the first row, if there is one.
        values: by quantity, (rows,) in the plant's unit, without sentinels, inputs not held.
    """

    table: Table
    mapping: Mapping
    findings: tuple[Finding, ...]
    checked: tuple[Message, ...]
    order: Ordered
    sampling: Sampling | None
    begin: str | None
    values: dict[str, np.ndarray]
    recording: Recording | None
    problem: Message | None
    plant_text: Message | None


@dataclass
class _Work:
    """The rows in order, and what was found on the way."""

    table: Table
    rows: Rows
    index: np.ndarray
    findings: list[Finding] = field(default_factory=list)
    resolution: dict[str, float] = field(default_factory=dict)
    held: dict[str, np.ndarray] = field(default_factory=dict)


@np.errstate(over="ignore", invalid="ignore")  # numbers of any size; those beyond LARGEST become missing
def inspect(table: Table, quantities: Sequence[Quantity], facts: PlantFacts, asked: ColumnMapping) -> Inspected:
    """Return the mapping of a table to the quantities of a plant, its peculiarities, and its recording.

    Raises SpecError for a mapping that names unknown columns, units or quantities.
    """
    mapping = mapping_of(table, quantities, asked)
    seconds = seconds_of(table, mapping.time)
    used = [c for t in mapping.taken if (c := t.column) is not None]
    cells = np.stack([column.values for column in table.columns if column.name in used] or [seconds.t], axis=1)
    order = ordered(seconds.t, cells.astype(float), table.lines, mapping.time.column)
    rows = Rows(table.lines[order.index], order.t)
    work = _Work(table, rows, order.index, [*_notes(table), *order.findings])
    sampling, about = None, None
    timed = mapping.time.column is not None or mapping.time.period is not None
    if len(order.t) >= LEAST_ROWS and timed:
        sampling = sampling_of(order.t)
        work.findings += sampling_findings(rows, sampling, mapping.time.column)
        more, about = pace(facts, mapping.time, order.t, sampling)
        work.findings += more
    values = {taken.quantity.name: _values(taken, work, facts) for taken in mapping.taken if taken.column is not None}
    problem = _problem(mapping, work, timed)
    recording = None if problem else _recording(mapping, values, work, facts)
    kinds = {finding.kind for finding in work.findings}
    checked = tuple(Message(f"record.checked.{kind}") for kind in _KINDS if kind not in kinds and (quantities or timed))
    findings = tuple(sorted(work.findings, key=lambda f: (f.severity != "wrong", f.times[:1] or (-np.inf,))))
    return Inspected(
        table, mapping, findings, checked, order, sampling, seconds.begin, values, recording, problem, about
    )


def _notes(table: Table) -> list[Finding]:
    """Return what the reader did as findings."""
    findings = []
    for note, line in table.notes[:20]:
        kind = note.code.rpartition(".")[2]
        severity = "changed" if kind == "cut-off" else "note"
        args = dict(note.args) | {"line": line}
        findings.append(
            Finding(kind, severity, Message(note.code, **args), None, lines=(line,) if line else (), count=1)
        )
    return findings


def _values(taken: Taken, work: _Work, facts: PlantFacts) -> np.ndarray:
    """Return a quantity's values in the plant's unit, and add what is peculiar about them."""
    quantity, column = taken.quantity, work.table.named_as(taken.column or "")
    if column is None:
        raise KeyError(taken.column)
    cells = np.asarray(column.values, dtype=float)[work.index]
    if column.kind != "number":
        return np.full(len(work.index), np.nan)
    missing = np.isnan(cells)
    low, high = _in_cells(taken)
    flags = sentinels(cells, low, high)
    name, rows = quantity.name, work.rows
    if flags.any():
        marks = rows.marks(np.flatnonzero(flags))
        text = Message(
            "record.finding.sentinel",
            name=name,
            n=int(flags.sum()),
            values=[float(v) for v in np.unique(cells[flags])[:3]],
            lines=lines_text(rows.lines[flags]),
        )
        treatment = Message(f"record.treatment.{'held' if quantity.role != 'output' else 'missing'}")
        work.findings.append(Finding("sentinel", "changed", text, treatment, name, column.name, **marks))
    if missing.any():
        work.findings.append(_missing(taken, column.name, missing, work))
    values = np.where(flags, np.nan, cells) * taken.factor + taken.offset
    values = np.where(np.abs(values) < LARGEST, values, np.nan)
    work.findings += foreign_unit(taken) + outside(taken, values, rows)
    if not any(f.proposal for f in work.findings if f.quantity == name):
        expected = quantity.usual if quantity.role != "output" else facts.outputs.get(name)
        work.findings += doubtful_unit(taken, values, expected)
    work.findings += motionless(taken, values, rows)
    if quantity.role == "output":
        step, found = quantised(values, name, column.name, quantity.unit)
        work.resolution[name] = step
        work.findings += found
        full = saturated(values, rows, name, column.name, step)
        work.findings += full
        work.findings += frozen(values, rows, name, column.name, tuple(f.text.args["value"] for f in full))
        work.findings += spikes(values, rows, name, column.name)
    return values


def _in_cells(taken: Taken) -> tuple[float | None, float | None]:
    """Return the bounds of a quantity in the unit of its cells."""
    if taken.factor == 0:
        return None, None
    ends = [None if b is None else (b - taken.offset) / taken.factor for b in taken.quantity.bounds]
    return (ends[0], ends[1]) if taken.factor > 0 else (ends[1], ends[0])


def _missing(taken: Taken, name: str, missing: np.ndarray, work: _Work) -> Finding:
    """Return the finding of empty cells, with the words that are in them."""
    column = work.table.named_as(name)
    words = sorted({word for _, word in column.words})[:3] if column is not None else []
    marks = work.rows.marks(np.flatnonzero(missing))
    n = int(missing.sum())
    code = "record.finding.words" if words else "record.finding.missing"
    args = {"words": words} if words else {}
    text = Message(code, name=taken.quantity.name, n=n, lines=lines_text(work.rows.lines[missing]), **args)
    treatment = Message(f"record.treatment.{'held' if taken.quantity.role != 'output' else 'missing'}")
    return Finding("missing", "changed", text, treatment, taken.quantity.name, name, **marks)


def _problem(mapping: Mapping, work: _Work, timed: bool) -> Message | None:
    """Return why there is no recording, or None; missing inputs are findings."""
    if not mapping.taken:
        return Message("record.problem.no-plant")
    if not timed:
        return Message("record.problem.no-time")
    if any(finding.severity == "wrong" for finding in work.findings):
        return next(f.text for f in work.findings if f.severity == "wrong")
    for taken in mapping.taken:
        quantity = taken.quantity
        if taken.column is None and (quantity.role == "output" or quantity.controlled):
            return Message(
                f"record.problem.no-{'output' if quantity.role == 'output' else 'controlled'}", name=quantity.name
            )
        column = None if taken.column is None else work.table.named_as(taken.column)
        if column is not None and column.kind == "empty":
            return Message("record.problem.empty", name=quantity.name, column=column.name)
        if column is not None and column.kind != "number":
            row, word = column.words[0] if column.words else (0, (*column.first, "")[0])
            line = int(work.table.lines[row])
            return Message("record.problem.text", name=quantity.name, column=column.name, line=line, cell=word[:40])
    if len(work.index) < LEAST_ROWS:
        return Message("record.problem.too-short", rows=len(work.index), least=LEAST_ROWS)
    return None


def _recording(mapping: Mapping, values: dict[str, np.ndarray], work: _Work, facts: PlantFacts) -> Recording:
    """Return the rows of the plant's quantities; inputs that are missing are held, those without a column constant."""
    n = len(work.index)
    inputs, held, outputs = [], [], []
    for taken in mapping.taken:
        own = values.get(taken.quantity.name)
        if taken.quantity.role == "output":
            outputs.append(np.full(n, np.nan) if own is None else own)
            continue
        if own is None or np.isnan(own).all():
            _without_column(taken, work)
            signal = facts.signals.get(taken.quantity.name)
            t = work.rows.t - work.rows.t[0]
            own = np.full(n, taken.quantity.usual or 0.0) if signal is None else signal(t)
            held.append(np.ones(n, dtype=bool))
        else:
            missing = np.isnan(own)
            held.append(missing)
            own = _held(own, missing) if missing.any() else own
        inputs.append(own)
    stacked = [np.stack(parts, axis=1) if parts else np.empty((n, 0)) for parts in (inputs, outputs, held)]
    resolution = np.array(
        [work.resolution.get(t.quantity.name, 0.0) for t in mapping.taken if t.quantity.role == "output"]
    )
    return Recording(work.rows.t, stacked[0], stacked[1], stacked[2].astype(bool), resolution, work.rows.lines)


def _held(values: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """Return values in which each that is missing is the last one before it, or the first one there is."""
    last = np.maximum.accumulate(np.where(missing, -1, np.arange(len(values))))
    first = int(np.flatnonzero(~missing)[0])
    return values[np.where(last < 0, first, last)]


def _without_column(taken: Taken, work: _Work) -> None:
    quantity = taken.quantity
    text = Message(f"record.finding.no-{quantity.role}", name=quantity.name)
    if quantity.role == "signal":
        treatment = Message("record.treatment.default-signal")
    else:
        treatment = Message("record.treatment.default", value=quantity.usual or 0.0, unit=quantity.unit)
    work.findings.append(Finding("no-input", "doubtful", text, treatment, quantity.name, None))
