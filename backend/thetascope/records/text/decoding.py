"""Turn the bytes of a text file into text: the encoding is found from the bytes."""

import codecs
import re

from thetascope.engine.errors import SpecError
from thetascope.messages import Message

_MARKS = (
    (codecs.BOM_UTF8, "utf-8"),
    (codecs.BOM_UTF32_LE, "utf-32-le"),  # before UTF-16, whose mark it begins with
    (codecs.BOM_UTF32_BE, "utf-32-be"),
    (codecs.BOM_UTF16_LE, "utf-16-le"),
    (codecs.BOM_UTF16_BE, "utf-16-be"),
)
_GB2312 = re.compile(rb"(?:[\xa1-\xf7][\xa1-\xfe])+")
_HIGH = re.compile(rb"[\x80-\xff]+")
_SAMPLE = 1 << 20
_NULS = 0.2  # share of zero bytes beyond which text is UTF-16


def decoded(data: bytes) -> tuple[str, str]:
    """Return the text with line ends as \\n, and the name of its encoding.

    A byte-order mark decides; then zero bytes (UTF-16), validity as UTF-8, pairs of high bytes as of GB2312, and at
    last the Western encoding Windows-1252. Raises SpecError for bytes that are not text.
    """
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            return _as(data[len(mark) :], encoding, strict=False), encoding.upper().removesuffix("-LE").removesuffix(
                "-BE"
            )
    head = data[:_SAMPLE]
    if head.count(0) > _NULS * len(head):
        even, odd = head[::2].count(0), head[1::2].count(0)
        return _as(data, "utf-16-le" if odd > even else "utf-16-be", strict=False), "UTF-16"
    if 0 in head:
        raise SpecError("file", None, Message("record.file.binary"))
    try:
        return _as(data, "utf-8", strict=True), "UTF-8"
    except UnicodeDecodeError:
        pass
    runs = _HIGH.findall(head)
    if runs and all(_GB2312.fullmatch(run) for run in runs):
        return _as(data, "gb18030", strict=False), "GB 18030"
    return _as(data, "cp1252", strict=False), "Windows-1252"


def _as(data: bytes, encoding: str, strict: bool) -> str:
    text = data.decode(encoding, "strict" if strict else "replace")
    if "\r" in text:
        text = text.replace("\r\n", "\n").replace("\r", "\n")
    return text
