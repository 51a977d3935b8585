"""Files written from a result read back to the same numbers."""

import base64
import csv
import io

import numpy as np
import orjson
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.io import loadmat

from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.export import (
    Table,
    comparison_csv,
    csv_chunks,
    json_bytes,
    json_chunks,
    matlab_bytes,
    matlab_names,
    select,
)
from thetascope.export.csv_format import as_text
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.comparison import Comparison

FLOATS = st.floats(allow_nan=True, allow_infinity=True, width=64)


def result(rows: int = 101) -> Result:
    """Return t = 0, 0.1, … with a state, a fault and an observer's estimate of each."""
    names = ("t", "x.x1", "theta.f", "a.x.x1", "a.theta.f")
    data = np.vstack([np.arange(rows) * 0.1, np.random.default_rng(1).standard_normal((4, rows))])
    return Result(names, data, (), None, 0.1, 1, (), {})


def read_csv(content: bytes) -> tuple[list[str], np.ndarray]:
    """Return a CSV file read by Python's own reader."""
    head, *rows = csv.reader(io.StringIO(content.decode()))
    return head, np.array([[float(text) for text in row] for row in rows]).reshape(-1, len(head))


@given(arrays(np.float64, st.tuples(st.integers(1, 4), st.integers(0, 6)), elements=FLOATS))
def test_csv_reads_back_to_the_same_floats(data):
    """Every float64, with nan and infinities, has the same bits (nan as a nan)."""
    table = Table(tuple(f"c{i}" for i in range(len(data))), data)
    head, found = read_csv(b"".join(csv_chunks(table)))
    assert tuple(head) == table.names
    assert np.array_equal(found, data.T, equal_nan=True)
    assert np.array_equal(np.signbit(found), np.signbit(data.T) & ~np.isnan(data.T))


def test_csv_does_not_depend_on_the_blocks_and_has_at_most_17_digits():
    """10 000 rows are several blocks; no row is lost or doubled between them."""
    whole = select(result(10_001))
    content = b"".join(csv_chunks(whole))
    assert np.array_equal(read_csv(content)[1], whole.data.T)
    digits = [text.lstrip("-").replace(".", "").split("e")[0].lstrip("0") for text in content.decode().split(",")[6:]]
    assert max(len(text.split("\n")[0]) for text in digits) <= 17


def test_json_has_columns_with_null_for_missing_values():
    """NaN is not valid JSON."""
    table = Table(("t", "x"), np.array([[0.0, 1.0], [np.nan, 0.1]]))
    assert orjson.loads(json_bytes(table)) == {"rows": 2, "columns": {"t": [0.0, 1.0], "x": [None, 0.1]}}


def test_json_does_not_depend_on_the_pieces():
    """20 001 rows are several pieces of each column; they are what orjson makes of the whole columns."""
    table = select(result(20_001))
    columns = {name: np.ascontiguousarray(column) for name, column in zip(table.names, table.data, strict=True)}
    whole = orjson.dumps({"rows": table.rows, "columns": columns}, option=orjson.OPT_SERIALIZE_NUMPY)
    assert json_bytes(table) == whole and max(len(piece) for piece in json_chunks(table)) < 200_000
    found = orjson.loads(json_bytes(table, "bdata"))["columns"]
    for name, column in columns.items():
        assert found[name]["dtype"] == "f8" and base64.b64decode(found[name]["bdata"]) == column.tobytes()


def test_json_bdata_is_little_endian_float64_for_strided_views():
    """A view with gaps is packed before it is sent."""
    table = select(result(), every=3)
    found = orjson.loads(json_bytes(table, "bdata"))["columns"]
    for name, column in zip(table.names, table.data, strict=True):
        assert np.array_equal(np.frombuffer(base64.b64decode(found[name]["bdata"]), "<f8"), column)


def test_mat_has_valid_names_and_the_true_names_in_a_cell_array():
    """Dots become underscores; `columns` and `variables` map them."""
    table = select(result())
    found = loadmat(io.BytesIO(matlab_bytes(table)))
    names = [str(cell[0]) for cell in found["columns"].ravel()]
    variables = [str(cell[0]) for cell in found["variables"].ravel()]
    assert names == list(table.names)
    assert variables == ["t", "x_x1", "theta_f", "a_x_x1", "a_theta_f"]
    for variable, column in zip(variables, table.data, strict=True):
        assert np.array_equal(found[variable], column[:, None])


@given(st.lists(st.text(st.characters(codec="utf-8"), min_size=1, max_size=90), unique=True, max_size=12))
def test_matlab_names_are_valid_and_distinct_for_any_names(names):
    """MATLAB requires a letter first, then letters, digits and underscores, at most 63 in all."""
    made = matlab_names(names)
    assert len(set(made)) == len(names)
    assert all(name.isascii() and name.isidentifier() and name[0].isalpha() and len(name) <= 63 for name in made)


def test_a_range_includes_both_ends_despite_rounding():
    """0.1·3 is not 0.3, but the row is included."""
    assert select(result(), start=0.3, end=0.7).data[0] == pytest.approx([0.3, 0.4, 0.5, 0.6, 0.7])


def test_points_bounds_the_rows_and_keeps_the_first():
    """Decimation is uniform and never returns more rows than requested."""
    for points in (1, 2, 7, 50, 100, 101, 500):
        table = select(result(), points=points)
        assert 1 <= table.rows <= points
        assert table.data[0, 0] == 0
    assert select(result(), points=500).rows == 101


def test_columns_are_selected_by_name_and_pattern_in_the_given_order():
    """Each once, even if two patterns match it."""
    table = select(result(), ["theta.*", "t", "a.theta.f", "*.f"])
    assert table.names == ("theta.f", "t", "a.theta.f")
    assert np.array_equal(table.data[1], result().data[0])


def test_an_unknown_column_is_refused_with_the_nearest():
    """The remedy names the nearest column."""
    with pytest.raises(SpecError, match=r"'a\.theta\.g'.*did you mean a\.theta\.f"):
        select(result(), ["t", "a.theta.g"])


def test_a_range_without_rows_gives_an_empty_table_in_every_format():
    """It is not an error."""
    table = select(result(), start=200.0)
    assert table.rows == 0
    assert b"".join(csv_chunks(table)).count(b"\n") == 1
    assert orjson.loads(json_bytes(table))["rows"] == 0
    assert loadmat(io.BytesIO(matlab_bytes(table)))["t"].size == 0


def test_a_comparison_as_csv_has_one_measure_per_line():
    """Errors with windows and units, a line per count, `nan` for a missing value; numbers read back the same."""
    plant = Plant.model_validate(
        {
            "id": "p",
            "states": [{"name": "x1", "unit": "m"}],
            "outputs": [{"name": "y", "expression": "x1"}],
            "dynamics": {"x1": "0"},
            "channels": [{"name": "theta3", "kind": "sensor", "enters": {"y": 1}, "unit": "m/s"}],
        }
    )
    example = Comparison.model_json_schema()["examples"][0]
    example["observers"][0] |= {"false_alarms": None, "rmse": {"x.x1": [0.1 + 0.2, None]}, "peak": {}}
    content = comparison_csv(Comparison.model_validate(example), plant).decode()
    head, *lines = csv.reader(io.StringIO(content))
    assert head == ["observer", "measure", "of", "from", "until", "value", "unit"]
    assert all(line[0] == "adaptive" and len(line) == len(head) for line in lines)
    assert lines[0] == ["adaptive", "rmse", "x.x1", "0", "20", repr(0.1 + 0.2), "m"]
    assert lines[1][5] == "nan"
    found = {line[1]: line[2:] for line in lines}
    assert found["settling-10"] == ["theta.theta3", "20", "", "0.77", "s"]
    assert found["delay"] == ["theta.theta3", "20", "", "0.6", "s"] and found["fault-found"][3] == "1"
    assert (found["found"][3], found["false-alarms"][3], found["cost"][3:]) == ("1", "nan", ["57.8", "us/s"])


FORMULAS = ["=1+1", "+1", "-1", "@SUM(1)", "\t=1", "\r=1", " =1", "\n=1", "＝1", '=HYPERLINK("x")']


@pytest.mark.parametrize("text", FORMULAS)
def test_a_unit_never_becomes_a_formula(text):
    """Units and labels are free text; a spreadsheet shows those that look like a formula as text."""
    plant = Plant.model_validate(
        {
            "id": "p",
            "states": [{"name": "x1"}],
            "outputs": [{"name": "y", "expression": "x1"}],
            "dynamics": {"x1": "0"},
        }
    )
    plant = plant.model_copy(update={"states": (plant.states[0].model_copy(update={"unit": text}),)})
    content = comparison_csv(Comparison.model_validate(Comparison.model_json_schema()["examples"][0]), plant).decode()
    lines = list(csv.reader(io.StringIO(content)))
    assert {len(line) for line in lines} == {7}
    units = {line[6] for line in lines if line[2] == "x.x1"}
    assert units == {"'" + text.translate({9: " ", 10: " ", 13: " "})}


@given(st.text(st.characters(exclude_categories=["Cc"]), max_size=8))
def test_ordinary_text_stays_as_it_is(text):
    """Only text that begins like a formula is changed, and only by an apostrophe before it."""
    formula = text.lstrip()[:1] in tuple("=+-@＝＋－＠")
    assert as_text(text) == (f"'{text}" if formula else text)
