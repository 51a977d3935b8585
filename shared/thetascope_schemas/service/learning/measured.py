"""Numbers measured in a run. Times count from its beginning."""

from typing import Annotated

from pydantic import Field

from thetascope_schemas.experiment.base import Number, Reference, Strict, example
from thetascope_schemas.service.learning.measures import Measure

_NAMED = {"bias": {"kind": "level", "take": "mean", "column": "adaptive.theta.theta3", "start": 90.0, "end": 100.0}}


class MeasuresRequest(Strict):
    """What to measure in a run, by names that the client chooses."""

    model_config = example(measures=_NAMED)

    measures: Annotated[dict[Reference, Measure], Field(min_length=1, max_length=60)]


class Measured(Strict):
    """The measured numbers by name."""

    model_config = example(values={"bias": 0.02})

    values: dict[str, Number | None] = Field(
        description="In the unit of the column, or in s; null: nothing was measured."
    )
