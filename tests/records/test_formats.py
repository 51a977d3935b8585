"""Every file format gives the columns that were written, with their units and rows."""

import bz2
import datetime
import gzip
import io
import json
import lzma
import zipfile
from collections.abc import Callable

import h5py
import numpy as np
import openpyxl
import polars
import pytest
from scipy import io as scipy_io

from tests.records.tank import ROWS, Q, T, Y, inspected, rows, text
from thetascope.engine.errors import SpecError
from thetascope.records.readers.formats import read_table

DATES = np.datetime64("2024-03-01T08:00:00", "ms") + (1000 * T).astype("m8[ms]")
FRAME = polars.DataFrame({"t": T, "q": Q, "y": Y, "status": ["OK"] * ROWS})


def written(write: Callable[[io.BytesIO], object]) -> bytes:
    buffer = io.BytesIO()
    write(buffer)
    return buffer.getvalue()


def workbook() -> bytes:
    book = openpyxl.Workbook()
    book.active.append(["see the other sheet"])
    sheet = book.create_sheet("run 7")
    sheet.append(["Rig 7"])
    sheet.append([])
    sheet.append(["when", "q", "y", "status"])
    sheet.append([None, "cm3/s", "cm", None])
    for when, (_, q, y) in zip(DATES.astype(datetime.datetime), rows(), strict=True):
        sheet.append([when, q, y, "OK"])
    return written(book.save)


def hdf5(fill: Callable[[h5py.File], None], **more: int) -> bytes:
    def write(buffer: io.BytesIO) -> None:
        with h5py.File(buffer, "w", **more) as file:
            fill(file)

    return written(write)


def groups(file: h5py.File) -> None:
    for name, values in (("t", T), ("q", Q), ("y", Y)):
        file.create_dataset(f"rig/run 7/{name}", data=values, compression="gzip")
    file["rig/run 7/y"].attrs["units"] = "cm"
    file["rig/rate"], file["rig/notes"] = 1.0, "healthy"


def compound(file: h5py.File) -> None:
    file["run"] = np.array(list(zip(T, Q, Y, strict=True)), dtype=[("t", "f8"), ("q", "f4"), ("y", "f8")])


def pandas_frame(file: h5py.File) -> None:
    group = file.create_group("df")
    group.attrs["pandas_type"] = "frame"
    group["axis0"] = np.array([b"t", b"q", b"y"])
    group["axis1"] = np.arange(ROWS)
    group["block0_items"], group["block0_values"] = np.array([b"t", b"q", b"y"]), np.stack([T, Q, Y], axis=1)


def matlab73() -> bytes:
    def fill(file: h5py.File) -> None:
        for name, values in (("t", T), ("q", Q), ("y", Y)):
            file.create_dataset(f"run/{name}", data=values[None, :]).attrs["MATLAB_class"] = np.bytes_("double")

    content = hdf5(fill, userblock_size=512)
    return b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512) + content[512:]


def matlab(content: dict, **more: object) -> bytes:
    return written(lambda buffer: scipy_io.savemat(buffer, content, **more))


def simulink() -> dict:
    signals = np.array([({"values": Q}, "q"), ({"values": Y}, "y")], dtype=object)
    entries = [{"values": inner["values"], "label": label} for inner, label in signals]
    return {"out": {"time": T, "signals": np.array(entries, dtype=object)}}


def archive(**files: bytes) -> bytes:
    def write(buffer: io.BytesIO) -> None:
        with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as packed:
            for name, content in files.items():
                packed.writestr(name, content)

    return written(write)


def tdms() -> bytes:
    from nptdms import ChannelObject, TdmsWriter

    def write(buffer: io.BytesIO) -> None:
        with TdmsWriter(buffer) as file:
            own = {"wf_increment": 1.0, "unit_string": "cm3/s"}
            file.write_segment([ChannelObject("rig", "q", Q, own), ChannelObject("rig", "y", Y, {"wf_increment": 1.0})])

    return written(write)


def mcap() -> bytes:
    from mcap.writer import Writer

    def write(buffer: io.BytesIO) -> None:
        file = Writer(buffer)
        file.start()
        schema = file.register_schema("value", "jsonschema", b"{}")
        places = {name: file.register_channel(f"/rig/{name}", "json", schema) for name in ("q", "y")}
        for t, q, y in rows():
            for name, value in (("q", q), ("y", y)):
                data = json.dumps({"value": value}).encode()
                file.add_message(places[name], 10**18 + t * 10**9, data, 0)
        file.finish()

    return written(write)


NESTED = [{"t": t, "v": {"q": q, "y": y}} for t, q, y in rows()]
COLUMNS = {"t": T.tolist(), "q": Q.tolist(), "y": Y.tolist()}
CSV = text(rows()).encode()
FILES = {
    "parquet": ("parquet", written(FRAME.write_parquet)),
    "parquet with dates": ("parquet", written(FRAME.with_columns(t=polars.Series(DATES)).write_parquet)),
    "arrow": ("arrow", written(FRAME.write_ipc)),
    "arrow, packed": ("arrow", written(lambda b: FRAME.write_ipc(b, compression="zstd"))),
    "arrow stream": ("arrow", written(FRAME.write_ipc_stream)),
    "xlsx": ("xlsx", workbook()),
    "json lines": ("jsonl", written(FRAME.write_ndjson)),
    "json lines, cut off": ("jsonl", written(FRAME.write_ndjson) + b'{"t": 400, "q'),
    "json lines, nested": (
        "jsonl",
        "\n".join(json.dumps({"t": t, "v": {"q": q, "y": y}}) for t, q, y in rows()).encode(),
    ),
    "json objects": ("json", written(FRAME.write_json)),
    "json columns": ("json", json.dumps(COLUMNS).encode()),
    "json columns by row": ("json", json.dumps({n: dict(enumerate(v)) for n, v in COLUMNS.items()}).encode()),
    "json rows": ("json", json.dumps([["t", "q", "y"], *rows()]).encode()),
    "json split": ("json", json.dumps({"columns": ["t", "q", "y"], "data": rows()}).encode()),
    "hdf5 groups": ("hdf5", hdf5(groups)),
    "hdf5 table": ("hdf5", hdf5(compound)),
    "hdf5 of pandas": ("hdf5", hdf5(pandas_frame)),
    "matlab 7.3": ("mat", matlab73()),
    "matlab 5": ("mat", matlab({"t": T, "q": Q, "y": Y, "rate": 1.0, "note": "healthy"})),
    "matlab 5, packed": ("mat", matlab({"t": T, "q": Q[:, None], "y": Y}, do_compression=True)),
    "matlab 4": ("mat", matlab({"t": T, "q": Q, "y": Y}, format="4")),
    "matlab structure": ("mat", matlab({"run": {"t": T, "data": {"q": Q, "y": Y}}})),
    "matlab matrix with names": (
        "mat",
        matlab({"data": np.stack([T, Q, Y], axis=1), "names": np.array(["t", "q", "y"], dtype=object)}),
    ),
    "simulink": ("mat", matlab(simulink())),
    "tdms": ("tdms", tdms()),
    "mcap": ("mcap", mcap()),
    "bzip2": ("csv", bz2.compress(CSV)),
    "xz": ("csv", lzma.compress(CSV)),
    "two gzip members": ("csv", gzip.compress(CSV[:1000]) + gzip.compress(CSV[1000:])),
    "zip": ("csv", archive(**{"rig/a.csv": CSV, "__MACOSX/a": b"x"})),
    "packed twice": ("csv", gzip.compress(gzip.compress(CSV))),
    "packed parquet": ("parquet", gzip.compress(written(FRAME.write_parquet))),
}


@pytest.mark.parametrize("name", FILES)
def test_every_format_gives_the_same_recording(name):
    """The format is found from the bytes, whatever the file is called; numbers are those that were written."""
    format, data = FILES[name]
    found = inspected(data, "rig.mat" if name == "matlab 4" else "rig.dat")
    assert found.table.format == format and found.problem is None, found.problem
    recording = found.recording
    assert recording.t - recording.t[0] == pytest.approx(T, abs=1e-9)
    assert np.array_equal(recording.u[:, 0], Q) and recording.y[:, 0] == pytest.approx(Y, rel=1e-14)


def test_a_matrix_without_names_is_mapped_by_order_and_marked():
    """Its first column increases and is the time; the others have to be looked at."""
    found = inspected(matlab({"data": np.stack([T, Q, Y], axis=1), "rate": 1.0}))
    assert [(t.column, t.certain) for t in found.mapping.taken] == [("data_2", False), ("data_3", False)]
    assert np.array_equal(found.recording.t, T) and np.array_equal(found.recording.y[:, 0], Y)


def test_units_come_from_the_files_metadata():
    """Attributes of HDF5, properties of TDMS, the line below the names in a workbook."""
    for name, unit in (("hdf5 groups", ("", "cm")), ("tdms", ("cm3/s", "")), ("xlsx", ("cm3/s", "cm"))):
        table = inspected(FILES[name][1]).table
        units = {column.name.rpartition(".")[2]: column.unit for column in table.columns}
        assert (units["q"], units["y"]) == unit, name


def test_rows_of_a_workbook_are_numbered_as_in_the_sheet():
    """The first row of data is row 5; the other sheet is named."""
    found = inspected(FILES["xlsx"][1])
    assert found.table.lines[:2].tolist() == [5, 6]
    assert any("Sheet" in str(finding.text) for finding in found.findings)


def test_channels_of_several_rates_are_put_on_all_their_times():
    """A slow input among fast outputs has readings only where it was read, and is held in between."""
    from mcap.writer import Writer

    def write(buffer: io.BytesIO) -> None:
        file = Writer(buffer)
        file.start()
        q, y = (file.register_channel(name, "json", 0) for name in ("q", "y"))
        for k in range(100):
            file.add_message(y, k * 10**8, json.dumps(20 + 0.01 * (k % 7)).encode(), 0)
            if k % 10 == 0:
                file.add_message(q, k * 10**8, json.dumps(50 + k).encode(), 0)
        file.finish()

    recording = inspected(written(write)).recording
    assert len(recording) == 100 and recording.held[:, 0].sum() == 90 and not np.isnan(recording.y).any()
    assert recording.u[::10, 0].tolist() == recording.u[9::10, 0].tolist() == [50 + k for k in range(0, 100, 10)]


def test_a_format_whose_package_is_not_installed_names_the_extra(monkeypatch):
    """The remedy is the command that installs it."""
    monkeypatch.setitem(__import__("sys").modules, "nptdms", None)
    with pytest.raises(SpecError) as refusal:
        read_table("a.tdms", FILES["tdms"][1])
    assert "thetascope[tdms]" in str(refusal.value)


@pytest.mark.parametrize(
    ("data", "code"),
    [
        (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(100), "record.file.xls"),
        (b"FEA1" + bytes(100), "record.file.feather1"),
        (b"\x93NUMPY" + bytes(100), "record.file.npy"),
        (b"%PDF-1.7", "record.file.pdf"),
        (b"t,y\n" + bytes(range(256)) * 4, "record.file.binary"),
        (archive(a=CSV, b=CSV), "record.file.several"),
        (b"[1, 2", "record.json.invalid"),
        (b'{"t": 1}\n{"t": 2\n{"t": 3}\n', "record.json.invalid"),
        (b'{"t": [1, 2], "y": [1]}', "record.columns.uneven"),
        (b'[["t", "y"], [1, 2], [3]]', "record.csv.row"),
    ],
)
def test_other_files_are_refused_with_a_remedy(data, code):
    """The problem says what the file is, the remedy how to save it."""
    with pytest.raises(SpecError) as refusal:
        inspected(data)
    assert refusal.value.problem.code == code and str(refusal.value.remedy) != refusal.value.remedy.code
