"""Time functions: inputs u(t) and known signals φ(t). The value at a jump is the right limit."""

from itertools import pairwise
from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from thetascope_schemas.experiment.base import (
    MAX_POINTS,
    MAX_TIME,
    ExpressionText,
    NonNegative,
    Number,
    Positive,
    Seed,
    Strict,
    example,
)
from thetascope_schemas.texts.refusal import refuse

Points = Annotated[tuple[Number, ...], Field(min_length=1, max_length=MAX_POINTS)]
Start = Annotated[float, Field(strict=True, ge=-MAX_TIME, le=MAX_TIME, allow_inf_nan=False)]
Interpolation = Literal["hold", "linear"]


def check_increasing(times: tuple[float, ...], field: str = "times") -> None:
    """Refuse times that are not strictly increasing; the error names the first offending one."""
    for index, (before, after) in enumerate(pairwise(times)):
        if not before < after:
            raise refuse(
                "table.times.not-increasing", field, after, index=index, before=before, next=index + 1, after=after
            )


def check_lengths(times: tuple[float, ...], values: tuple[float, ...], more: int) -> None:
    """Refuse a table whose number of values is not the number of times plus `more`."""
    if len(values) != len(times) + more:
        counts = {"times": len(times), "needed": len(times) + more, "given": len(values)}
        code = "signal.steps.value-count" if more else "table.value-count"
        raise refuse(code, "values", len(values), **counts)


def check_width(width: float, period: float) -> None:
    """Refuse a pulse that does not end within its period."""
    if width > period:
        raise refuse("pulse.width.beyond-period", "width", width, width=width, period=period)


class ConstantSignal(Strict):
    """A constant value."""

    model_config = example(kind="constant", value=0.08)

    kind: Literal["constant"] = "constant"
    value: Number = Field(description="Value, in the signal's unit.")


class StepsSignal(Strict):
    """Piecewise constant: values[0] before times[0], values[i] from times[i-1] on."""

    model_config = example(kind="steps", times=[10, 20], values=[0.08, 0.02, 0.08])

    kind: Literal["steps"] = "steps"
    times: Points = Field(description="Times of the jumps in s, increasing.")
    values: Points = Field(description="Values, one more than times.")

    @model_validator(mode="after")
    def _consistent(self) -> "StepsSignal":
        check_increasing(self.times)
        check_lengths(self.times, self.values, more=1)
        return self


class PulseSignal(Strict):
    """`high` on [start + k·period, start + k·period + width) for k = 0, 1, …, otherwise `low`."""

    model_config = example(kind="pulse", low=0, high=1, period=0.5, width=0.25, start=0)

    kind: Literal["pulse"] = "pulse"
    low: Number = Field(default=0.0, description="Value outside the pulses.")
    high: Number = Field(default=1.0, description="Value within the pulses (may lie below `low`).")
    period: Positive = Field(description="Period in s.")
    width: Positive = Field(description="Length of one pulse in s, at most the period.")
    start: Number = Field(default=0.0, description="Start of the first pulse in s.")

    @model_validator(mode="after")
    def _consistent(self) -> "PulseSignal":
        check_width(self.width, self.period)
        return self


class SquareSignal(Strict):
    """Square wave: offset + amplitude on [start + k·period, start + (k + ½)·period), otherwise offset − amplitude."""

    model_config = example(kind="square", amplitude=0.01, period=12, start=0, offset=0.08)

    kind: Literal["square"] = "square"
    amplitude: Number = Field(description="Half the height of the jumps, in the signal's unit.")
    period: Positive = Field(description="Period in s.")
    start: Start = Field(default=0.0, description="Start of one of the upper halves in s.")
    offset: Number = Field(default=0.0, description="Mean value, in the signal's unit.")


class SineSignal(Strict):
    """offset + amplitude·sin(2π·frequency·t + phase)."""

    model_config = example(kind="sine", amplitude=5, frequency=1, phase=0, offset=0)

    kind: Literal["sine"] = "sine"
    amplitude: Number = Field(description="Amplitude, in the signal's unit.")
    frequency: NonNegative = Field(description="Frequency in Hz.")
    phase: Number = Field(default=0.0, description="Phase at t = 0 in rad.")
    offset: Number = Field(default=0.0, description="Mean value, in the signal's unit.")


class RampSignal(Strict):
    """`initial` until `start`, then rising by `slope` per second, constant from `end` on."""

    model_config = example(kind="ramp", start=5, slope=0.1, initial=0, end=15)

    kind: Literal["ramp"] = "ramp"
    start: Number = Field(default=0.0, description="Start of the ramp in s.")
    slope: Number = Field(description="Slope, in the signal's unit per s.")
    initial: Number = Field(default=0.0, description="Value until the start.")
    end: Number | None = Field(default=None, description="Time in s from which the value is constant; null: never.")

    @model_validator(mode="after")
    def _consistent(self) -> "RampSignal":
        if self.end is not None and self.end <= self.start:
            raise refuse("ramp.end.before-start", "end", self.end, end=self.end, start=self.start)
        return self


class ChirpSignal(Strict):
    """offset + amplitude·sin(2π(f0·τ + (f1−f0)·τ²/(2·duration))) with τ = t − start, for 0 ≤ τ < duration.

    Before `start` the frequency is f0, from start + duration on it is f1.
    """

    model_config = example(kind="chirp", amplitude=1, f0=0.1, f1=5, duration=60, offset=0)
    optional: ClassVar[frozenset[str]] = frozenset({"start"})

    kind: Literal["chirp"] = "chirp"
    amplitude: Number = Field(description="Amplitude, in the signal's unit.")
    f0: NonNegative = Field(description="Frequency at `start` in Hz.")
    f1: NonNegative = Field(description="Frequency at start + duration in Hz.")
    duration: Positive = Field(description="Length of the sweep in s.")
    offset: Number = Field(default=0.0, description="Mean value, in the signal's unit.")
    start: Start = Field(default=0.0, description="Start of the sweep in s.")


class PrbsSignal(Strict):
    """Pseudo-random binary sequence: every `hold` seconds `low` or `high` is drawn, from the signal's seed.

    With an `order` n the sequence is a maximum-length sequence, which repeats after (2^n − 1)·hold seconds and has a
    flat spectrum; the seed is then the place in the sequence at t = 0 (modulo its length).
    """

    model_config = example(kind="prbs", low=-1, high=1, hold=0.5, seed=7)
    optional: ClassVar[frozenset[str]] = frozenset({"order"})

    kind: Literal["prbs"] = "prbs"
    low: Number = Field(default=-1.0, description="First of the two values.")
    high: Number = Field(default=1.0, description="Second of the two values.")
    hold: Positive = Field(description="Time in s for which each drawn value is held.")
    seed: Seed = Field(default=0, description="Seed of the sequence.")
    order: Annotated[int, Field(strict=True, ge=2, le=16)] | None = Field(
        default=None, description="Order of a maximum-length sequence, 2 to 16; null: independent draws."
    )


class NoiseSignal(Strict):
    """offset + std·ξ, where ξ is drawn from the standard normal distribution every `hold` seconds, by the seed."""

    model_config = example(kind="noise", std=0.005, hold=0.5, seed=7, offset=0.08)

    kind: Literal["noise"] = "noise"
    std: NonNegative = Field(description="Standard deviation, in the signal's unit.")
    hold: Positive = Field(description="Time in s for which each drawn value is held.")
    seed: Seed = Field(default=0, description="Seed of the sequence.")
    offset: Number = Field(default=0.0, description="Mean value, in the signal's unit.")


class TableSignal(Strict):
    """Values at given times; the first value applies before them, the last one after them."""

    model_config = example(kind="table", times=[0, 1, 2], values=[0, 1, 0.5], interpolation="linear")

    kind: Literal["table"] = "table"
    times: Points = Field(description="Times in s, increasing.")
    values: Points = Field(description="Values at these times.")
    interpolation: Interpolation = Field(
        default="linear", description="Between two times: linear, or hold the earlier value."
    )

    @model_validator(mode="after")
    def _consistent(self) -> "TableSignal":
        check_increasing(self.times)
        check_lengths(self.times, self.values, more=0)
        return self


class ExpressionSignal(Strict):
    """A smooth function of the time t, as text."""

    model_config = example(kind="expression", text="sin(t) - cos(t)")

    kind: Literal["expression"] = "expression"
    text: ExpressionText = Field(description="Expression in t (s).")


Signal = Annotated[
    ConstantSignal
    | StepsSignal
    | PulseSignal
    | SquareSignal
    | SineSignal
    | RampSignal
    | ChirpSignal
    | PrbsSignal
    | NoiseSignal
    | TableSignal
    | ExpressionSignal,
    Field(discriminator="kind"),
]
"""Any time function, distinguished by `kind`."""


def points_of(signal: object) -> int:
    """Return the number of points that a signal lists; 0 for all other objects."""
    return len(signal.values) if isinstance(signal, StepsSignal | TableSignal) else 0
