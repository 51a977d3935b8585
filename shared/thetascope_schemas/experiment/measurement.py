"""Measurement of the outputs: noise, continuous or sampled; and the truth: where it differs from the model, or a record
in its place."""

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from thetascope_schemas.experiment.base import (
    MAX_STATES,
    ExpressionText,
    Name,
    NonNegative,
    Number,
    Positive,
    Prose,
    Reference,
    Strict,
    Unit,
    example,
)
from thetascope_schemas.experiment.plant import Plant, check_known, check_within
from thetascope_schemas.texts.refusal import refuse


class Noise(Strict):
    """Gaussian measurement noise of one output; each drawn value is held for the sample time."""

    model_config = example(std=0.001, sample_time=0.01)

    std: NonNegative = Field(description="Standard deviation, in the output's unit.")
    sample_time: Positive = Field(default=0.01, description="Time in s for which each drawn value is held.")


class ContinuousMeasurement(Strict):
    """Continuous measurement: observers see y(t) at all times."""

    model_config = example(mode="continuous")

    mode: Literal["continuous"] = "continuous"


class SampledMeasurement(Strict):
    """Sampled measurement: observers see y at 0, period, 2·period, …, held in between."""

    model_config = example(mode="sampled", period=0.1)

    mode: Literal["sampled"] = "sampled"
    period: Positive = Field(description="Sample period in s.")


class TrueState(Strict):
    """A state of the true plant that the model lacks."""

    model_config = example(name="valve", initial=0, unit="")

    name: Name = Field(description="Name in the expressions of the truth.")
    initial: Number = Field(default=0.0, description="Value at t = 0, in the state's unit.")
    unit: Unit = ""
    description: Prose = ""


class TrueSensor(Strict):
    """A sensor that differs from the model's: noise with memory, its own sample times, an unmodelled part."""

    model_config = example(correlation=0.5, period=0.1, missing=0.05, jitter=0.02, adds="0.1*valve")

    correlation: Positive | None = Field(
        default=None,
        description="Correlation time of the noise in s; its standard deviation stays as declared. Null: white noise.",
    )
    period: Positive | None = Field(
        default=None,
        description="Sample period in s, a multiple of the step; the value is held in between. Null: that of the "
        "measurement or, for missing or late samples of a continuous measurement, the sample time of the noise.",
    )
    missing: Annotated[float, Field(strict=True, ge=0, le=0.95, allow_inf_nan=False)] = Field(
        default=0.0, description="Share of samples that are lost; the value before is held."
    )
    jitter: NonNegative = Field(
        default=0.0,
        description="Samples are taken late by up to this time in s, evenly distributed, rounded to the step.",
    )
    adds: ExpressionText | None = Field(
        default=None, description="Expression that is added to the output's equation, in states of plant and truth."
    )

    def samples_every(
        self, noise: Noise | None, measurement: ContinuousMeasurement | SampledMeasurement, plant: Plant
    ) -> float | None:
        """Return the time in s between samples; None if the sensor has no sample times of its own, NaN if its samples
        are to be lost or late and nothing says how often they come."""
        if self.period is None and self.missing == 0 and self.jitter == 0:
            return None
        if self.period is not None:
            return self.period
        if plant.time.kind == "discrete":
            return plant.time.period
        if measurement.mode == "sampled":
            return measurement.period
        return noise.sample_time if noise else math.nan


# ---- a record in place of a simulated truth --------------------------------------------------------------------------

FitMode = Literal["auto", "never", "chosen"]
Course = Literal["held", "held-before", "linear"]
RecordId = Annotated[str, Field(pattern=r"^[0-9a-f]{32}$")]
ColumnName = Annotated[str, Field(max_length=200)]
TimeUnit = Literal[
    "s",
    "ms",
    "us",
    "ns",
    "min",
    "h",
    "d",
    "epoch-s",
    "epoch-ms",
    "epoch-us",
    "epoch-ns",
    "datetime",
    "clock",
    "spreadsheet-days",
]
"""A unit of time, or a kind of times: seconds since 1970 and parts of it, dates with times, times of day, and days
since the end of 1899 as spreadsheets count them."""
_TIME = {"column": "Time (s)", "unit": "s", "period": None}
_QUANTITY = {"column": "Level 1 (cm)", "unit": "cm", "factor": None, "offset": None}
COLUMN_MAPPING = {"time": _TIME, "quantities": {"y1": _QUANTITY}}
RECORD_SETTINGS = {"healthy": {"begin": 0.0, "end": 290.0}, "false_alarms": 0.01, "fit": "auto", "parameters": []}


class TimeMapping(Strict):
    """The times of the rows: a column, or a period for rows without one."""

    model_config = example(**_TIME)
    prose = frozenset()  # the unit changes the numbers

    column: ColumnName | None = Field(default=None, description="The column of times; null: none, the period is used.")
    unit: TimeUnit | None = Field(default=None, description="Unit of the column; null: the guess.")
    period: Positive | None = Field(
        default=None, description="Time in s from row to row, if there is no column of times."
    )


class QuantityMapping(Strict):
    """The column from which an input, signal or output of the plant is read."""

    model_config = example(**_QUANTITY)
    prose = frozenset()

    column: ColumnName | None = Field(default=None, description="Name of the column; null: the record has none.")
    unit: Unit | None = Field(
        default=None, description="Unit of the column; null: the one in the file, or the plant's."
    )
    factor: Number | None = Field(
        default=None, description="Instead of a unit: the plant's value is factor · cell + offset."
    )
    offset: Number | None = Field(default=None, description="See `factor`; null: 0.")


class ColumnMapping(Strict):
    """How columns become the time and the quantities of a plant; what is not given is guessed."""

    model_config = example(**COLUMN_MAPPING)

    time: TimeMapping | None = Field(default=None, description="The times; null: the guess.")
    quantities: dict[Reference, QuantityMapping] = Field(
        default_factory=dict,
        max_length=100,
        description="By name of an input, known signal or output of the plant; others are guessed.",
    )


class Stretch(Strict):
    """A part of the record, in s after its first row."""

    model_config = example(begin=0.0, end=290.0)

    begin: NonNegative = Field(description="Its beginning in s after the first row.")
    end: Positive = Field(description="Its end in s after the first row.")


class RecordSettings(Strict):
    """How a record is diagnosed."""

    model_config = example(**RECORD_SETTINGS)

    healthy: Stretch | None = Field(
        default=None,
        description="A stretch that is known to be healthy; null: the longest beginning that shows no fault by itself.",
    )
    false_alarms: Positive = Field(default=0.01, description="Accepted false alarms per hour.")
    fit: FitMode = Field(
        default="auto",
        description="auto: parameters are fitted on the healthy stretch where one alone lets the model fit clearly "
        "better; never; chosen: `parameters` are fitted.",
    )
    parameters: tuple[Reference, ...] = Field(
        default=(), max_length=100, description="With chosen: the parameters that are fitted; empty: all."
    )


class RecordedTruth(Strict):
    """A record that takes the place of the simulated plant and its sensors."""

    model_config = example(id="5f0c1a9e77b24d3c8a6f01234567890b", name="rig-7.csv", between="held")
    prose = frozenset({"name"})

    id: RecordId = Field(description="Id of the record: the beginning of the SHA-256 of its file.")
    name: Annotated[str, Field(max_length=200)] = Field(default="", description="Name of the file.")
    mapping: ColumnMapping = Field(default_factory=ColumnMapping, description="Changes of the guessed mapping.")
    settings: RecordSettings = Field(default_factory=RecordSettings, description="Settings of its diagnosis.")
    between: Course = Field(
        default="held",
        description="Inputs between two rows: those of the row before, those of the row after (written before they "
        "changed), or a straight line.",
    )
    fitted: tuple[Reference, ...] = Field(
        default=(),
        max_length=100,
        description="Those of the experiment's `parameters` that were fitted on this record: observers use them, and "
        "the diagnosis fits them again, from the plant's own values.",
    )

    def check(self, fields: Mapping[str, Any]) -> None:
        """Refuse fields of an experiment that would change the record, and fitted parameters that have no value."""
        for field in ("faults", "inputs", "signals", "commands"):
            if fields[field]:
                raise refuse("experiment.recorded", field, len(fields[field]), part=field)
        check_known(
            dict.fromkeys(self.fitted), list(fields["parameters"]), "truth.record.fitted", "plant.parameter.unknown"
        )


class Truth(Strict):
    """The true plant and its sensors, where they differ from the model that observers and the detector know."""

    model_config = example(
        deviation=0.02,
        parameters={"a4": 0.12},
        process_noise={"x1": 0.001},
        outputs={"y": {"correlation": 0.5}},
        states=[{"name": "valve"}],
        dynamics={"valve": "(u - valve)/0.5", "x1": "0.1*(valve - u)"},
    )
    optional = frozenset({"record"})

    deviation: Annotated[float, Field(strict=True, ge=0, le=0.5, allow_inf_nan=False)] = Field(
        default=0.0,
        description="Share by which every parameter that `parameters` does not name differs from the model, upwards or "
        "downwards by the seed, within its bounds.",
    )
    parameters: dict[Reference, Number] = Field(default_factory=dict, description="True values of parameters, by name.")
    process_noise: dict[Reference, NonNegative] = Field(
        default_factory=dict,
        description="Process noise by state: standard deviation per √s, in the state's unit.",
    )
    outputs: dict[Reference, TrueSensor] = Field(default_factory=dict, description="True sensors, by output.")
    states: tuple[TrueState, ...] = Field(
        default=(), max_length=MAX_STATES, description="States of the true plant that the model lacks."
    )
    dynamics: dict[Reference, ExpressionText] = Field(
        default_factory=dict,
        max_length=2 * MAX_STATES,
        description="Right-hand side of each of these states; for a state of the plant, an expression that is added to "
        "its right-hand side.",
    )

    record: RecordedTruth | None = Field(
        default=None, description="A record in place of the simulated plant; then nothing else of the truth is given."
    )

    @property
    def sample_periods(self) -> "Truth":
        """Return the part that the detector knows: which sensors have sample times of their own, and their periods."""
        sensors = {
            name: TrueSensor(period=sensor.period, missing=0.5 if sensor.missing or sensor.jitter else 0.0)
            for name, sensor in self.outputs.items()
            if sensor.period is not None or sensor.missing or sensor.jitter
        }
        return Truth(outputs=sensors)

    def check(
        self,
        plant: Plant,
        noise: Mapping[str, Noise],
        measurement: ContinuousMeasurement | SampledMeasurement,
        step: float,
        path: str = "truth",
    ) -> None:
        """Refuse unknown and repeated names, values outside their bounds, and sample times that do not fit.

        `step`: the integration step in s; `path`: path of the field.
        """
        if self.record is not None and Truth(record=self.record) != self:
            raise refuse("truth.record.alone", f"{path}.record", self.record.id)
        check_known(self.parameters, plant.names("parameters"), f"{path}.parameters", "plant.parameter.unknown")
        for item in plant.parameters:
            if item.name in self.parameters:
                check_within(self.parameters[item.name], item.bounds, f"{path}.parameters.{item.name}", item.name)
        taken = {name: field for field, name in plant.declared()}
        own = tuple(state.name for state in self.states)
        for index, name in enumerate(own):
            field = f"{path}.states[{index}].name"
            if name in taken:
                raise refuse("plant.name.repeated", field, name, name=name, by=taken[name])
            taken[name] = field
            if name not in self.dynamics:
                raise refuse("plant.state.no-equation", f"{path}.dynamics", name, state=name)
        states = (*plant.names("states"), *own)
        check_known(self.dynamics, states, f"{path}.dynamics", "truth.state.unknown")
        check_known(self.process_noise, states, f"{path}.process_noise", "truth.state.unknown")
        check_known(self.outputs, plant.names("outputs"), f"{path}.outputs", "plant.output.unknown")
        for name, sensor in self.outputs.items():
            if sensor.correlation is not None and name not in noise:
                field = f"{path}.outputs.{name}.correlation"
                raise refuse("truth.correlation.no-noise", field, sensor.correlation, output=name)
            period = sensor.samples_every(noise.get(name), measurement, plant)
            if period is not None:
                _check_samples(f"{path}.outputs.{name}", name, sensor, period, step)


def _check_samples(field: str, output: str, sensor: TrueSensor, period: float, step: float) -> None:
    """Refuse a sample period that is unknown or no multiple of the step, and samples that come later than the next."""
    if math.isnan(period):
        part, value = ("missing", sensor.missing) if sensor.missing else ("jitter", sensor.jitter)
        raise refuse("truth.period.unknown", f"{field}.{part}", value, output=output)
    count = period / step
    if round(count) < 1 or not math.isclose(count, round(count), rel_tol=1e-6):
        near = max(1, round(count)) * step
        raise refuse("experiment.time.no-multiple", f"{field}.period", period, time=period, step=step, near=near)
    if sensor.jitter >= period:
        raise refuse("truth.jitter.too-late", f"{field}.jitter", sensor.jitter, jitter=sensor.jitter, period=period)
