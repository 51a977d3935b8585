"""Faults over time: of a channel (inside the model, θ) or of a measurement (outside the model, y)."""

from typing import Annotated, Literal, NamedTuple

from pydantic import Field, model_validator

from thetascope_schemas.experiment.base import (
    MAX_TIME,
    Instant,
    NonNegative,
    Number,
    Positive,
    Reference,
    Strict,
    example,
)
from thetascope_schemas.experiment.signals import Interpolation, Points, check_increasing, check_lengths, check_width
from thetascope_schemas.texts.refusal import refuse


class Site(NamedTuple):
    """The site of a fault: a fault channel inside the model, or a measured output."""

    kind: Literal["channel", "output"]
    name: str

    @property
    def prefix(self) -> Literal["theta", "y"]:
        """Return the prefix of the fault's column: θ of a channel, y of an output."""
        return "theta" if self.kind == "channel" else "y"


class TimedFault(Strict):
    """Base of all faults, which act on [onset, end)."""

    onset: Instant = Field(description="Time in s at which the fault appears.")
    end: Instant | None = Field(default=None, description="Time in s at which it disappears; null: never.")

    @model_validator(mode="after")
    def _ends_after_onset(self) -> "TimedFault":
        if self.end is not None and self.end <= self.onset:
            raise refuse("fault.end.before-onset", "end", self.end, end=self.end, onset=self.onset)
        return self


class ChannelFault(TimedFault):
    """A fault inside the model: the value θ(t) of one channel. τ = t − onset below."""

    channel: Reference = Field(description="Name of the plant's fault channel.")

    @property
    def site(self) -> Site:
        """Return the channel that the fault acts on."""
        return Site("channel", self.channel)


class StepFault(ChannelFault):
    """θ = size from the onset on."""

    model_config = example(channel="theta3", shape="step", onset=20, end=None, size=0.02)

    shape: Literal["step"] = "step"
    size: Number = Field(description="Size, in the channel's unit.")


class RampFault(ChannelFault):
    """θ rises linearly to `size` over `duration`, then is constant."""

    model_config = example(channel="theta1", shape="ramp", onset=40, end=None, size=0.01, duration=5)

    shape: Literal["ramp"] = "ramp"
    size: Number = Field(description="Final size, in the channel's unit.")
    duration: Positive = Field(description="Time in s to the final size.")


class DriftFault(ChannelFault):
    """θ = rate·τ, without limit."""

    model_config = example(channel="theta1", shape="drift", onset=40, end=None, rate=0.001)

    shape: Literal["drift"] = "drift"
    rate: Number = Field(description="Rate, in the channel's unit per s.")


class ExponentialFault(ChannelFault):
    """Incipient fault: θ = size·(1 − exp(−τ/time_constant))."""

    model_config = example(channel="theta1", shape="exponential", onset=40, end=None, size=0.01, time_constant=3)

    shape: Literal["exponential"] = "exponential"
    size: Number = Field(description="Limit of the size, in the channel's unit.")
    time_constant: Positive = Field(description="Time constant in s.")


class SineFault(ChannelFault):
    """θ = size·sin(2π·frequency·τ + phase)."""

    model_config = example(channel="theta1", shape="sine", onset=40, end=60, size=0.01, frequency=0.2, phase=0)

    shape: Literal["sine"] = "sine"
    size: Number = Field(description="Amplitude, in the channel's unit.")
    frequency: NonNegative = Field(description="Frequency in Hz.")
    phase: Number = Field(default=0.0, description="Phase at the onset in rad.")


class PulseTrainFault(ChannelFault):
    """Intermittent fault: θ = size on [k·period, k·period + width) of τ, otherwise 0."""

    model_config = example(channel="theta1", shape="pulse-train", onset=40, end=60, size=0.01, period=4, width=1)

    shape: Literal["pulse-train"] = "pulse-train"
    size: Number = Field(description="Size within the pulses, in the channel's unit.")
    period: Positive = Field(description="Period in s.")
    width: Positive = Field(description="Length of one pulse in s, at most the period.")

    @model_validator(mode="after")
    def _pulse_fits(self) -> "PulseTrainFault":
        check_width(self.width, self.period)
        return self


class RandomWalkFault(ChannelFault):
    """Random walk: every sample_time θ gains a Gaussian increment of std intensity·√sample_time (experiment's seed)."""

    model_config = example(channel="theta1", shape="random-walk", onset=40, end=None, intensity=0.001, sample_time=0.1)

    shape: Literal["random-walk"] = "random-walk"
    intensity: NonNegative = Field(description="Standard deviation per √s, in the channel's unit.")
    sample_time: Positive = Field(default=0.01, description="Time in s between increments.")


class TableFault(ChannelFault):
    """θ from a table over τ; the first value applies before its time, the last one after its time."""

    model_config = example(
        channel="theta1", shape="table", onset=40, end=None, times=[0, 5], values=[0, 0.01], interpolation="linear"
    )

    shape: Literal["table"] = "table"
    times: Points = Field(description="Times in s after the onset, increasing.")
    values: Points = Field(description="Values at these times, in the channel's unit.")
    interpolation: Interpolation = Field(
        default="linear", description="Between two times: linear, or hold the earlier value."
    )

    @model_validator(mode="after")
    def _consistent(self) -> "TableFault":
        check_increasing(self.times)
        check_lengths(self.times, self.values, more=0)
        if self.times[0] < 0:
            raise refuse("fault.times.before-onset", "times", self.times[0], time=self.times[0])
        return self


class MeasurementFault(TimedFault):
    """A fault outside the model, of one measured output. Observers see only the measurement."""

    output: Reference = Field(description="Name of the plant's output.")

    @property
    def site(self) -> Site:
        """Return the output that the fault acts on."""
        return Site("output", self.output)


class StuckFault(MeasurementFault):
    """The measurement is `value`."""

    model_config = example(output="y", shape="stuck", onset=30, end=35, value=0.1)

    shape: Literal["stuck"] = "stuck"
    value: Number = Field(description="Measured value, in the output's unit.")


class FreezeFault(MeasurementFault):
    """The measurement keeps the value that it had at the onset."""

    model_config = example(output="y", shape="freeze", onset=30, end=35)

    shape: Literal["freeze"] = "freeze"


class DropoutFault(MeasurementFault):
    """Each sample is lost with a probability; the last value is then kept."""

    model_config = example(output="y", shape="dropout", onset=30, end=35, probability=0.3, sample_time=0.1)

    shape: Literal["dropout"] = "dropout"
    probability: Annotated[NonNegative, Field(le=1)] = Field(description="Probability that a sample is lost.")
    sample_time: Positive = Field(default=0.01, description="Time in s between samples.")


class OutliersFault(MeasurementFault):
    """Each sample is displaced by ±size with a probability."""

    model_config = example(output="y", shape="outliers", onset=30, end=35, probability=0.02, size=0.5, sample_time=0.1)

    shape: Literal["outliers"] = "outliers"
    probability: Annotated[NonNegative, Field(le=1)] = Field(description="Probability that a sample is an outlier.")
    size: Number = Field(description="Displacement, in the output's unit.")
    sample_time: Positive = Field(default=0.01, description="Time in s between samples.")


class NoiseBurstFault(MeasurementFault):
    """Additional Gaussian noise."""

    model_config = example(output="y", shape="noise-burst", onset=30, end=35, std=0.05, sample_time=0.01)

    shape: Literal["noise-burst"] = "noise-burst"
    std: NonNegative = Field(description="Standard deviation, in the output's unit.")
    sample_time: Positive = Field(default=0.01, description="Time in s for which each drawn value is held.")


class QuantisationFault(MeasurementFault):
    """The output is rounded to multiples of the resolution."""

    model_config = example(output="y", shape="quantisation", onset=30, end=None, resolution=0.01)

    shape: Literal["quantisation"] = "quantisation"
    resolution: Positive = Field(description="Resolution, in the output's unit.")


class DelayFault(MeasurementFault):
    """The output is delayed."""

    model_config = example(output="y", shape="delay", onset=30, end=None, delay=0.2)

    shape: Literal["delay"] = "delay"
    delay: Annotated[Positive, Field(le=MAX_TIME)] = Field(description="Delay in s.")


Fault = Annotated[
    StepFault
    | RampFault
    | DriftFault
    | ExponentialFault
    | SineFault
    | PulseTrainFault
    | RandomWalkFault
    | TableFault
    | StuckFault
    | FreezeFault
    | DropoutFault
    | OutliersFault
    | NoiseBurstFault
    | QuantisationFault
    | DelayFault,
    Field(discriminator="shape"),
]
"""Any fault, distinguished by `shape`: the first eight act on a `channel`, the others on an `output`."""
