"""A record of the leaky tank of docs/plant-format.md, and what must be read from it."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
import yaml

from tests.test_docs import blocks
from thetascope.records.columns.mapping import quantities_of
from thetascope.records.defects.plausibility import PlantFacts
from thetascope.records.inspection import Inspected, inspect
from thetascope.records.readers.formats import read_table
from thetascope_schemas import Plant
from thetascope_schemas.experiment.measurement import ColumnMapping

ROOT = Path(__file__).parents[2]
ROWS = 400
FACTS = PlantFacts({"y": 20.0}, 124.0)
RNG = np.random.default_rng(7)
T = np.arange(ROWS, dtype=float)
Q = np.where(T // 60 % 2 == 0, 50.0, 65.0)
Y = np.round(20 + 2 * np.sin(T / 40) + 0.05 * RNG.standard_normal(ROWS), 5)
Cell = str | float | int


@cache
def plant() -> Plant:
    """Return the plant."""
    return Plant.model_validate(yaml.safe_load(blocks(ROOT / "docs" / "plant-format.md", "yaml")[0]))


def rows() -> list[list[Cell]]:
    """Return the rows t, q, y as numbers."""
    return [[int(t), int(q), float(y)] for t, q, y in zip(T, Q, Y, strict=True)]


def text(data: Sequence[Sequence[Cell]], head: str = "t,q,y", separator: str = ",") -> str:
    """Return rows as CSV."""
    return "\n".join([head, *(separator.join(map(str, row)) for row in data), ""])


def changed(places: Sequence[int], column: int, value: Cell) -> list[list[Cell]]:
    """Return the rows with some cells replaced."""
    data = rows()
    for place in places:
        data[place][column] = value
    return data


def inspected(data: bytes | str, name: str = "a.csv", mapping: dict | None = None) -> Inspected:
    """Return what is found in a file."""
    content = data.encode() if isinstance(data, str) else data
    asked = ColumnMapping.model_validate(mapping or {})
    return inspect(read_table(name, content), quantities_of(plant()), FACTS, asked)


def kinds(found: Inspected) -> set[str]:
    """Return the kinds of the findings."""
    return {finding.kind for finding in found.findings}
