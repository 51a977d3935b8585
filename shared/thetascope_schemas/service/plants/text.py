"""The check of a plant's text: where each error is, and the change that corrects it."""

from typing import Literal

from pydantic import Field

from thetascope_schemas.experiment.base import Strict, example
from thetascope_schemas.experiment.plant import Plant
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
