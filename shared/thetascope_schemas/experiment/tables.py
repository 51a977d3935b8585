"""A table y(x) of a plant, which expressions interpolate."""

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from thetascope_schemas.experiment.base import MAX_ROWS, Name, Number, Prose, Strict, Unit, example
from thetascope_schemas.texts.refusal import refuse

Column = Annotated[tuple[Number, ...], Field(min_length=2, max_length=MAX_ROWS)]


class Table(Strict):
    """Values y at increasing x; `interp(x, name)` is the value between them."""

    model_config = example(
        name="ocv",
        x=[0, 0.1, 0.5, 0.9, 1],
        y=[3.0, 3.45, 3.7, 4.0, 4.2],
        method="cubic",
        outside="continue",
        unit="V",
        description="open-circuit voltage by state of charge",
    )

    name: Name = Field(description="Name in the second argument of interp.")
    x: Column = Field(description="Increasing arguments, at least two.")
    y: Column = Field(description="Values, one for each argument.")
    method: Literal["linear", "cubic"] = Field(
        default="linear", description="Straight lines, or cubic pieces that keep the shape (PCHIP)."
    )
    outside: Literal["hold", "continue"] = Field(
        default="hold", description="Beyond the ends: the value at the end, or a line with the slope there."
    )
    unit: Unit = ""
    description: Prose = ""

    @model_validator(mode="after")
    def _one_value_for_each_argument(self) -> "Table":
        """Refuse columns of different lengths, arguments that do not increase, and slopes beyond double precision."""
        if len(self.x) != len(self.y):
            raise refuse("plant.table.lengths", "y", name=self.name, x=len(self.x), y=len(self.y))
        for k, (low, high) in enumerate(zip(self.x, self.x[1:], strict=False), start=1):
            if not low < high:
                args = {"name": self.name, "place": k, "before": low, "number": high}
                raise refuse("plant.table.not-increasing", f"x[{k}]", high, **args)
            width, rise = high - low, abs(self.y[k] - self.y[k - 1])
            square = width * width
            if not 0 < square < math.inf or not rise / width / square < math.inf:
                raise refuse("plant.table.steep", f"x[{k}]", high, name=self.name, before=low, number=high)
        return self
