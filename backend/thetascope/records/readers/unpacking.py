"""Unpack gzip, bzip2, xz and zip; nothing is unpacked further than a file may be large."""

import bz2
import io
import lzma
import zipfile
import zlib
from typing import Literal

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope.records.table import MOST_BYTES, check_bytes

_DEEPEST = 2  # packings within each other
_MEMBERS = 10_000  # of one archive
_MEMORY = 128 * 1024**2  # of the xz decoder
_BESIDE = ("__MACOSX/", ".DS_Store", "Thumbs.db")


def unpacked(name: str, data: bytes) -> tuple[str, bytes, Literal["", "xlsx"]]:
    """Return the name and bytes of the file within; `xlsx` if it is a workbook, which is a zip archive itself.

    Raises SpecError for damaged archives, archives of several files, and bytes beyond the limit.
    """
    for _ in range(_DEEPEST):
        if data.startswith(b"PK\x03\x04"):
            archive = _archive(data)
            if any(member.filename == "xl/workbook.xml" for member in archive.infolist()):
                return name, data, "xlsx"
            name, data = _only_member(archive)
        elif data.startswith(b"\x1f\x8b\x08"):
            name, data = _without(name, ".gz"), _gunzip(data)
        elif data.startswith(b"BZh"):
            name, data = _without(name, ".bz2"), _stream(bz2.BZ2Decompressor, data)
        elif data.startswith(b"\xfd7zXZ\x00"):
            name, data = _without(name, ".xz"), _stream(lambda: lzma.LZMADecompressor(memlimit=_MEMORY), data)
        else:
            break
    return name, data, ""


def _without(name: str, ending: str) -> str:
    return name[: -len(ending)] if name.lower().endswith(ending) else name


def _gunzip(data: bytes) -> bytes:
    """Return the content of all members of a gzip file."""
    parts, size = [], 0
    while data:
        decoder = zlib.decompressobj(wbits=31)
        try:
            part = decoder.decompress(data, MOST_BYTES + 1 - size)
        except zlib.error as error:
            raise _damaged(error) from None
        size += len(part)
        check_bytes(size)
        if not decoder.eof:
            raise _damaged(EOFError("the file ends early"))
        parts.append(part)
        data = decoder.unused_data.lstrip(b"\0")
        if not data.startswith(b"\x1f\x8b"):
            break
    return b"".join(parts)


def _stream(make, data: bytes) -> bytes:
    """Return the content of all streams of a bzip2 or xz file."""
    parts, size = [], 0
    while data:
        decoder = make()
        try:
            while not decoder.eof:
                part = decoder.decompress(data, MOST_BYTES + 1 - size)
                size += len(part)
                check_bytes(size)
                parts.append(part)
                data = b""
                if not part and decoder.needs_input:
                    raise EOFError("the file ends early")
        except (OSError, EOFError, lzma.LZMAError) as error:
            raise _damaged(error) from None
        data = decoder.unused_data
        if data[:3] not in (b"BZh", b"\xfd7z"):
            break
    return b"".join(parts)


def _archive(data: bytes) -> zipfile.ZipFile:
    """Return an archive whose members together, as declared, are not too large: no more than that is read of them."""
    try:
        archive = zipfile.ZipFile(io.BytesIO(data))
    except (zipfile.BadZipFile, ValueError, NotImplementedError, OSError) as error:
        raise _damaged(error) from None
    members = archive.infolist()
    if len(members) > _MEMBERS:
        raise SpecError("file", len(members), Message("record.file.several", names=[m.filename for m in members[:3]]))
    check_bytes(sum(member.file_size for member in members))
    return archive


def _only_member(archive: zipfile.ZipFile) -> tuple[str, bytes]:
    """Return the name and content of the only file of an archive."""
    members = [m for m in archive.infolist() if not m.is_dir() and not any(part in m.filename for part in _BESIDE)]
    if len(members) != 1:
        names = [m.filename[:60] for m in members[:3]]
        raise SpecError("file", len(members), Message("record.file.several", names=names))
    try:
        return members[0].filename, archive.read(members[0])
    except (zipfile.BadZipFile, zlib.error, RuntimeError, NotImplementedError, EOFError, OSError, ValueError) as error:
        raise _damaged(error) from None
    except lzma.LZMAError as error:
        raise _damaged(error) from None


def _damaged(error: Exception) -> SpecError:
    return SpecError("file", None, Message("record.file.unpacking", detail=str(error)[:120]))
