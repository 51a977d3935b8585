"""What a session has recorded: rows as sent (float32), piece by piece, whatever columns each piece had."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Piece:
    """Rows first … first + count − 1 with the columns they had."""

    first: int
    columns: tuple[str, ...]
    data: np.ndarray  # float32, columns × rows

    @property
    def end(self) -> int:
        return self.first + self.data.shape[1]


class Past:
    """Rows 0 … end − 1. Pieces are never changed, only cut off at the end: forks share them."""

    def __init__(self, pieces: list[Piece] | None = None):
        self.pieces = list(pieces or [])

    @property
    def end(self) -> int:
        return self.pieces[-1].end if self.pieces else 0

    def append(self, columns: tuple[str, ...], data: np.ndarray) -> None:
        self.pieces.append(Piece(self.end, columns, data.astype(np.float32)))
        if len(self.pieces) > 64:
            self._merge()

    def _merge(self) -> None:
        """Join neighbours of the same columns, so that a long session is not a long list."""
        merged: list[Piece] = []
        for piece in self.pieces:
            last = merged[-1] if merged else None
            if last is not None and last.columns == piece.columns and last.data.shape[1] < 1 << 15:
                merged[-1] = Piece(last.first, last.columns, np.concatenate([last.data, piece.data], axis=1))
            else:
                merged.append(piece)
        self.pieces = merged

    def cut(self, row: int) -> "Past":
        """The past before a row."""
        kept = [p for p in self.pieces if p.first < row]
        if kept and kept[-1].end > row:
            last = kept[-1]
            kept[-1] = Piece(last.first, last.columns, last.data[:, : row - last.first])
        return Past(kept)

    def rows(self, columns: tuple[str, ...], first: int, last: int) -> np.ndarray:
        """Rows first … last − 1 in the given columns, NaN where a piece has no such column: columns × rows."""
        first, last = max(0, first), min(last, self.end)
        out = np.full((len(columns), max(0, last - first)), np.nan, dtype=np.float32)
        for piece in self.pieces:
            a, b = max(first, piece.first), min(last, piece.end)
            if a >= b:
                continue
            block = piece.data[:, a - piece.first : b - piece.first]
            if piece.columns == columns:
                out[:, a - first : b - first] = block
                continue
            where = {name: i for i, name in enumerate(piece.columns)}
            for j, name in enumerate(columns):
                if name in where:
                    out[j, a - first : b - first] = block[where[name]]
        return out
