"""Compiled loops compute what the same text computes as Python."""

from dataclasses import dataclass
from math import exp, isnan, sqrt
from typing import Annotated

import numpy as np
import pytest

from thetascope.engine.loops.declaration import Bundle, Sizes, empty, loops
from thetascope.engine.loops.kernels import compile_loops


@dataclass
class Table(Bundle):
    """A table and its sums."""

    values: Annotated[np.ndarray, "rows n"]
    sums: Annotated[np.ndarray, "n+1"]


@loops(row="n")
def largest(size: Sizes, row: np.ndarray) -> float:
    """Return the largest number of a row that is not NaN."""
    best = -1.0e300
    for i in range(size.n):
        if not isnan(row[i]) and row[i] > best:
            best = row[i]
    return best


@loops(scratch="rows 2*n")
def mixed(size: Sizes, rows: int, scale: float, table: Table, scratch: np.ndarray) -> float:
    """Use every statement and expression of the subset."""
    local = empty(size.n, 2)
    total = 0.0
    for k in range(rows - 1, -1, -1):
        for i in range(size.n):
            local[i, 0] = table.values[k, i] * scale
            local[i, 1] = sqrt(abs(local[i, 0])) + exp(-abs(table.values[k, i]))
            scratch[k, i] = min(local[i, 0], local[i, 1])
            scratch[k, size.n + i] = max(local[i, 0], float(k % 3))
        if k // 2 == 1 or (scale > 2.0 and not k < 4):
            continue
        total += largest(size, table.values[k])
        if total > 50.0:
            break
    j = 0
    while j <= size.n:
        table.sums[j] += -total + 3 * j
        j += 1
    if size.n == 1:
        total = total / 2
        total = total + 0.5
    else:
        total = total - 1.0
    return total


@pytest.mark.parametrize(("n", "scale"), [(1, 0.5), (3, 2.5), (4, -1.0)])
def test_machine_code_agrees_with_python(n: int, scale: float) -> None:
    """Machine code gives the numbers of the Python text, for every construct of the subset."""
    values = np.random.default_rng(n).standard_normal((7, n))
    values[3, 0] = np.nan
    kernel = compile_loops([mixed], [largest], {"n": n}, {})["mixed"]
    results = []
    for run in (
        lambda t, s: mixed(Sizes(n=n), 7, scale, t, s),
        lambda t, s: kernel(rows=7, scale=scale, table=t, scratch=s),
    ):
        table, scratch = Table(values.copy(), np.ones(n + 1)), np.zeros((7, 2 * n))
        results.append((run(table, scratch), table.sums, scratch))
    for a, b in zip(*results, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-13, atol=1e-13)


def test_arrays_of_other_shapes_are_refused() -> None:
    """A kernel checks shape, type and layout of every array before it takes an address."""
    kernel = compile_loops([mixed], [largest], {"n": 3}, {})["mixed"]
    good = {"rows": 4, "scale": 1.0, "table": Table(np.zeros((4, 3)), np.zeros(4)), "scratch": np.zeros((4, 6))}
    kernel(**good)
    for bad in (np.zeros((4, 5)), np.zeros((5, 6)), np.zeros((4, 6), dtype=np.float32), np.zeros((6, 4)).T):
        with pytest.raises(ValueError, match=r"mixed: scratch.* must be"):
            kernel(**good | {"scratch": bad})


def test_text_outside_the_subset_is_refused() -> None:
    """What cannot be translated is an error at compilation, with the text."""

    @loops()
    def listed(size: Sizes) -> float:
        numbers = [1.0, 2.0]
        return numbers[0]

    with pytest.raises(SyntaxError, match=r"listed: cannot compile '\[1\.0, 2\.0\]'"):
        compile_loops([listed], [], {"n": 1}, {})
