"""One record in the forms in which records come: what is read is always the same, and what was done is listed."""

import datetime
import gzip

import numpy as np
import pytest

from tests.records.tank import ROWS, Q, T, Y, changed, inspected, kinds, rows, text
from thetascope.engine.errors import SpecError

START = datetime.datetime(2024, 3, 1, 23, 57)
ALL = np.arange(ROWS)


def with_times(make) -> str:
    return text([[make(t), q, y] for t, q, y in rows()])


def clock(t: int) -> str:
    return (START + datetime.timedelta(seconds=t)).strftime("%H:%M:%S")


LABVIEW = """LabVIEW Measurement	
Separator	Tab
X_Columns	One
Date	2024/03/01
***End_of_Header***	
	
Channels	2
Samples	400	400
Date	2024/03/01	2024/03/01
Y_Unit_Label	cm3/s	cm
X0	0.0E+0	0.0E+0
Delta_X	1.0	1.0
***End_of_Header***		
"""
CAMPBELL = """"TOA5","CR1000","CR1000","12345","Table1"
"TIMESTAMP","RECORD","q","y"
"TS","RN","cm3/s","cm"
"","","Avg","Smp"
"""
SAME = {
    "labview": LABVIEW + text(rows(), "X_Value\tq\ty\tComment", "\t"),
    "campbell": CAMPBELL
    + text(
        [[(START + datetime.timedelta(seconds=t)).isoformat(" "), *row] for t, *row in ([r[0], *r] for r in rows())], ""
    ).lstrip("\n"),
    "as it is": text(rows()),
    "no last line end": text(rows()).rstrip(),
    "carriage returns": text(rows()).replace("\n", "\r\n"),
    "old line ends": text(rows()).replace("\n", "\r"),
    "byte-order mark": "\ufeff" + text(rows()),
    "utf-16": text(rows()).encode("utf-16"),
    "utf-16 without a mark": text(rows()).encode("utf-16-le"),
    "latin-1": text([[*row, 21.5] for row in rows()], "t,q,y,Temp °C").encode("latin-1"),
    "gb2312": text([[*row, "正常"] for row in rows()], "t,q,y,状态").encode("gb2312"),
    "packed": gzip.compress(text(rows()).encode()),
    "semicolons": text(rows(), "t;q;y", ";").replace(".", ","),
    "tabs": text(rows(), "t\tq\ty", "\t"),
    "tabs with decimal commas": text(rows(), "t\tq\ty", "\t").replace(".", ","),
    "vertical bars": text(rows(), "t|q|y", "|"),
    "blanks": text(rows(), "t q y", " "),
    "aligned blanks": "\n".join(["   t    q     y", *(f"{t:5d} {q:6d}  {y:11.5f}" for t, q, y in rows())]),
    "comma and blank": text(rows(), "t, q, y", ", "),
    "declared separator": "sep=;\n" + text(rows(), "t;q;y", ";"),
    "quoted": text([[f'"{c}"' for c in row] for row in rows()], '"t","q","y"'),
    "comments": "# rig 7, March\n% second\n" + text(rows()),
    "names in a comment": "# t q y\n" + text(rows(), "", " ").lstrip("\n"),
    "lines above": "Rig 7\nOperator,Ann\n\n" + text(rows()),
    "units below": text(rows()).replace("\n", "\ns,cm3/s,cm\n", 1),
    "units in brackets below": text(rows()).replace("\n", "\n[s],[cm^3/s],[cm]\n", 1),
    "repeated heads": text(rows()[:150]) + text(rows()[150:]),
    "empty lines": text(rows()).replace("\n", "\n\n"),
    "text column": text([[*row, "OK"] for row in rows()], "t,q,y,status"),
    "index column": text([[k, *row] for k, row in enumerate(rows())], ",t,q,y"),
    "head without the index": text([[k, *row] for k, row in enumerate(rows())], "t,q,y"),
    "trailing comma": text([[*row, ""] for row in rows()], "t,q,y,"),
    "trailing comma in rows only": text([[*row, ""] for row in rows()], "t,q,y"),
    "other names": text(rows(), "Time (s),Flow,Level"),
    "chinese names": text(rows(), "时间,流量,液位"),
    "other order": text([row[::-1] for row in rows()], "y,q,t"),
    "set point": text([[*row, 20] for row in rows()], "t,q,y,Set point (cm)"),
    "minutes": text([[f"{t / 60:.12f}", q, y] for t, q, y in rows()], "time [min],q,y"),
    "milliseconds": text([[1000 * t, q, y] for t, q, y in rows()], "t_ms,q,y"),
    "metres": text([[t, q, f"{y / 100:.9f}"] for t, q, y in rows()], "t,q,y [m]"),
    "litres a minute": text([[t, f"{q * 0.06:.6f}", y] for t, q, y in rows()], "t,q (L/min),y"),
    "units in cells": text([[f"{t} s", q, f"{y / 100:.7f} m"] for t, q, y in rows()]),
    "iso times": with_times(lambda t: (START + datetime.timedelta(seconds=t)).isoformat()),
    "iso times with a zone": with_times(lambda t: (START + datetime.timedelta(seconds=t)).isoformat() + "+08:00"),
    "american dates": with_times(lambda t: (START + datetime.timedelta(seconds=t)).strftime("%m/%d/%Y %I:%M:%S %p")),
    "german dates": with_times(lambda t: (START + datetime.timedelta(seconds=t)).strftime("%d.%m.%Y %H:%M:%S")),
    "chinese dates": with_times(lambda t: (START + datetime.timedelta(seconds=t)).strftime("%Y年%m月%d日 %H:%M:%S")),
    "times of day past midnight": with_times(clock),
    "elapsed times": with_times(lambda t: str(datetime.timedelta(seconds=t))),
    "date and time of day": text(
        [[(START + datetime.timedelta(seconds=t)).strftime("%Y-%m-%d"), clock(t), q, y] for t, q, y in rows()],
        "Date,Time,q,y",
    ),
    "epoch s": with_times(lambda t: 1709280000 + t),
    "epoch ms": with_times(lambda t: 1709280000000 + 1000 * t),
    "epoch ns": with_times(lambda t: f"{1709280000 + t}000000000"),
    "spreadsheet days": with_times(lambda t: f"{45352.5 + t / 86400:.9f}"),
    "reversed": text(rows()[::-1]),
    "a row twice": text([*rows()[:100], rows()[99], *rows()[100:]]),
    "two rows exchanged": text([*rows()[:100], rows()[101], rows()[100], *rows()[102:]]),
    "last line cut off": text(rows()) + "400,5",
}
LISTED = {
    "reversed": {"reversed"},
    "a row twice": {"repeated"},
    "two rows exchanged": {"unordered"},
    "last line cut off": {"cut-off"},
    "repeated heads": {"repeated-head"},
}


@pytest.mark.parametrize("form", SAME)
def test_every_form_gives_the_same_recording(form):
    """Times, inputs and outputs are equal up to rounding; nothing else is found than what the form has."""
    found = inspected(SAME[form])
    assert found.problem is None
    recording = found.recording
    close = 2e-4 if form == "spreadsheet days" else 1e-5 if form.startswith("epoch") else 1e-8
    assert recording.t - recording.t[0] == pytest.approx(T, abs=close)
    assert recording.u[:, 0] == pytest.approx(Q, rel=1e-6) and recording.y[:, 0] == pytest.approx(Y, rel=1e-6)
    assert not recording.held.any() and recording.resolution[0] == 0.0
    assert kinds(found) == LISTED.get(form, set())
    assert found.order.turned == (form == "reversed")


def test_missing_cells_of_an_output_stay_missing():
    """Empty cells, NaN, #N/A and words are missing, and named with their lines; nothing is filled in."""
    for word in ("", "NaN", "#N/A", "null", "Bad", "I/O Timeout", "---", "-"):
        found = inspected(text(changed(range(100, 120), 2, word)))
        (finding,) = [f for f in found.findings if f.kind == "missing"]
        assert np.flatnonzero(np.isnan(found.recording.y[:, 0])).tolist() == list(range(100, 120)), word
        assert (finding.quantity, finding.count, finding.lines[0]) == ("y", 20, 102)
        assert "102–121" in str(finding.text)


def test_missing_cells_of_an_input_are_held_and_named():
    """The value before is held; at the beginning the first one that there is."""
    found = inspected(text(changed((0, 60, 61), 1, "NA")))
    recording = found.recording
    assert np.flatnonzero(recording.held[:, 0]).tolist() == [0, 60, 61]
    assert recording.u[[0, 60, 61, 62], 0].tolist() == [50, 50, 50, 65]
    (finding,) = [f for f in found.findings if f.kind == "missing"]
    assert finding.lines == (2, 62, 63) and str(finding.treatment).endswith("held")


def test_unknown_words_among_numbers_are_missing_and_quoted():
    """A slip of the pen is neither read as a number nor skipped in silence."""
    found = inspected(text(changed((17,), 2, "2O.1")))
    (finding,) = [f for f in found.findings if f.kind == "missing"]
    assert "2O.1" in str(finding.text) and finding.lines == (19,) and np.isnan(found.recording.y[17, 0])


@pytest.mark.parametrize("value", [-9999, -9999.0, 9999, -999.9, 1e30, 65535, -32768, 99999])
@pytest.mark.parametrize("column", [1, 2])
def test_sentinels_are_missing(value, column):
    """Marks far from all other values are missing in inputs and outputs, and the rows are named."""
    found = inspected(text(changed(range(100, 103), column, value)))
    (finding,) = [f for f in found.findings if f.kind == "sentinel"]
    assert finding.lines == (102, 103, 104) and kinds(found) == {"sentinel"}
    recording = found.recording
    places = recording.held[:, 0] if column == 1 else np.isnan(recording.y[:, 0])
    assert np.flatnonzero(places).tolist() == [100, 101, 102]


def test_values_of_a_sensor_are_no_sentinels():
    """Readings near 99, 255 or -1 that belong to the range of the others are kept."""
    for middle in (99, 255, -1, 999.9, -127):
        y = np.round(middle + np.sin(T / 9) + 0.1 * np.random.default_rng(3).standard_normal(ROWS))
        y[200] = middle
        found = inspected(text([[t, q, v] for (t, q, _), v in zip(rows(), y, strict=True)]))
        assert not np.isnan(found.recording.y).any(), middle


def test_missing_rows_and_jitter_keep_their_true_times():
    """Nothing is resampled; a gap is listed with its length, jitter with its share."""
    gap = inspected(text(rows()[:100] + rows()[130:]))
    assert np.array_equal(gap.recording.t, np.delete(T, np.arange(100, 130))) and kinds(gap) == {"gap"}
    (finding,) = gap.findings
    assert finding.times == (99.0,) and finding.until == 130.0 and finding.text.args["n"] == 30
    times = np.round(T + np.random.default_rng(1).uniform(-0.2, 0.2, ROWS), 6)
    jitter = inspected(text([[t, q, y] for t, (_, q, y) in zip(times, rows(), strict=True)]))
    assert np.array_equal(jitter.recording.t, times) and kinds(jitter) == {"jitter"}
    assert jitter.sampling.jitter == pytest.approx(np.std(np.diff(times)), rel=0.01)


@pytest.mark.parametrize("time", [-9999, 0, 1709280000])
def test_a_row_with_a_stray_time_is_left_out(time):
    """One time that is wrong neither moves its row elsewhere nor ends the record."""
    found = inspected(text(changed((150,), 0, time)))
    assert kinds(found) == {"stray-time", "gap"}
    assert [f.lines for f in found.findings if f.kind == "stray-time"] == [(152,)]
    assert np.array_equal(found.recording.t, np.delete(T, 150))


def test_coarse_times_are_spread():
    """Four rows a second whose times are written in whole seconds get times a quarter apart."""
    found = inspected(text([[t // 4, q, y] for t, q, y in rows()]))
    assert np.diff(found.recording.t) == pytest.approx(0.25) and "coarse-times" in kinds(found)


def test_a_record_whose_time_begins_anew_is_refused_with_the_row():
    """Two records in one file are not one."""
    found = inspected(text([*rows()[:200], *rows()[:200]]))
    assert found.recording is None and "begins anew at row 202" in str(found.problem)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (text(rows()[:200]) + "7\n" + text(rows()[200:]).split("\n", 1)[1], "line 202"),
        (text(rows()[:200]) + "1,2,3,4\n" + text(rows()[200:]).split("\n", 1)[1], "line 202"),
        ("", "empty"),
        ("t,q,y\n", "no rows"),
    ],
)
def test_a_refusal_names_the_row(data, words):
    """A row of another length is neither filled up nor cut."""
    with pytest.raises(SpecError, match=words):
        inspected(data)


def test_a_column_of_words_is_refused_by_row_column_and_cell():
    """The output's own column holds texts: the first of them is quoted with its line."""
    found = inspected(text([[t, q, "high"] for t, q, _ in rows()]))
    assert found.recording is None and found.problem.args == {"name": "y", "column": "y", "line": 2, "cell": "high"}


def test_a_file_without_names_is_mapped_by_order_and_marked():
    """Columns are col1, col2, …; a guess by order has to be looked at."""
    found = inspected(text(rows()).split("\n", 1)[1])
    assert [c.name for c in found.table.columns] == ["col1", "col2", "col3"] and not found.table.named
    assert [(t.column, t.certain) for t in found.mapping.taken] == [("col2", False), ("col3", False)]
    assert np.array_equal(found.recording.y[:, 0], Y) and np.array_equal(found.recording.u[:, 0], Q)


def test_names_that_are_numbers_are_names():
    """The first line has a word where the others have times."""
    found = inspected(text(rows(), "time,1,2"))
    assert [c.name for c in found.table.columns] == ["time", "1", "2"] and len(found.table) == ROWS
    slip = inspected(text(changed((0,), 2, "2O.1")))
    assert len(slip.recording) == ROWS and np.isnan(slip.recording.y[0, 0])


def test_a_record_without_times_needs_a_period():
    """It is refused with the remedy, and accepted with a period."""
    data = text([[q, y] for _, q, y in rows()], "q,y")
    assert inspected(data).problem.code == "record.problem.no-time"
    found = inspected(data, mapping={"time": {"period": 0.5}})
    assert np.array_equal(found.recording.t, 0.5 * ALL)


def test_an_input_that_is_missing_has_its_default_and_is_listed():
    """Its rows count as held."""
    found = inspected(text([[t, y] for t, _, y in rows()], "t,y"))
    assert kinds(found) == {"no-input"} and found.recording.held.all() and (found.recording.u == 50).all()
