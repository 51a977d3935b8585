"""Measurement of the outputs: noise, and continuous or sampled measurement."""

from typing import Literal

from pydantic import Field

from thetascope_schemas.experiment.base import NonNegative, Positive, Strict, example


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
