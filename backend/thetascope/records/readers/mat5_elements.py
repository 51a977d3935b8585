"""The structure of variables in MATLAB files of version 5, walked before SciPy reads them.

SciPy's reader trusts classes, dimensions and lengths: a damaged file can make it read beyond its memory. A variable is
sound here if every length lies within its parent, and every array has as many numbers as its dimensions say.
"""

import struct
from dataclasses import dataclass
from math import prod

_SIZES = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8}  # bytes of a number by its type
_TEXTS = {1: 1, 2: 1, 4: 2, 16: 1, 17: 2, 18: 4}
_UTF8, _MATRIX, _INT32, _UINT32 = 16, 14, 5, 6
_CELL, _STRUCT, _CHAR = 1, 2, 4
_NUMBERS = range(6, 16)
_COMPLEX = 0x08
_DEEPEST, _MOST_DIMENSIONS = 8, 32


class Damaged(Exception):
    """A length or a type that cannot be."""


class Unsupported(Exception):
    """A class that holds no columns: objects, sparse matrices, functions."""


@dataclass(frozen=True)
class _Element:
    kind: int
    data: memoryview
    end: int  # place of the next element


def check_variable(content: bytes, order: str) -> None:
    """Raise Damaged or Unsupported for a variable (an element of type matrix) that SciPy must not read."""
    element = _element(memoryview(content), 0, order)
    if element.kind != _MATRIX:
        raise Damaged(f"element of type {element.kind}")
    _matrix(element.data, order, 0)


def _element(data: memoryview, place: int, order: str) -> _Element:
    """Return the element that begins at a place; short ones have type and length in one word."""
    if place + 8 > len(data):
        raise Damaged("the file ends early")
    first, second = struct.unpack_from(f"{order}II", data, place)
    if first >> 16:
        length, kind, begin = first >> 16, first & 0xFFFF, place + 4
        if length > 4:
            raise Damaged(f"short element of {length} bytes")
        end = place + 8
    else:
        kind, length, begin = first, second, place + 8
        end = begin + length if kind == _MATRIX else begin + -(-length // 8) * 8
    if begin + length > len(data):
        raise Damaged("the file ends early")
    return _Element(kind, data[begin : begin + length], min(end, len(data)))


def _matrix(data: memoryview, order: str, depth: int) -> None:
    """Walk the parts of a matrix."""
    if depth > _DEEPEST:
        raise Unsupported
    if not len(data):
        return  # an empty element of a structure
    flags = _element(data, 0, order)
    dimensions = _element(data, flags.end, order)
    name = _element(data, dimensions.end, order)
    if flags.kind != _UINT32 or len(flags.data) != 8 or dimensions.kind != _INT32 or name.kind not in (1, 2, _UTF8):
        raise Damaged("no head of an array")
    if len(dimensions.data) % 4 or not 8 <= len(dimensions.data) <= 4 * _MOST_DIMENSIONS:
        raise Damaged("no dimensions")
    shape = struct.unpack(f"{order}{len(dimensions.data) // 4}i", dimensions.data)
    if min(shape) < 0:
        raise Damaged(f"dimensions {shape}")
    word = struct.unpack_from(f"{order}I", flags.data)[0]
    kind, count = word & 0xFF, prod(shape)
    if kind in _NUMBERS:
        place = _numbers(data, name.end, order, count)
        if (word >> 8) & _COMPLEX:
            _numbers(data, place, order, count)
    elif kind == _CHAR:
        _text(data, name.end, order, count)
    elif kind == _CELL:
        _matrices(data, name.end, order, count, depth)
    elif kind == _STRUCT:
        _structure(data, name.end, order, count, depth)
    else:
        raise Unsupported


def _numbers(data: memoryview, place: int, order: str, count: int) -> int:
    """Walk an element with `count` numbers; return the place after it."""
    part = _element(data, place, order)
    if part.kind not in _SIZES or len(part.data) != count * _SIZES[part.kind]:
        raise Damaged(f"{len(part.data)} bytes for {count} numbers")
    return part.end


def _text(data: memoryview, place: int, order: str, count: int) -> None:
    """Walk an element with `count` characters."""
    part = _element(data, place, order)
    if part.kind not in _TEXTS:
        raise Damaged(f"text of type {part.kind}")
    if part.kind == _UTF8:
        try:
            length = len(bytes(part.data).decode())
        except UnicodeDecodeError:
            raise Damaged("text that is not UTF-8") from None
    else:
        length = len(part.data) // _TEXTS[part.kind]
    if length != count or len(part.data) % _TEXTS[part.kind]:
        raise Damaged(f"{len(part.data)} bytes for {count} characters")


def _matrices(data: memoryview, place: int, order: str, count: int, depth: int) -> None:
    """Walk `count` matrices."""
    if count > len(data) // 8:
        raise Damaged(f"{count} arrays in {len(data)} bytes")
    for _ in range(count):
        inner = _element(data, place, order)
        if inner.kind != _MATRIX:
            raise Damaged(f"element of type {inner.kind}")
        _matrix(inner.data, order, depth + 1)
        place = inner.end


def _structure(data: memoryview, place: int, order: str, count: int, depth: int) -> None:
    """Walk the names and values of a structure."""
    width = _element(data, place, order)
    if width.kind != _INT32 or len(width.data) != 4:
        raise Damaged("no length of names")
    (length,) = struct.unpack(f"{order}i", width.data)
    names = _element(data, width.end, order)
    if names.kind not in (1, 2, _UTF8) or length <= 0 or len(names.data) % length:
        raise Damaged("no names of a structure")
    _matrices(data, names.end, order, count * (len(names.data) // length), depth)
