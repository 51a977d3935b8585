"""An inspection as it is sent: `RecordInspection`, and the curves of `RecordPreview`."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from thetascope.messages import Message
from thetascope.records.columns.mapping import Taken
from thetascope.records.columns.names import is_set_point, split_unit
from thetascope.records.columns.times import is_index
from thetascope.records.columns.units import choices
from thetascope.records.inspection import Inspected
from thetascope.records.table import Column
from thetascope.records.text.moments import NONE
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.experiment.measurement import ColumnMapping, QuantityMapping, TimeMapping
from thetascope_schemas.service.record_inspection import (
    MappedQuantity,
    PreviewSeries,
    RecordColumn,
    RecordFinding,
    RecordInspection,
    RecordPreview,
    RecordTimes,
    Role,
)

_MOST_CURVES = 40


@dataclass(frozen=True)
class About:
    """The file of a record: its id, if it is stored, name and size, and the id of the plant."""

    id: str
    name: str
    size: int
    plant: str


@np.errstate(over="ignore")  # columns may hold numbers of any size
def inspection_of(inspected: Inspected, about: About) -> RecordInspection:
    """Return an inspection in the form in which it is sent, with English sentences."""
    table = inspected.table
    base = f"/api/records/{about.id}"
    links = {"self": base, "mapping": f"{base}/mapping", "preview": f"{base}/preview"} if about.id else {}
    return RecordInspection(
        id=about.id,
        name=about.name,
        format=table.format,
        dialect=Text.of(table.dialect),
        size=about.size,
        rows=len(inspected.order.index),
        plant=about.plant,
        times=_times(inspected),
        columns=tuple(_column(column, place, inspected) for place, column in enumerate(table.columns, 1)),
        quantities=tuple(_quantity(taken, inspected) for taken in inspected.mapping.taken),
        mapping=mapping_document(inspected),
        findings=_findings(inspected),
        checked=tuple(map(Text.of, inspected.checked)),
        plant_text=_text(inspected.plant_text),
        problem=_text(inspected.problem),
        ready=inspected.recording is not None,
        links=links,
    )


def _text(message: Message | None) -> Text | None:
    return None if message is None else Text.of(message)


def _times(inspected: Inspected) -> RecordTimes | None:
    sampling, t = inspected.sampling, inspected.order.t
    if sampling is None:
        return None
    return RecordTimes(
        begin=inspected.begin,
        duration=float(t[-1] - t[0]),
        period=sampling.period,
        shortest=sampling.shortest,
        longest=sampling.longest,
        jitter=sampling.jitter,
        turned=inspected.order.turned,
    )


def _column(column: Column, place: int, inspected: Inspected) -> RecordColumn:
    """Return a column with its use, or why it is not used."""
    taken = next((t for t in inspected.mapping.taken if t.column == column.name), None)
    time = inspected.mapping.time.column == column.name
    written = split_unit(column.name)[1]
    values = column.values if column.kind == "number" else np.empty(0)
    values = values[~np.isnan(values)]
    kind = column.kind
    if kind == "number" and len(values):
        kind = "constant" if values.min() == values.max() else "index" if is_index(column.values) else "number"
    missing = np.count_nonzero(column.values == NONE) if column.kind == "datetime" else np.isnan(column.values).sum()
    if column.kind == "text":
        missing = len(column.values) - column.count
    role: Role = "time" if time else "unused" if taken is None else taken.quantity.role
    return RecordColumn(
        name=column.name,
        position=place,
        kind=kind,
        unit=written or column.unit,
        unit_from="head" if written else column.unit_from,
        first=column.first,
        low=float(values.min()) if len(values) else None,
        high=float(values.max()) if len(values) else None,
        missing=max(0, int(missing)),
        role=role,
        target=taken.quantity.name if taken is not None else "",
        note=None if time or taken is not None else Text.of(_unused(column, kind, inspected)),
    )


def _unused(column: Column, kind: str, inspected: Inspected) -> Message:
    """Return why a column is not used."""
    if kind in ("text", "empty", "index", "datetime"):
        return Message(f"record.unused.{kind}")
    if is_set_point(column.name):
        return Message("record.unused.set-point")
    if kind == "constant":
        return Message("record.unused.constant")
    return Message("record.unused.other" if inspected.mapping.taken else "record.unused.no-plant")


def _quantity(taken: Taken, inspected: Inspected) -> MappedQuantity:
    quantity = taken.quantity
    values = inspected.values.get(quantity.name, np.empty(0))
    values = values[~np.isnan(values)]
    proposal = next((f.proposal for f in inspected.findings if f.quantity == quantity.name and f.proposal), None)
    own = None if proposal is None else proposal["quantities"][quantity.name]
    return MappedQuantity(
        name=quantity.name,
        role=quantity.role,
        unit=quantity.unit,
        description=quantity.description,
        bounds=quantity.bounds,
        column=taken.column,
        column_unit=taken.unit,
        units=choices(quantity.unit),
        factor=taken.factor,
        offset=taken.offset,
        low=float(values.min()) if len(values) else None,
        high=float(values.max()) if len(values) else None,
        certain=taken.certain and own is None,
        reason=Text.of(taken.reason),
        proposal=None if own is None else QuantityMapping.model_validate(own),
    )


def mapping_document(inspected: Inspected) -> ColumnMapping:
    """Return the mapping that is in effect, from which the same one is made again."""
    time = inspected.mapping.time
    quantities = {}
    for taken in inspected.mapping.taken:
        if taken.column is None:
            quantities[taken.quantity.name] = QuantityMapping()
        elif taken.unit or not taken.quantity.unit:
            quantities[taken.quantity.name] = QuantityMapping(column=taken.column, unit=taken.unit)
        else:
            own = QuantityMapping(column=taken.column, factor=taken.factor, offset=taken.offset)
            quantities[taken.quantity.name] = own
    times = TimeMapping(column=time.column, unit=time.unit, period=time.period)
    return ColumnMapping(time=times, quantities=quantities)


def _findings(inspected: Inspected) -> tuple[RecordFinding, ...]:
    """Return the findings with ids that count those of a kind."""
    seen: Counter[str] = Counter()
    result = []
    for finding in inspected.findings:
        seen[finding.kind] += 1
        result.append(
            RecordFinding(
                id=f"{finding.kind}-{seen[finding.kind]}",
                kind=finding.kind,
                severity=finding.severity,
                quantity=finding.quantity,
                column=finding.column,
                count=finding.count,
                rows=finding.lines,
                times=finding.times,
                until=finding.until,
                text=Text.of(finding.text),
                treatment=_text(finding.treatment),
                proposal=finding.proposal,
            )
        )
    return tuple(result)


@np.errstate(over="ignore")
def preview_of(inspected: Inspected, intervals: int, in_file_units: bool = False) -> RecordPreview:
    """Return the smallest and largest values in equal intervals of time.

    Args:
        inspected: of a record with times; without a plant all columns of numbers are drawn.
        intervals: their number, at most that of the rows.
        in_file_units: whether values are the file's cells, else they are in the plant's units.
    """
    t = inspected.order.t
    if len(t) < 2:
        return RecordPreview(t=(), interval=0.0, steps={"low": (), "high": ()}, series=())
    count = max(1, min(intervals, len(t)))
    span = float(t[-1] - t[0])
    length = span / count
    bins = np.minimum(((t - t[0]) / span * count).astype(int), count - 1)
    curves = _of_quantities(inspected, in_file_units) if inspected.mapping.taken else _of_columns(inspected)
    series = []
    for name, role, column, unit, values in curves:
        low, high = _ends(values, bins, count)
        series.append(PreviewSeries(name=name, role=role, column=column, unit=unit, low=low, high=high))
    shortest, longest = _ends(np.append(np.diff(t), np.nan), bins, count)
    starts = tuple(float(t[0] + length * k) for k in range(count))
    return RecordPreview(t=starts, interval=length, steps={"low": shortest, "high": longest}, series=tuple(series))


Curve = tuple[str, Role, str | None, str, np.ndarray]
"""Name, use, column, unit and values of a curve."""


def _of_quantities(inspected: Inspected, in_file_units: bool) -> Iterator[Curve]:
    for taken in inspected.mapping.taken:
        values = inspected.values.get(taken.quantity.name)
        if values is None:
            continue
        if in_file_units and taken.factor:
            values = (values - taken.offset) / taken.factor
        unit = taken.unit if in_file_units else taken.quantity.unit
        yield taken.quantity.name, taken.quantity.role, taken.column, unit, values


def _of_columns(inspected: Inspected) -> Iterator[Curve]:
    columns = [c for c in inspected.table.columns if c.kind == "number" and c.name != inspected.mapping.time.column]
    for column in columns[:_MOST_CURVES]:
        unit = split_unit(column.name)[1] or column.unit
        yield column.name, "unused", column.name, unit, column.values[inspected.order.index]


def _ends(
    values: np.ndarray, bins: np.ndarray, count: int
) -> tuple[tuple[float | None, ...], tuple[float | None, ...]]:
    """Return the smallest and largest value in each interval, None where it has none."""
    good = ~np.isnan(values)
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, bins[good], values[good])
    np.maximum.at(high, bins[good], values[good])
    return tuple(None if np.isinf(v) else float(v) for v in low), tuple(None if np.isinf(v) else float(v) for v in high)
