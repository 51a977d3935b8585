"""Find the format of a file by its first bytes, unpack it within limits, and read it."""

from collections.abc import Callable
from importlib import import_module

from thetascope.engine.errors import SpecError, ThetascopeError
from thetascope.messages import Message
from thetascope.records.readers.unpacking import unpacked
from thetascope.records.table import Table, check_bytes

Reader = Callable[[str, bytes], Table]

_READERS = {
    "csv": ("thetascope.records.text.csv_table", "read_csv"),
    "json": ("thetascope.records.readers.json_table", "read_json"),
    "xlsx": ("thetascope.records.readers.spreadsheet", "read_xlsx"),
    "parquet": ("thetascope.records.readers.columnar", "read_parquet"),
    "arrow": ("thetascope.records.readers.columnar", "read_arrow"),
    "hdf5": ("thetascope.records.readers.hdf5", "read_hdf5"),
    "mat": ("thetascope.records.readers.mat5", "read_mat"),
    "tdms": ("thetascope.records.readers.tdms", "read_tdms"),
    "mdf4": ("thetascope.records.readers.mdf4", "read_mdf4"),
    "mcap": ("thetascope.records.readers.mcap", "read_mcap"),
}
"""The function of each format; modules are imported when a file of their format comes."""

EXTRAS = {"tdms": "tdms", "mdf4": "mdf", "mcap": "mcap"}
"""Formats whose package is optional, and the extra that installs it."""

_MAGIC = (
    (b"PAR1", "parquet"),
    (b"ARROW1", "arrow"),
    (b"\xff\xff\xff\xff", "arrow"),
    (b"\x89HDF\r\n\x1a\n", "hdf5"),
    (b"MATLAB 7.3 MAT-file", "hdf5"),
    (b"MATLAB 5.0 MAT-file", "mat"),
    (b"TDSm", "tdms"),
    (b"MDF     ", "mdf4"),
    (b"\x89MCAP0\r\n", "mcap"),
)
_REFUSED = (
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "xls"),
    (b"FEA1", "feather1"),
    (b"\x80\x02", "pickle"),
    (b"\x80\x03", "pickle"),
    (b"\x80\x04", "pickle"),
    (b"\x80\x05", "pickle"),
    (b"%PDF", "pdf"),
    (b"\x93NUMPY", "npy"),
)


def read_table(name: str, data: bytes) -> Table:
    """Return the table of a file. Raises SpecError, with row, column and cell where there are any.

    Args:
        name: of the file; its ending decides only where the content does not.
        data: its bytes, also packed by gzip, bzip2, xz or zip.
    """
    check_bytes(len(data))
    name, data, packing = unpacked(name, data)
    kind = "xlsx" if packing == "xlsx" else format_of(name, data)
    module, function = _READERS[kind]
    try:
        reader: Reader = getattr(import_module(module), function)
        table = reader(name, data)
    except ThetascopeError:
        raise
    except ModuleNotFoundError as error:
        if kind not in EXTRAS:
            raise
        problem = Message("record.file.needs-extra", format=kind, extra=EXTRAS[kind])
        raise SpecError("file", name[-60:], problem) from error
    except MemoryError:
        raise SpecError("file", name[-60:], Message("record.file.memory")) from None
    except Exception as error:  # readers of binary formats raise anything for damaged files
        raise damaged(kind, error) from error
    except BaseException as error:
        if type(error).__name__ != "PanicException":  # of a reader that is written in Rust
            raise
        raise damaged(kind, error) from None
    if not table.columns:
        raise SpecError("file", name[-60:], Message("record.file.no-columns"))
    return table


def damaged(kind: str, error: BaseException) -> SpecError:
    """Return the refusal of a file whose bytes are not of its format."""
    detail = " ".join(str(error).split())[:160] or type(error).__name__
    return SpecError("file", None, Message("record.file.damaged", format=kind, detail=detail))


def format_of(name: str, data: bytes) -> str:
    """Return the format of unpacked bytes. Raises SpecError for formats that are known and not read."""
    for magic, kind in _REFUSED:
        if data.startswith(magic):
            raise SpecError("file", name[-60:], Message(f"record.file.{kind}"))
    for magic, kind in _MAGIC:
        if data.startswith(magic):
            return kind
    if name.lower().endswith(".mat") and 0 in data[:20]:  # version 4, which begins with small numbers
        return "mat"
    return "json" if _is_json(data) else "csv"


def _is_json(data: bytes) -> bool:
    head = data[:4096].lstrip(b"\xef\xbb\xbf \t\r\n")
    return head[:1] == b"{" or head[:1] == b"[" and not _is_section(head)


def _is_section(head: bytes) -> bool:
    """Return whether a text begins with a word in brackets, as heads of measurement files do."""
    word = head[1:].split(b"]")[0].strip()
    return word[:1].isalpha() and word not in (b"true", b"false", b"null")
