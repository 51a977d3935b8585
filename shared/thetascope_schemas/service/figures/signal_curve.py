"""The curve of a signal, as a figure draws it."""

from pydantic import Field, model_validator

from thetascope_schemas.experiment.base import MAX_TIME, Instant, Number, Positive, Strict, example
from thetascope_schemas.experiment.signals import Signal
from thetascope_schemas.texts.refusal import refuse


class SignalCurveRequest(Strict):
    """A signal, and the span that a figure shows."""

    model_config = example(
        signal={"kind": "sine", "amplitude": 0.015, "frequency": 0.1, "offset": 0.08}, start=0, end=40, places=200
    )

    signal: Signal
    start: Instant = Field(description="Start of the span in s.")
    end: Positive = Field(le=MAX_TIME, description="End of the span in s.")
    places: int = Field(default=200, ge=2, le=2000, strict=True, description="Columns of the figure.")

    @model_validator(mode="after")
    def _increasing(self) -> "SignalCurveRequest":
        if not self.start < self.end:
            raise refuse("signal.curve.empty", "end", self.end, start=self.start, end=self.end)
        return self


class SignalCurve(Strict):
    """Points of a signal: straight lines between them are what a figure with that many columns shows."""

    model_config = example(t=[0, 10, 10, 20], values=[0.08, 0.08, 0.02, 0.02])

    t: tuple[Number, ...] = Field(description="Times in s, in order; a jump has both limits at one time.")
    values: tuple[Number, ...] = Field(description="Values at these times, in the signal's unit.")
