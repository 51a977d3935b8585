"""The inspection of a record: its columns, what they are taken for, and everything found before anything is computed.

A file is uploaded (POST /api/records), inspected, mapped to the quantities of a plant (POST …/mapping), drawn
(GET …/preview), and diagnosed. Rows and columns are numbered as in the file, from 1 on.
"""

from typing import Any, Literal

from pydantic import Field, JsonValue

from thetascope_schemas.experiment.base import Flag, Number, Strict, example
from thetascope_schemas.experiment.diagnosis import MaybeSentence, Sentence
from thetascope_schemas.experiment.experiment import PlantChoice
from thetascope_schemas.experiment.measurement import (
    COLUMN_MAPPING,
    ColumnMapping,
    ColumnName,
    QuantityMapping,
)

Role = Literal["time", "input", "signal", "output", "unused"]
ColumnKind = Literal["number", "datetime", "text", "empty", "constant", "index"]
Severity = Literal["note", "changed", "doubtful", "wrong"]


def _text(code: str, text: str, **args: Any) -> dict[str, Any]:
    return {"code": code, "args": args, "text": text}


_COLUMN = {
    "name": "Level 1 (cm)",
    "position": 3,
    "kind": "number",
    "unit": "cm",
    "unit_from": "head",
    "first": ["36.05", "36.07", "36.04"],
    "low": 29.1,
    "high": 51.85,
    "missing": 3,
    "role": "output",
    "target": "y1",
    "note": None,
}
_TAKEN = {
    "name": "y1",
    "role": "output",
    "unit": "cm",
    "description": "level of tank 1",
    "bounds": [0, 60],
    "column": "Level 1 (cm)",
    "column_unit": "cm",
    "units": ["cm", "m", "mm"],
    "factor": 1.0,
    "offset": 0.0,
    "low": 29.1,
    "high": 51.85,
    "certain": True,
    "reason": _text("record.reason.same-name", "same name"),
    "proposal": None,
}
_FINDING = {
    "id": "gap-1",
    "kind": "gap",
    "severity": "note",
    "quantity": None,
    "column": "Time (s)",
    "count": 1,
    "rows": [1210],
    "times": [1209.0],
    "until": 1257.0,
    "text": _text("record.finding.gap", "a gap of 48 s from 1209 s on", length=48, t=1209),
    "treatment": _text("record.treatment.gap", "there are no rows: the filter predicts across it"),
    "proposal": None,
}


class MappingRequest(Strict):
    """The plant of a record, and what is to be changed in the guess."""

    model_config = example(plant="dts200", mapping={"time": None, "quantities": {}})

    plant: PlantChoice = Field(description="Id of a library plant, or a complete plant.")
    mapping: ColumnMapping = Field(default_factory=ColumnMapping, description="Changes of the guess.")


class RecordColumn(Strict):
    """A column of the file."""

    model_config = example(**_COLUMN)

    name: ColumnName = Field(description="Its name in the file, or col1, col2, … where the file has none.")
    position: int = Field(ge=1, description="Its place in the file, from 1 on.")
    kind: ColumnKind = Field(description="Its content; `constant` numbers never change, `index` counts the rows.")
    unit: str = Field(description="Its unit as the file writes it; empty: none is written.")
    unit_from: Literal["head", "second-line", "file", ""] = Field(
        description="Where the unit is written: in the name, in a line below, or in the file's metadata."
    )
    first: tuple[str, ...] = Field(description="Its first cells that are not empty, shortened.")
    low: Number | None = Field(description="Smallest number, sentinels included; null: there are no numbers.")
    high: Number | None = Field(description="Largest number; null: there are no numbers.")
    missing: int = Field(ge=0, description="Empty cells and cells such as NaN.")
    role: Role = Field(description="What it is used as.")
    target: str = Field(description="The plant's quantity that is read from it; empty: none.")
    note: MaybeSentence = Field(description="Why it is not used, or null.")


class MappedQuantity(Strict):
    """An input, known signal or output of the plant, and the column that it is read from."""

    model_config = example(**_TAKEN)

    name: str = Field(description="Its name in the plant.")
    role: Literal["input", "signal", "output"]
    unit: str = Field(description="Its unit in the plant.")
    description: str = Field(description="Its description in the plant.")
    bounds: tuple[Number | None, Number | None] = Field(description="Plausible range in the plant's unit.")
    column: ColumnName | None = Field(description="The column; null: the record has none.")
    column_unit: str = Field(description="The unit that its cells are taken to have.")
    units: tuple[str, ...] = Field(description="Units that can be chosen for its cells.")
    factor: Number = Field(description="The plant's value is factor · cell + offset.")
    offset: Number = Field(description="See `factor`.")
    low: Number | None = Field(description="Smallest value in the plant's unit, without sentinels.")
    high: Number | None = Field(description="Largest value in the plant's unit, without sentinels.")
    certain: Flag = Field(description="Whether names or written units give the column; else it should be looked at.")
    reason: Sentence = Field(description="Why this column and this unit, or why no column.")
    proposal: QuantityMapping | None = Field(description="Another mapping that would fit better, or null.")


class RecordFinding(Strict):
    """A peculiarity of the record, and how it is treated."""

    model_config = example(**_FINDING)

    id: str = Field(description="Id within the inspection.")
    kind: str = Field(description="Its kind: gap, jitter, repeated, reversed, sentinel, missing, frozen, …")
    severity: Severity = Field(
        description="note: nothing is changed; changed: rows or cells are; doubtful: probably a mistake; "
        "wrong: no diagnosis is possible."
    )
    quantity: str | None = Field(description="The plant's quantity that it concerns, or null.")
    column: ColumnName | None = Field(description="The column of the file that it concerns, or null.")
    count: int = Field(ge=0, description="Number of rows or cells.")
    rows: tuple[int, ...] = Field(description="The first few of these rows, as numbered in the file.")
    times: tuple[Number, ...] = Field(description="Their times in s, for marks in the picture.")
    until: Number | None = Field(description="Time in s at which it ends, if it is one stretch; else null.")
    text: Sentence = Field(description="The finding.")
    treatment: MaybeSentence = Field(description="What is done about it, or what to do.")
    proposal: JsonValue = Field(
        description="A part of a ColumnMapping that would remove it, such as {time: {unit: min}}, or null."
    )


class RecordTimes(Strict):
    """The times of a record in numbers."""

    model_config = example(
        begin="2024-03-01T08:00:00Z",
        duration=3599.0,
        period=1.0,
        shortest=0.85,
        longest=1.15,
        jitter=0.08,
        turned=False,
    )

    begin: str | None = Field(description="Date and time of the first row, if the file has dates.")
    duration: Number = Field(description="Time in s from the first to the last row.")
    period: Number = Field(description="Median of the times in s from row to row.")
    shortest: Number = Field(description="Shortest time in s from row to row.")
    longest: Number = Field(description="Longest time in s from row to row.")
    jitter: Number = Field(description="Usual deviation from the period, as a share of it.")
    turned: Flag = Field(description="Whether the rows were in reversed order.")


class RecordInspection(Strict):
    """A record as it was read: columns, mapping, peculiarities, and what was looked for and not found."""

    model_config = example(
        id="5f2b0c7a9d1e4f30a1b2c3d4e5f60718",
        name="rig-7.csv",
        format="csv",
        dialect=_text("record.dialect.csv", "commas, UTF-8", separator=",", encoding="UTF-8"),
        size=182344,
        rows=3553,
        plant="dts200",
        times={
            "begin": None,
            "duration": 3599.0,
            "period": 1.0,
            "shortest": 0.85,
            "longest": 48.0,
            "jitter": 0.08,
            "turned": False,
        },
        columns=[_COLUMN],
        quantities=[_TAKEN],
        mapping=COLUMN_MAPPING,
        findings=[_FINDING],
        checked=[_text("record.checked.frozen", "nothing is frozen")],
        plant_text=None,
        problem=None,
        ready=True,
        links={"self": "/api/records/5f2b0c7a9d1e4f30a1b2c3d4e5f60718"},
    )

    id: str = Field(description="Hash of the file; empty if it is not stored.")
    name: str = Field(description="Name of the file.")
    format: str = Field(description="Its format: csv, xlsx, parquet, …")
    dialect: Sentence = Field(description="Format, separator, encoding and the like.")
    size: int = Field(ge=0, description="Bytes of the file.")
    rows: int = Field(ge=0, description="Rows of data, after repeated ones were dropped.")
    plant: str = Field(description="Id of the plant; empty: none was chosen, and nothing is mapped.")
    times: RecordTimes | None = Field(description="The times; null: there is neither a column of times nor a period.")
    columns: tuple[RecordColumn, ...] = Field(description="All columns of the file in their order.")
    quantities: tuple[MappedQuantity, ...] = Field(
        description="The plant's inputs, signals and outputs, in this order."
    )
    mapping: ColumnMapping = Field(description="The mapping that is in effect, complete.")
    findings: tuple[RecordFinding, ...] = Field(description="What was found, in the order of time.")
    checked: tuple[Sentence, ...] = Field(description="What was looked for and not found.")
    plant_text: MaybeSentence = Field(
        description="How the record's length and period compare with the plant's time constants, or null."
    )
    problem: MaybeSentence = Field(description="Why the record cannot be diagnosed yet, or null.")
    ready: Flag = Field(description="Whether it can be diagnosed.")
    links: dict[str, str] = Field(default_factory=dict, description="Addresses of its parts.")


class PreviewSeries(Strict):
    """One curve for drawing: the smallest and largest value in each interval of time."""

    model_config = example(
        name="y1", role="output", column="Level 1 (cm)", unit="cm", low=[36.0, None], high=[36.1, None]
    )

    name: str = Field(description="The plant's quantity, or the name of an unused column.")
    role: Role
    column: ColumnName | None = Field(description="The column of the file.")
    unit: str = Field(description="Unit of the values.")
    low: tuple[Number | None, ...] = Field(description="Smallest value in each interval; null: it has no data.")
    high: tuple[Number | None, ...] = Field(description="Largest value in each interval; null: it has no data.")


class RecordPreview(Strict):
    """A record in intervals of time, for drawing."""

    model_config = example(
        t=[0.0, 1800.0],
        interval=1800.0,
        steps={"low": [0.85, 0.9], "high": [1.15, 48.0]},
        series=[
            {"name": "y1", "role": "output", "column": "Level 1 (cm)", "unit": "cm", "low": [36, 29], "high": [51, 51]}
        ],
    )

    t: tuple[Number, ...] = Field(description="Beginnings of the intervals in s.")
    interval: Number = Field(description="Length of an interval in s.")
    steps: dict[Literal["low", "high"], tuple[Number | None, ...]] = Field(
        description="Shortest and longest time in s from row to row in each interval."
    )
    series: tuple[PreviewSeries, ...]
