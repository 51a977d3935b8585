"""Configuration of an observer: its kind, gains, options and initial estimates."""

from typing import Annotated

from pydantic import AfterValidator, Discriminator, Field, Tag

from thetascope_schemas.experiment.base import Flag, Number, Reference, Strict, example
from thetascope_schemas.texts.refusal import refuse

RESERVED_LABELS = frozenset({"t", "u", "x", "y", "theta", "signal"})
"""Prefixes of the plant's columns."""


def _label_free(label: str) -> str:
    """Return a label; refuse reserved ones."""
    if label in RESERVED_LABELS:
        raise refuse("observer.label.reserved", value=label, label=label)
    return label


def _shape_of(value: object) -> str:
    if not isinstance(value, list | tuple):
        return "number"
    return "rows" if value and isinstance(value[0], list | tuple) else "list"


def _type_of(value: object) -> str:
    return "flag" if isinstance(value, bool) else "text" if isinstance(value, str) else "number"


Label = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_-]{0,31}$"), AfterValidator(_label_free)]
Gain = Annotated[
    Annotated[Number, Tag("number")]
    | Annotated[tuple[Number, ...], Field(min_length=1, max_length=4000), Tag("list")]
    | Annotated[
        tuple[Annotated[tuple[Number, ...], Field(min_length=1, max_length=100)], ...],
        Field(min_length=1, max_length=100),
        Tag("rows"),
    ],
    Discriminator(_shape_of),
]
Option = Annotated[
    Annotated[Flag, Tag("flag")]
    | Annotated[str, Field(max_length=200), Tag("text")]
    | Annotated[Number, Tag("number")],
    Discriminator(_type_of),
]


Kind = Annotated[str, Field(pattern=r"^[a-z][a-z0-9-]{0,39}$")]


class ObserverConfig(Strict):
    """One observer of an experiment. The catalogue lists the gains and options of each kind, and their defaults."""

    model_config = example(
        label="adaptive",
        kind="zhao-adaptive",
        gains={"rho": 4, "lambda": 4},
        options={},
        initial={"x1": 0, "x2": 0, "theta1": 0},
    )

    label: Label = Field(description="Label, unique in the experiment, and prefix of the observer's columns.")
    kind: Kind = Field(description="Kind of observer, from the catalogue.")
    gains: dict[Reference, Gain] = Field(
        default_factory=dict,
        max_length=100,
        description="Gains that differ from their defaults: a number, a list (column) or a list of rows (matrix).",
    )
    options: dict[Reference, Option] = Field(
        default_factory=dict, max_length=100, description="Options that differ from their defaults."
    )
    initial: dict[Reference, Number] = Field(
        default_factory=dict,
        max_length=200,
        description="Estimates at t = 0 by state or channel. Default: the plant's initial state, and 0 for a channel.",
    )
