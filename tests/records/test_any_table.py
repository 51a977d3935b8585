"""Whatever numbers a file holds, its inspection is an answer: complete, finite, and the same when it is asked again."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.records.tank import FACTS, plant
from thetascope.engine.errors import SpecError
from thetascope.records.columns.mapping import quantities_of
from thetascope.records.document import About, inspection_of, preview_of
from thetascope.records.inspection import inspect
from thetascope.records.readers.formats import read_table
from thetascope_schemas.experiment.measurement import ColumnMapping
from thetascope_schemas.service.record_inspection import RecordInspection

CELLS = st.one_of(
    st.floats(width=64).map(repr),
    st.integers(-(10**19), 10**19).map(str),
    st.sampled_from(
        ["", "NaN", "-9999", "1e308", "-1e308", "5e-324", "0", "1", "1", "20", "OK", "2024-03-01T00:00:01", "12:00"]
    ),
)
HEADS = (
    ("t", "q", "y"),
    ("time [min]", "q (L/min)", "y [m]"),
    ("a", "b", "c"),
    ("t_ns", "y", "q [%]"),
    ("Date", "q", "y"),
)
MAPPINGS = (
    {},
    {"time": {"period": 1e-300}},
    {"time": {"period": 1e300}},
    {"quantities": {"y": {"factor": 1e300, "column": None}}},
    {"time": {"unit": "epoch-ns"}},
    {"time": {"unit": "spreadsheet-days"}},
)


@pytest.mark.filterwarnings("error::RuntimeWarning")
@given(
    st.lists(st.tuples(CELLS, CELLS, CELLS), min_size=1, max_size=25), st.sampled_from(HEADS), st.sampled_from(MAPPINGS)
)
@settings(max_examples=80, deadline=None)
def test_every_table_of_numbers_has_an_inspection(rows, head, mapping):
    """A document that JSON can say, and a recording with times that increase and inputs without gaps; or a refusal."""
    data = "\n".join(",".join(row) for row in [head, *rows]).encode()
    try:
        asked = ColumnMapping.model_validate(mapping)
        found = inspect(read_table("a.csv", data), quantities_of(plant()), FACTS, asked)
    except SpecError as refusal:
        assert refusal.problem.code.startswith("record.")
        return
    document = inspection_of(found, About("x", "a.csv", len(data), "tank"))
    assert RecordInspection.model_validate_json(document.model_dump_json()) == document
    preview_of(found, 10).model_dump_json()
    recording = found.recording
    assert (recording is None) == (found.problem is not None) == (not document.ready)
    if recording is not None:
        assert (np.diff(recording.t) > 0).all() and np.isfinite(recording.t).all() and np.isfinite(recording.u).all()
        assert len(recording.t) == len(recording.y) == len(recording.line) == len(recording.held)
