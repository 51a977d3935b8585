"""The check of a plant's text: where each error is, and the change that corrects it."""

from typing import Annotated, Any, Literal

from pydantic import Field

from thetascope_schemas.experiment.base import (
    MAX_CHANNELS,
    MAX_STATES,
    ExpressionText,
    Number,
    Reference,
    Strict,
    example,
)
from thetascope_schemas.experiment.plant import Channel, Parameter, Plant, State
from thetascope_schemas.service.answers import PlantEquations, PlantSizes
from thetascope_schemas.service.field_error import FieldError

TextFormat = Literal["yaml", "json"]


class TextPlace(Strict):
    """Characters of a text. Lines and columns count from 1; columns and lengths are UTF-16 code units."""

    model_config = example(line=20, column=36, length=3)

    line: int
    column: int
    length: int = Field(description="Length, line breaks included; 0: a place between two characters.")


class TextFix(TextPlace):
    """A change that corrects an error: these characters are replaced by `text`."""

    model_config = example(line=20, column=36, length=3, text="sqrt")

    text: str


_ERROR = {
    "field": "definitions[1].expression",
    "value": "sqr",
    "code": "expression.at",
    "args": {"problem": {"code": "expression.function.unknown", "args": {"name": "sqr"}}, "column": 4},
    "problem": "There is no function sqr at column 4",
    "remedy": "did you mean sqrt?",
    "severity": "error",
    "place": {"line": 20, "column": 36, "length": 3},
    "fix": {"line": 20, "column": 36, "length": 3, "text": "sqrt"},
}


class TextError(FieldError):
    """An error or a warning, and its place in the text."""

    model_config = example(**_ERROR)

    severity: Literal["error", "warning"] = "error"
    place: TextPlace
    fix: TextFix | None = Field(default=None, description="The change that corrects it; null: there is no single one.")


class PlantTextCheck(Strict):
    """The check of a plant's text. A text with errors is an answer, too, and not a refusal."""

    model_config = example(
        format="yaml",
        id="two-tanks",
        title="Two tanks in a row",
        valid=False,
        errors=[_ERROR],
        plant=None,
        sizes=None,
        equations=None,
    )

    format: TextFormat
    id: str = Field(description="The plant's id, as far as the text can be read.")
    title: str
    valid: bool = Field(description="Whether the plant can be simulated: there are no errors.")
    errors: tuple[TextError, ...] = Field(description="Errors and warnings in the order of the text.")
    plant: Plant | None = Field(description="The plant in full; null unless it is valid.")
    sizes: PlantSizes | None
    equations: PlantEquations | None


class TextEdit(Strict):
    """Changes of a plant's text: numbers by path, further items of lists, further equations; and its format."""

    model_config = example(
        text="id: tank",
        values={"parameters[0].value": 155},
        channels=[{"name": "leak", "kind": "process", "enters": {"h": "-1"}}],
    )

    text: Annotated[str, Field(max_length=1_000_000)]
    values: dict[str, Number] = Field(default_factory=dict, max_length=400, description="New values by path.")
    states: tuple[State, ...] = Field(default=(), max_length=MAX_STATES, description="States to add.")
    parameters: tuple[Parameter, ...] = Field(default=(), max_length=200, description="Parameters to add.")
    channels: tuple[Channel, ...] = Field(default=(), max_length=MAX_CHANNELS, description="Fault channels to add.")
    equations: dict[Reference, ExpressionText] = Field(
        default_factory=dict, max_length=MAX_STATES, description="Equations to add to `dynamics`, by state."
    )
    format: TextFormat | None = Field(default=None, description="YAML or JSON; null: the format stays.")

    def items_by_list(self) -> dict[str, list[dict[str, Any]]]:
        """Return the items to add as data without empty fields, by list."""
        lists = {"states": self.states, "parameters": self.parameters, "channels": self.channels}
        return {
            name: [item.model_dump(mode="json", exclude_unset=True) for item in items] for name, items in lists.items()
        }


class EditedText(Strict):
    """A plant's text after a change."""

    model_config = example(text="id: tank", lines=[1])

    text: str
    lines: tuple[int, ...] = Field(description="Numbers of the lines that are new, from 1.")
