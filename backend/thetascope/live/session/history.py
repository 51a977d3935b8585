"""What a session has recorded: rows as sent (float32), piece by piece, whatever columns each piece had."""

from dataclasses import dataclass

import numpy as np

_PIECE = 1 << 15  # rows, about, to which pieces are joined


@dataclass(frozen=True)
class RowBlock:
    """Rows first … first + count − 1 with the columns they had."""

    first: int
    columns: tuple[str, ...]
    data: np.ndarray  # float32, columns × rows

    @property
    def end(self) -> int:
        return self.first + self.data.shape[1]


class RowHistory:
    """Rows start … end − 1. Pieces are never changed, only cut off at the end or let go: forks share them."""

    def __init__(self, pieces: list[RowBlock] | None = None, start: int = 0):
        self.pieces = list(pieces or [])
        self._start = start

    @property
    def start(self) -> int:
        """The first row that is still there."""
        return self.pieces[0].first if self.pieces else self._start

    @property
    def end(self) -> int:
        return self.pieces[-1].end if self.pieces else self._start

    def forget(self, rows: int) -> None:
        """Let old pieces go, as long as `rows` rows remain."""
        while len(self.pieces) > 1 and self.end - self.pieces[1].first >= rows:
            del self.pieces[0]

    def append(self, columns: tuple[str, ...], data: np.ndarray) -> None:
        self.pieces.append(RowBlock(self.end, columns, data.astype(np.float32)))
        if len(self.pieces) > 64:
            self._merge()

    def _merge(self) -> None:
        """Join neighbours of the same columns, so that a long session is not a long list."""
        groups: list[list[RowBlock]] = []
        for piece in self.pieces:
            last = groups[-1] if groups else None
            if last and last[-1].columns == piece.columns and piece.first - last[0].first < _PIECE:
                last.append(piece)
            else:
                groups.append([piece])
        self.pieces = [_joined(group) for group in groups]

    def cut(self, row: int) -> "RowHistory":
        """The past before a row."""
        kept = [p for p in self.pieces if p.first < row]
        if kept and kept[-1].end > row:
            last = kept[-1]
            kept[-1] = RowBlock(last.first, last.columns, last.data[:, : row - last.first])
        return RowHistory(kept, row)

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


def _joined(pieces: list[RowBlock]) -> RowBlock:
    if len(pieces) == 1:
        return pieces[0]
    return RowBlock(pieces[0].first, pieces[0].columns, np.concatenate([piece.data for piece in pieces], axis=1))
