"""Tables: values and slopes against SciPy, and refusals of expressions that misuse them."""

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator

from thetascope.engine.errors import ExpressionError
from thetascope.engine.language.parser import parse
from thetascope.engine.language.render.mathml import expression as mathml
from thetascope.engine.language.tables import Table

SIZES = st.sampled_from([1e-12, 1e-3, 1.0, 1e7])
WIDTHS = st.floats(0.05, 20)
VALUES = st.integers(-4, 4).map(float) | st.floats(-10, 10)  # integers make level pieces and repeated slopes


@st.composite
def points(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray]:
    """Draw the columns of a table in units of any size."""
    n = draw(st.integers(2, 12))
    x = np.cumsum(draw(st.lists(WIDTHS, min_size=n, max_size=n))) * draw(SIZES) + draw(st.sampled_from([0.0, -3.0]))
    y = np.array(draw(st.lists(VALUES, min_size=n, max_size=n))) * draw(SIZES)
    return x, y


def table(x: np.ndarray, y: np.ndarray, method: str = "cubic", outside: str = "hold") -> Table:
    return Table.of({"name": "map", "x": list(x), "y": list(y), "method": method, "outside": outside})


@settings(max_examples=60, deadline=None)
@given(points(), st.sampled_from(["hold", "continue"]))
def test_a_cubic_table_is_scipys_monotone_interpolant(columns: tuple[np.ndarray, np.ndarray], outside: str):
    """Values, first and second derivatives between the points equal those of PchipInterpolator."""
    x, y = columns
    if not (np.diff(x) > 0).all():
        return
    ours, theirs = table(x, y, outside=outside), PchipInterpolator(x, y)
    at = np.concatenate([x[:-1] + f * np.diff(x) for f in (0.001, 0.3, 0.5, 0.9)])
    for order in range(3):
        expected = theirs(at, nu=order)
        size = np.abs(expected).max() + np.abs(y).max() / np.diff(x).min() ** order
        np.testing.assert_allclose([ours.value(v) for v in at], expected, rtol=1e-9, atol=1e-11 * size)
        ours = ours.slope()


@settings(max_examples=40, deadline=None)
@given(points())
def test_a_linear_table_is_numpys(columns: tuple[np.ndarray, np.ndarray]):
    """Values at the points, between and beyond them equal those of numpy.interp, which holds the end values."""
    x, y = columns
    if not (np.diff(x) > 0).all():
        return
    at = np.concatenate([x, x[:-1] + 0.3 * np.diff(x), [x[0] - 5 * (x[-1] - x[0]), x[-1] + 1e3 * (x[-1] - x[0])]])
    values = [table(x, y, "linear").value(v) for v in at]
    np.testing.assert_allclose(values, np.interp(at, x, y), rtol=1e-12, atol=1e-12 * np.abs(y).max())


@pytest.mark.parametrize("method", ["linear", "cubic"])
def test_a_table_continues_with_the_slope_at_its_end(method: str):
    """With `continue` the values beyond the ends are on the tangents, with `hold` they are those at the ends."""
    x, y = [0.0, 1.0, 3.0], [1.0, 2.0, 8.0]
    line, held = (table(np.array(x), np.array(y), method, outside) for outside in ("continue", "hold"))
    for end, at, sign in ((0.0, -2.0, -1), (3.0, 7.0, 1)):
        slope = (line.value(end) - line.value(end - sign * 1e-7)) / (sign * 1e-7)
        assert line.value(at) == pytest.approx(line.value(end) + slope * (at - end), rel=1e-6)
        assert held.value(at) == held.value(end)


def test_interp_of_a_number_is_a_number():
    """At a constant the expression is the table's value there, and outside it follows the rule of the table."""
    tables = {"map": table(np.array([0.0, 2.0]), np.array([1.0, 5.0]), "linear")}
    for text, value in (("interp(0.5, map)", 2.0), ("interp(3, map)", 5.0), ("1 + interp(2*1/4, map)", 3.0)):
        assert parse(text, (), tables=tables).sympy({}, tables) == sympy.Float(value)


@pytest.mark.parametrize(
    ("text", "column", "says"),
    [
        ("ocv", 1, "write interp(x, ocv)"),
        ("2*ocv + x", 3, "is a table"),
        ("ocv(x)", 1, "write interp(x, ocv)"),
        ("interp(ocv, x)", 8, "the table second"),
        ("interp(x, ocw)", 11, "did you mean ocv"),
        ("interp(x, 2*ocv)", 11, "name of a table"),
        ("interp(x, ocv, 1)", 1, "2 arguments"),
        ("interp(ocv, ocv)", 8, "is a table"),
        ("where(ocv < 1, x, 0)", 7, "is a table"),
    ],
)
def test_misused_tables_are_refused_at_their_place(text: str, column: int, says: str):
    """A table occurs only as the second argument of interp; the error says how to write it."""
    with pytest.raises(ExpressionError) as caught:
        parse(text, ["x"], tables=["ocv"])
    assert caught.value.column == column
    assert says in f"{caught.value.problem}; {caught.value.remedy}"


def test_a_table_is_shown_as_a_function():
    """interp(x, ocv) is set as ocv(x)."""
    shown = mathml("2*interp(soc, ocv_1)", ["soc"], tables=["ocv_1"])
    assert "interp" not in shown
    assert "ocv" in shown and "soc" in shown
