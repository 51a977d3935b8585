"""Comparison of runs: settings that differ, and measures."""

from pydantic import Field

from thetascope_schemas.experiment.base import Number, Strict, Text, example
from thetascope_schemas.service.notebook.lines import RunLine, Setting


class SettingRow(Strict):
    """A setting in which the runs differ."""

    path: str = Field(description="Path of the setting; items of lists by label, channel or output.")
    label: Text = Field(description="Name of the setting.")
    values: tuple[Setting, ...] = Field(description="Value in each run; null: it is not given.")


class MeasureRow(Strict):
    """A measure of the compared observers; the smaller the better."""

    label: Text = Field(description="Name of the measure.")
    unit: str
    values: tuple[Number | None, ...] = Field(description="Value in each run; null: it has none.")


class RunComparison(Strict):
    """Two to six runs compared, in the order in which they were asked for."""

    runs: tuple[RunLine, ...]
    observers: tuple[str | None, ...] = Field(description="The observer that is compared in each run.")
    choices: tuple[str, ...] = Field(description="Observers that can be compared: those of all runs first.")
    differences: tuple[SettingRow, ...]
    same: int = Field(description="Number of settings that are equal in all runs.")
    measures: tuple[MeasureRow, ...]
    notes: str = Field(description="What this client noted about the comparison of these runs.")
    warning: str = Field(default="", description="That the notes are damaged in the store and left out.")
    links: dict[str, str]


class ComparisonNotes(Strict):
    """What a client notes about a comparison."""

    model_config = example(text="For figure 4: leave out θ2, the journal prints in grey.")

    text: str = Field(max_length=4000, description="Notes as plain text; empty: none.")
