"""What varies in a study: values at paths of the experiment, named cases, faults, observers."""

from itertools import combinations
from typing import Annotated, Literal, Self

from pydantic import Field, JsonValue, model_validator

from thetascope_schemas.experiment.base import Flag, Instant, Number, Reference, Strict, example
from thetascope_schemas.texts.refusal import refuse

MAX_VALUES = 10_000
Path = Annotated[
    str,
    Field(
        min_length=1,
        max_length=400,
        description="Where in the experiment, say `observers.adaptive.gains.rho`, `noise.y.std`, `faults.theta3.size`.",
    ),
]
FactorName = Annotated[
    str,
    Field(
        max_length=80, description="Name of its column in the table; empty: the path, or the kind if it has no path."
    ),
]
Changes = Annotated[dict[Path, JsonValue], Field(max_length=40, description="Path → new value, all changed at once.")]


class Factor(Strict):
    """Base of all factors: something that varies."""

    model_config = example(name="rho")
    name: FactorName = ""

    @property
    def column(self) -> str:
        """Return the name of its column."""
        return self.name or str(getattr(self, "path", "")) or str(getattr(self, "kind", ""))


class ListFactor(Factor):
    """A value that takes each item of a list. In a sampled design all items are equally probable."""

    model_config = example(kind="list", path="noise.y.std", values=[0.0005, 0.001, 0.002])

    kind: Literal["list"] = "list"
    path: Path
    values: tuple[JsonValue, ...] = Field(min_length=1, max_length=MAX_VALUES)


class RangeFactor(Factor):
    """A number between two bounds: evenly spaced in a grid, anywhere between them in a sampled design."""

    model_config = example(
        kind="range", path="observers.adaptive.gains.lambda", low=0.5, high=16.0, scale="log", points=8
    )

    kind: Literal["range"] = "range"
    path: Path
    low: Number = Field(description="The least value.")
    high: Number = Field(description="The greatest value.")
    scale: Literal["linear", "log"] = "linear"
    points: Annotated[int, Field(strict=True, ge=2, le=MAX_VALUES)] | None = Field(
        default=None, description="Number of values in a grid, the bounds among them."
    )

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.high <= self.low:
            raise refuse("study.range.order", "high", self.high, low=self.low, high=self.high)
        if self.scale == "log" and self.low <= 0:
            raise refuse("study.range.log", "low", self.low, low=self.low)
        return self


class CasesFactor(Factor):
    """Named cases; each changes several values at once."""

    model_config = example(
        kind="cases",
        name="gains",
        cases={
            "calm": {"observers.adaptive.gains.rho": 2, "observers.adaptive.gains.lambda": 1},
            "fast": {"observers.adaptive.gains.rho": 8, "observers.adaptive.gains.lambda": 8},
        },
    )

    kind: Literal["cases"] = "cases"
    cases: dict[Annotated[str, Field(min_length=1, max_length=80)], Changes] = Field(
        min_length=1, max_length=MAX_VALUES
    )


class FaultsFactor(Factor):
    """Each of some faults alone, and every pair of them if wanted, in place of the experiment's faults."""

    model_config = example(kind="faults", name="fault", sizes={"theta1": 0.01, "theta3": 0.02}, onset=20.0, pairs=True)

    kind: Literal["faults"] = "faults"
    sizes: dict[Reference, Annotated[Number, Field(description="Size of the step, in the channel's unit.")]] = Field(
        min_length=1, max_length=40, description="Fault channel → size of its step."
    )
    onset: Instant = Field(description="Time in s at which they begin.")
    end: Instant | None = Field(default=None, description="Time in s at which they end; null: never.")
    pairs: Flag = Field(default=False, description="Also every two of them together.")

    @property
    def sets(self) -> tuple[tuple[str, ...], ...]:
        """Return the sets of channels, one for each value."""
        alone = tuple((channel,) for channel in self.sizes)
        return alone + (tuple(combinations(self.sizes, 2)) if self.pairs else ())


class ObserversFactor(Factor):
    """Each of the experiment's observers alone."""

    model_config = example(kind="observers", labels=["adaptive", "ekf"])

    kind: Literal["observers"] = "observers"
    labels: tuple[Annotated[str, Field(min_length=1, max_length=64)], ...] = Field(min_length=1, max_length=12)


AnyFactor = Annotated[
    ListFactor | RangeFactor | CasesFactor | FaultsFactor | ObserversFactor, Field(discriminator="kind")
]
