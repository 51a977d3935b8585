"""LLVM instructions for tables: constant arrays, a search by halving without branches, and a polynomial."""

import hashlib
import struct
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Constants:
    """A global constant array of rows × columns numbers, and its definition in the module."""

    name: str
    definition: str
    rows: int
    columns: int

    @classmethod
    def of(cls, values: tuple) -> "Constants":
        """Return the array of a grid, padded with NaN for the search, or of the pieces of a table."""
        rows = values if isinstance(values[0], tuple) else tuple((v,) for v in values)
        numbers = [v for row in rows for v in row]
        if rows is not values:
            numbers += [float("nan")] * ((1 << len(rows).bit_length()) - 1 - len(rows))
        words = [struct.pack(">d", v).hex().upper() for v in numbers]
        name = "@table." + hashlib.sha256("".join(words).encode()).hexdigest()[:16]
        kind = f"[{len(words)} x double]"
        inner = ", ".join(f"double 0x{word}" for word in words)
        definition = f"{name} = private unnamed_addr constant {kind} [{inner}], align 64"
        return cls(name, definition, len(rows), len(rows[0]))


def locate(let: Callable[[str], str], x: str, grid: Constants) -> str:
    """Append the number of grid points ≤ x, and return its value, a double; 0 for NaN."""
    position, step = "0", 1 << (grid.rows.bit_length() - 1)
    while step:
        last = let(f"add i64 {position}, {step - 1}")
        point = let(f"load double, ptr {let(f'getelementptr double, ptr {grid.name}, i64 {last}')}")
        reached = let(f"fcmp ole double {point}, {x}")
        position = let(f"select i1 {reached}, i64 {let(f'add i64 {position}, {step}')}, i64 {position}")
        step //= 2
    return let(f"sitofp i64 {position} to double")


def piece(let: Callable[[str], str], x: str, index: str, pieces: Constants) -> str:
    """Append the value of a piece at x, and return it."""
    row = let(f"mul i64 {let(f'fptosi double {index} to i64')}, {pieces.columns}")
    first = let(f"getelementptr double, ptr {pieces.name}, i64 {row}")

    def entry(column: int) -> str:
        return let(f"load double, ptr {let(f'getelementptr double, ptr {first}, i64 {column}')}")

    total = entry(pieces.columns - 1)
    if pieces.columns > 2:
        s = let(f"fsub double {x}, {entry(0)}")
        for column in range(pieces.columns - 2, 0, -1):
            total = let(f"fadd double {let(f'fmul double {total}, {s}')}, {entry(column)}")
    return total
