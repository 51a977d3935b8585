"""Figures of an experiment (the columns to draw, and their style) and notes on its time. No number depends on them."""

from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from thetascope_schemas.experiment.base import Flag, Identifier, Instant, Prose, Strict, Title, example
from thetascope_schemas.texts.one_line import one_line

MAX_NOTES = 100
MAX_NOTE = 500  # characters

Column = Annotated[str, Field(min_length=1, max_length=100)]


class Trace(Strict):
    """One line of a panel: a column, or the difference of two."""

    model_config = example(column="x.x1", minus="adaptive.x.x1", label="error of x1", style="solid", absolute=True)

    column: Column = Field(description="Column of the result.")
    minus: Column | None = Field(default=None, description="Column to subtract.")
    label: Title = Field(default="", description="Text in the legend; the column's name when empty.")
    style: Literal["solid", "dash", "dot"] = "solid"
    absolute: Flag = Field(default=False, description="Draw the absolute value.")


class Panel(Strict):
    """One pair of axes."""

    model_config = example(
        title="Sensor fault",
        x="t",
        x_title="t in s",
        y_title="θ3",
        log=False,
        traces=[{"column": "theta.theta3", "style": "dash"}, {"column": "adaptive.theta.theta3"}],
    )

    title: Title = ""
    x: Column = Field(default="t", description="Column of the horizontal axis.")
    x_title: Title = ""
    y_title: Title = ""
    log: Flag = Field(default=False, description="Logarithmic vertical axis.")
    traces: tuple[Trace, ...] = Field(min_length=1, max_length=24)


class Figure(Strict):
    """One figure of an experiment: panels from top to bottom."""

    model_config = example(
        name="faults",
        title="Estimated faults",
        caption="Dashed: true",
        panels=[{"traces": [{"column": "theta.theta3", "style": "dash"}, {"column": "adaptive.theta.theta3"}]}],
    )

    name: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$")] = Field(
        description="Name, which is part of the figure's URL."
    )
    title: Title = ""
    caption: Prose = ""
    panels: tuple[Panel, ...] = Field(min_length=1, max_length=12)

    def columns(self) -> Iterator[tuple[str, str]]:
        """Yield the path of every field that names a column, and that column."""
        for index, panel in enumerate(self.panels):
            yield f"panels[{index}].x", panel.x
            for number, trace in enumerate(panel.traces):
                yield f"panels[{index}].traces[{number}].column", trace.column
                if trace.minus is not None:
                    yield f"panels[{index}].traces[{number}].minus", trace.minus


class Note(Strict):
    """A note at a moment of the experiment; without a text it is a bookmark."""

    model_config = example(id="overshoot", t=45.3, text="The EKF overshoots here.")

    id: Identifier = Field(description="Id, which no other note of the experiment has.")
    t: Instant = Field(description="The moment, time in s.")
    text: Annotated[str, AfterValidator(one_line)] = Field(default="", max_length=MAX_NOTE)


Notes = Annotated[tuple[Note, ...], Field(max_length=MAX_NOTES)]
"""All notes of an experiment."""
