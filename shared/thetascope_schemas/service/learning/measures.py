"""What is measured in a session or a run, and conditions on the measured numbers.

Times are in s after a mark. In a step of a lesson it is the time of the session at which the student started the step,
in a run its beginning.
"""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from thetascope_schemas.experiment.base import Number, Positive, Reference, Strict, example
from thetascope_schemas.texts.refusal import refuse

ColumnName = Annotated[str, Field(min_length=1, max_length=120, description="A column of the session, say y.y1.")]
SKETCH = "sketch"
"""The column that measures read as what the student has drawn."""
Drawn = Annotated[
    tuple[Annotated[Number, Field(description="A value, in the unit of the strip.")], ...],
    Field(min_length=3, max_length=13),
]
"""Values of a drawn curve at equal times, from the beginning of a step to its end."""
Line = Annotated[Number | Literal["dial"], Field(description="A level; dial: the one that the student has set.")]
After = Annotated[float, Field(strict=True, allow_inf_nan=False, description="Time in s after the mark.")]


class Settles(Strict):
    """The time in s after `since` from which |column − to| stays within a tolerance; none where it does not."""

    model_config = example(kind="settles", column="copy.x.h1", to="x.h1", within=1.0)
    kind: Literal["settles"] = "settles"
    column: ColumnName
    to: ColumnName | Number = Field(description="Another column, or a number.")
    within: Positive = Field(description="The tolerance, in the column's unit.")
    since: After = 0
    end: After | None = Field(default=None, description="Where looking ends. None: the end of the rows.")


class Level(Strict):
    """The mean, standard deviation, greatest, least, last or root-mean-square value of a column or a difference."""

    model_config = example(kind="level", take="std", column="y.y", minus="fast.y.y", start=10.0, end=30.0)
    kind: Literal["level"] = "level"
    take: Literal["mean", "std", "max", "min", "last", "rms"]
    column: ColumnName
    minus: ColumnName | None = None
    start: After = 0
    end: After | None = Field(default=None, description="None: until the end of the step.")


class Crosses(Strict):
    """The time in s after `since` at which a column, or the difference of two, is first above, below or beyond a level.

    Beyond: above it, or below its negative. There is no such time where it never is.
    """

    model_config = example(kind="crosses", column="slow.theta.leak", side="above", level=0.5, since=10.0)
    kind: Literal["crosses"] = "crosses"
    column: ColumnName
    minus: ColumnName | None = None
    side: Literal["above", "below", "beyond"]
    level: Line
    since: After = 0


class Counts(Strict):
    """How often a column, or the difference of two, comes beyond ±level: as often as a detector with it cries alarm."""

    model_config = example(kind="counts", column="y.y", minus="copy.y.y", level=0.075, start=-600.0, end=0.0)
    kind: Literal["counts"] = "counts"
    column: ColumnName
    minus: ColumnName | None = None
    level: Line
    start: After = 0
    end: After | None = Field(default=None, description="None: until the end of the step.")


class Decays(Strict):
    """The rate in 1/s at which |column|, or the distance of two, falls: that of a line through its logarithm.

    None where it is zero or missing in some row.
    """

    model_config = example(kind="decays", column="adaptive.theta.theta1", minus="theta.theta1", start=43.0, end=50.0)
    kind: Literal["decays"] = "decays"
    column: ColumnName
    minus: ColumnName | None = None
    start: After = 0
    end: After | None = Field(default=None, description="None: until the end of the step.")


class Rises(Strict):
    """The share of the steps between rows in which a column, or the difference of two, rises: from 0 to 1."""

    model_config = example(kind="rises", column="adaptive.pe", start=2.0)
    kind: Literal["rises"] = "rises"
    column: ColumnName
    minus: ColumnName | None = None
    start: After = 0
    end: After | None = Field(default=None, description="None: until the end of the step.")


class Found(Strict):
    """The time in s from `since` to the first alarm of the detector that names a channel; none without one."""

    model_config = example(kind="found", channel="leak", since=10.0)
    kind: Literal["found"] = "found"
    channel: Reference | None = Field(default=None, description="None: any channel.")
    since: After = 0


class Diverged(Strict):
    """The time in s after the mark at which an observer diverged; none where it did not."""

    model_config = example(kind="diverged", observer="forgetful")
    kind: Literal["diverged"] = "diverged"
    observer: Reference


class GainNow(Strict):
    """The present value of a gain that is one number."""

    model_config = example(kind="gain", observer="copy", gain="rho")
    kind: Literal["gain"] = "gain"
    observer: Reference
    gain: Reference


Measure = Annotated[
    Settles | Level | Crosses | Counts | Decays | Rises | Found | Diverged | GainNow, Field(discriminator="kind")
]


class Condition(Strict):
    """A condition on one measured number: at least, at most, or that it does not exist."""

    model_config = example(measure="settled", at_most=30.0)

    measure: Reference
    at_least: Number | None = None
    at_most: Number | None = None
    none: bool = Field(default=False, strict=True, description="True where there must be no such number.")

    @model_validator(mode="after")
    def _says_something(self) -> Self:
        if self.none == (self.at_least is not None or self.at_most is not None):
            raise refuse("course.condition.empty", field="measure", value=self.measure, measure=self.measure)
        return self

    def holds(self, value: float | None) -> bool:
        """Return whether a measured number meets the condition; None: nothing was measured."""
        if value is None or self.none:
            return value is None and self.none
        return (self.at_least is None or value >= self.at_least) and (self.at_most is None or value <= self.at_most)
