"""Comparison of runs: settings that differ, and measures."""

from pydantic import Field

from thetascope_schemas.experiment.base import Number, Strict, Text
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
    differences: tuple[SettingRow, ...]
    same: int = Field(description="Number of settings that are equal in all runs.")
    measures: tuple[MeasureRow, ...]
    links: dict[str, str]
