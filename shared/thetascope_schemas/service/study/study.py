"""The spec of a study. The same spec gives the same table, bit for bit, whoever computes it and in whatever order."""

import json
import math
from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, JsonValue, Tag, model_validator

from thetascope_schemas.experiment.base import (
    Identifier,
    NonNegative,
    Prose,
    Seed,
    Strict,
    Title,
    digest,
    encoded,
    example,
)
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.learning.measures import Measure
from thetascope_schemas.service.study.factors import AnyFactor, FaultsFactor, ListFactor, ObserversFactor, RangeFactor
from thetascope_schemas.texts.refusal import refuse

MAX_RUNS = 1_000_000_000
MAX_HYPERCUBE = 100_000
"""Most points of a Latin hypercube, which is drawn as a whole."""
RESERVED = ("run", "id", "point", "seed", "faulty", "substeps", "error")
"""Names of the columns that every table has."""
Group = Literal["rmse", "peak", "settling", "detection", "operations"]
GROUPS: tuple[Group, ...] = ("rmse", "peak", "settling", "detection", "operations")
_PREFIXES = (
    *("rmse.", "peak.", "settling.", "operations.", "number.", "diverged."),
    *("alarms.", "false.", "wrong.", "first.", "name.", "found.", "delay.", "size.", "size_error.", "size_held."),
    "onset_held.",
)


def _kind(value: object) -> str:
    return "library" if isinstance(value, str) else "inline"


ExperimentChoice = Annotated[
    Annotated[Identifier, Tag("library")] | Annotated[Experiment, Tag("inline")], Discriminator(_kind)
]


class Study(Strict):
    """An experiment, what varies in it, how the points are chosen, and what is measured in each run."""

    model_config = example(
        title="Forgetting against noise",
        description="",
        experiment="zhao-2012",
        set={"horizon": 2.0},
        vary=[
            {
                "kind": "range",
                "path": "observers.adaptive.gains.lambda",
                "low": 0.5,
                "high": 16.0,
                "scale": "log",
                "points": 3,
            },
            {"kind": "list", "path": "noise.y.std", "values": [0.0005, 0.001]},
        ],
        design="grid",
        points=None,
        design_seed=0,
        seeds=2,
        faults="both",
        measures=["rmse", "settling"],
        numbers={},
        since=0,
    )

    title: Title = ""
    description: Prose = ""
    experiment: ExperimentChoice = Field(description="Id of a library experiment, or a complete experiment.")
    set: dict[str, JsonValue] = Field(
        default_factory=dict, max_length=200, description="Values of the experiment that differ in all runs, by path."
    )
    vary: tuple[AnyFactor, ...] = Field(default=(), max_length=16)
    design: Literal["grid", "random", "latin-hypercube", "sobol"] = Field(
        default="grid", description="Grid: all combinations. Otherwise `points` points in the box of all factors."
    )
    points: Annotated[int, Field(strict=True, ge=1, le=MAX_RUNS)] | None = Field(
        default=None, description="Number of points of a sampled design."
    )
    design_seed: Seed = Field(default=0, description="Seed of a sampled design.")
    seeds: Annotated[int, Field(strict=True, ge=1, le=MAX_RUNS)] = Field(
        default=1, description="Runs at each point, with the experiment's seed and those that follow it."
    )
    faults: Literal["with", "without", "both"] = Field(
        default="with", description="Runs with the faults, without any, or each of them once."
    )
    measures: tuple[Group, ...] = Field(
        default=("rmse", "detection"),
        max_length=len(GROUPS),
        description="Without `detection` no detector runs, and runs of one shape are computed together, much faster.",
    )
    numbers: dict[Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9_-]{0,39}$")], Measure] = Field(
        default_factory=dict, max_length=40, description="Further numbers of each run, by name."
    )
    since: NonNegative = Field(default=0.0, description="Time in s from which errors are measured.")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        self._check_design()
        self._check_names()
        if self.runs > MAX_RUNS:
            raise refuse("study.too-many", "vary", self.runs, runs=self.runs, limit=MAX_RUNS)
        return self

    def _check_design(self) -> None:
        if self.design != "grid" and self.points is None:
            raise refuse("study.points.missing", "points", None, design=self.design)
        if self.design == "grid" and self.points is not None:
            raise refuse("study.points.grid", "points", self.points)
        if self.design == "latin-hypercube" and (self.points or 0) > MAX_HYPERCUBE:
            raise refuse("study.hypercube", "points", self.points, limit=MAX_HYPERCUBE)
        for i, factor in enumerate(self.vary):
            if self.design == "grid" and isinstance(factor, RangeFactor) and factor.points is None:
                raise refuse("study.range.points", f"vary[{i}].points", None, name=factor.column)

    def _check_names(self) -> None:
        seen: set[str] = set()
        for i, factor in enumerate(self.vary):
            name = factor.column
            if name in seen or name in RESERVED or name.startswith(_PREFIXES):
                raise refuse("study.name.taken", f"vary[{i}].name", name, name=name)
            seen.add(name)

    @property
    def sizes(self) -> tuple[int | None, ...]:
        """Return the number of values of each factor; None: any number of a range."""
        return tuple(_values_of(factor) for factor in self.vary)

    @property
    def point_count(self) -> int:
        """Return the number of points."""
        if self.design != "grid":
            return self.points or 0
        return math.prod(size or 1 for size in self.sizes)

    @property
    def modes(self) -> tuple[bool, ...]:
        """Return whether faults act, for each run at one point with one seed."""
        return {"with": (True,), "without": (False,), "both": (True, False)}[self.faults]

    @property
    def runs(self) -> int:
        """Return the number of runs."""
        return self.point_count * self.seeds * len(self.modes)

    def canonical(self) -> bytes:
        """Return a unique representation of all that determines the table: JSON, UTF-8, sorted keys; no title."""
        data: dict[str, Any] = self.model_dump(mode="json", exclude={"title", "description", "experiment"})
        chosen = self.experiment
        base = chosen if isinstance(chosen, str) else json.loads(chosen.canonical())
        return encoded({"study": data, "experiment": base})

    def study_hash(self) -> str:
        """Return the first 32 hexadecimal digits of the SHA-256 of `canonical()`, the id of the study."""
        return digest(self.canonical())


def _values_of(factor: AnyFactor) -> int | None:
    match factor:
        case ListFactor():
            return len(factor.values)
        case RangeFactor():
            return factor.points
        case FaultsFactor():
            return len(factor.sets)
        case ObserversFactor():
            return len(factor.labels)
        case _:
            return len(factor.cases)
