"""Files made to harm: what is unpacked is bounded, nothing outside of the file is read, and damage is refused."""

import bz2
import gzip
import io
import lzma
import os
import pickle
import struct
import tracemalloc
import zipfile
import zlib

import h5py
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.records.tank import rows, text
from tests.records.test_formats import FILES, archive, hdf5
from thetascope.engine.errors import SpecError
from thetascope.records import table
from thetascope.records.readers import mat5, spreadsheet, unpacking
from thetascope.records.readers.formats import read_table

MB = 1024**2
SMALL = 4 * MB
"""The most bytes of an unpacked file in these tests."""


@pytest.fixture
def small(monkeypatch):
    """Let files unpack to few bytes, so that bombs can be small as well."""
    for module in (table, unpacking, mat5):
        monkeypatch.setattr(module, "MOST_BYTES", SMALL)
    monkeypatch.setattr(spreadsheet, "MOST_CELLS", 10**6)
    monkeypatch.setattr(spreadsheet, "_MOST_ROWS", 20_000)


def sheet(cells: str) -> bytes:
    """Return a workbook with a sheet of the given XML."""
    plain = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'
    relation = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = "http://schemas.openxmlformats.org/package/2006"
    office = "application/vnd.openxmlformats-officedocument.spreadsheetml"
    target = f'<Relationship Id="r1" Type="{relation}/worksheet" Target="worksheets/sheet1.xml"/>'
    types = (
        f'<Override PartName="/xl/workbook.xml" ContentType="{office}.sheet.main+xml"/>'
        f'<Override PartName="/xl/worksheets/sheet1.xml" ContentType="{office}.worksheet+xml"/>'
    )
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{package}/content-types">{types}</Types>',
        "_rels/.rels": f'<Relationships xmlns="{package}/relationships"><Relationship Id="r0" '
        f'Type="{relation}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}/relationships">{target}</Relationships>',
        "xl/workbook.xml": f'<workbook {plain} xmlns:r="{relation}"><sheets><sheet name="a" sheetId="1" r:id="r1"/>'
        "</sheets></workbook>",
        "xl/worksheets/sheet1.xml": f"{cells.partition('<')[0]}<worksheet {plain}><sheetData>"
        f"{cells[len(cells.partition('<')[0]) :]}</sheetData></worksheet>",
    }
    return archive(**{name: content.encode() for name, content in parts.items()})


def lying_zip() -> bytes:
    """Return an archive whose member says that it is small."""
    data = bytearray(archive(a=b"1,2\n" * (10 * MB)))
    for mark, offset in ((b"PK\x01\x02", 24), (b"PK\x03\x04", 22)):
        place = data.find(mark)
        data[place + offset : place + offset + 4] = struct.pack("<I", 1000)
    return bytes(data)


def matlab_bomb() -> bytes:
    """Return a MATLAB file with a packed variable of many zeros."""
    packer = zlib.compressobj(9)
    content = b"".join([packer.compress(bytes(8 * MB)) for _ in range(5)]) + packer.flush()
    return b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + struct.pack("<II", 15, len(content)) + content


def huge_shape(file: h5py.File) -> None:
    file.create_dataset("y", shape=(10**9, 50), chunks=(1000, 50), dtype="f8")


def row(number: int) -> str:
    return f'<row r="{number}"><c r="A{number}"><v>1</v></c><c r="XFD{number}"><v>2</v></c></row>'


BOMBS = {
    "gzip": lambda: gzip.compress(bytes(40 * MB), 9),
    "gzip in gzip": lambda: gzip.compress(gzip.compress(bytes(40 * MB), 9), 9),
    "bzip2": lambda: bz2.compress(bytes(40 * MB)),
    "xz": lambda: lzma.compress(bytes(40 * MB), preset=1),
    "zip": lambda: archive(a=bytes(40 * MB)),
    "matlab": matlab_bomb,
    "hdf5 with a huge shape": lambda: hdf5(huge_shape),
    "workbook with far cells": lambda: sheet("".join(row(k) for k in range(1, 300))),
    "workbook with a far row": lambda: sheet('<row r="1"><c r="A1"><v>1</v></c></row><row r="99999999"><c/></row>'),
    "a long line": lambda: b"t,y\n" + b"1" * 200_000,
    "many columns": lambda: ",".join(f"c{k}" for k in range(3000)).encode() + b"\n" + b",".join([b"1"] * 3000),
    "deep JSON": lambda: b"[" * 100_000,
}


@pytest.mark.usefixtures("small")
@pytest.mark.parametrize("name", BOMBS)
def test_a_bomb_is_refused_before_it_unpacks(name):
    """Memory stays within the size that a file may have unpacked."""
    data = BOMBS[name]()
    tracemalloc.start()
    try:
        with pytest.raises(SpecError):
            read_table("a", data)
        assert tracemalloc.get_traced_memory()[1] < 10 * SMALL
    finally:
        tracemalloc.stop()


@pytest.mark.usefixtures("small")
def test_a_zip_that_lies_about_its_size_is_refused():
    """No more is unpacked than it declares."""
    with pytest.raises(SpecError, match="unpacked"):
        read_table("a.zip", lying_zip())


class Harm:
    """An object that creates a file when it is unpickled."""

    def __init__(self, path: str) -> None:
        self.path = path

    def __reduce__(self):
        return os.mkdir, (self.path,)


def test_pickled_objects_are_never_loaded(tmp_path):
    """Neither as a file nor within HDF5 attributes of tables."""
    harm = pickle.dumps(Harm(str(tmp_path / "harm")))

    def fill(file: h5py.File) -> None:
        file["y"] = np.arange(5.0)
        file["y"].attrs["units"] = np.void(harm)
        file["objects"] = np.void(harm)

    for data in (harm, hdf5(fill)):
        try:
            read_table("a", data)
        except SpecError as refusal:
            assert "loading them runs code" in str(refusal)
    assert not (tmp_path / "harm").exists()


def test_hdf5_reads_nothing_outside_of_the_file(tmp_path):
    """External links are not followed; data in external files and virtual datasets are refused."""
    secret = tmp_path / "secret.h5"
    with h5py.File(secret, "w") as file:
        file["y"] = np.full(50, 4711.0)
    (tmp_path / "raw").write_bytes(np.full(50, 4711.0).tobytes())

    def linked(file: h5py.File) -> None:
        file["t"] = np.arange(50.0)
        file["y"] = h5py.ExternalLink(str(secret), "/y")

    def external(file: h5py.File) -> None:
        file.create_dataset("y", shape=(50,), dtype="f8", external=[(str(tmp_path / "raw"), 0, 400)])

    def virtual(file: h5py.File) -> None:
        layout = h5py.VirtualLayout(shape=(50,), dtype="f8")
        layout[:] = h5py.VirtualSource(str(secret), "y", shape=(50,))
        file.create_virtual_dataset("y", layout)

    def circle(file: h5py.File) -> None:
        file["t"] = np.arange(50.0)
        file["a/b"] = file["/"]

    assert [column.name for column in read_table("a", hdf5(linked)).columns] == ["t"]
    assert [column.name for column in read_table("a", hdf5(circle)).columns] == ["t"]
    for fill in (external, virtual):
        with pytest.raises(SpecError, match="another file"):
            read_table("a", hdf5(fill))


def test_a_workbook_reads_nothing_outside_of_itself(tmp_path):
    """An external entity is not resolved, and entities do not multiply."""
    (tmp_path / "secret").write_text("4711")
    entity = f'<!DOCTYPE w [<!ENTITY s SYSTEM "file://{tmp_path / "secret"}">]>'
    multiplied = (
        "<!DOCTYPE w [<!ENTITY a0 'ha'>" + "".join(f"<!ENTITY a{k + 1} '{f'&a{k};' * 10}'>" for k in range(9)) + "]>"
    )
    for head, use in ((entity, "&s;"), (multiplied, "&a9;")):
        cells = '<row r="1"><c r="A1" t="inlineStr"><is><t>y</t></is></c></row>' + "".join(
            f'<row r="{k}"><c r="A{k}" t="inlineStr"><is><t>{use}</t></is></c></row>' for k in (2, 3, 4)
        )
        data = sheet(cells)
        with zipfile.ZipFile(io.BytesIO(data)) as packed:
            parts = {name: packed.read(name) for name in packed.namelist()}
        parts["xl/worksheets/sheet1.xml"] = head.encode() + parts["xl/worksheets/sheet1.xml"]
        try:
            shown = str(read_table("a.xlsx", archive(**parts)))
        except SpecError as refusal:
            shown = str(refusal)
        assert "4711" not in shown and "hahaha" not in shown


def test_cells_are_never_evaluated():
    """Formulas, code and format codes are words."""
    words = ["=1+1", "__import__('os').system('true')", "{0.__class__}", "%s%s%s", "=cmd|' /C calc'!A0"]
    data = text([[k, 50, word] for k, word in enumerate(words * 20)])
    column = read_table("a.csv", data.encode()).columns[2]
    assert column.kind == "text" and column.first[0] == "=1+1"


BINARY = {name: data for name, (_, data) in FILES.items() if name not in ("xz", "bzip2")}


@pytest.mark.parametrize("name", BINARY)
@given(st.data())
@settings(max_examples=12, deadline=None)
def test_damaged_files_are_refused_or_read_in_part(name, data):
    """Bytes are overwritten, cut and doubled: the answer is a table or a refusal, never another error."""
    content = bytearray(BINARY[name][:60_000])
    for _ in range(data.draw(st.integers(1, 6))):
        place = data.draw(st.integers(0, len(content) - 1))
        length = data.draw(st.sampled_from([1, 1, 4, 64]))
        content[place : place + length] = data.draw(st.binary(min_size=length, max_size=length))
    cut = data.draw(st.integers(len(content) // 2, len(content)))
    try:
        found = read_table("a.mat" if "matlab" in name else "a", bytes(content[:cut]))
    except SpecError as refusal:
        assert refusal.problem.code.startswith("record.")
    else:
        assert all(len(column.values) == len(found) for column in found.columns)


@given(
    st.binary(max_size=300),
    st.sampled_from([b"", b"t,y\n0,1\n", b"PAR1", b"\x89HDF\r\n\x1a\n", b"ARROW1", b"{", b"[", b"TDSm"]),
)
@settings(max_examples=150, deadline=None)
def test_random_bytes_are_refused_or_read(noise, head):
    """Nothing but a table or a refusal comes of them."""
    try:
        found = read_table("a", head + noise)
    except SpecError as refusal:
        assert refusal.problem.code.startswith("record.")
    else:
        assert all(len(column.values) == len(found) for column in found.columns)


@given(st.text(alphabet=st.sampled_from("0123456789.,;:-+eE\"'\t \n#%/()[]°µNaNinf年TZ"), max_size=400))
@settings(max_examples=300, deadline=None)
def test_random_text_is_refused_or_read(words):
    """Separators, quotes, dates and numbers in any order."""
    try:
        found = read_table("a.csv", words.encode())
    except SpecError as refusal:
        assert refusal.problem.code.startswith("record.")
    else:
        assert all(len(column.values) == len(found) for column in found.columns)


@pytest.mark.parametrize(
    "content", ["{}", "[]", "[{}, {}]", "{}\n{}\n{}", '{"a": {}}', '[{"a": {}}, {}]', "[[]]", "null"]
)
def test_a_file_without_a_column_is_refused(content):
    """JSON that holds no value."""
    with pytest.raises(SpecError) as refusal:
        read_table("a.json", content.encode())
    assert refusal.value.problem.code.startswith("record.")


def test_a_table_may_have_so_many_cells_and_no_more(monkeypatch):
    """The limit is checked with the numbers of rows and columns in the sentence."""
    monkeypatch.setattr(table, "MOST_ROWS", 100)
    with pytest.raises(SpecError, match="400 rows, and 100 are allowed"):
        read_table("a.csv", text(rows()).encode())
