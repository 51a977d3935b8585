"""Recorded rows of a session as they are sent (float32), in immutable blocks, each with the columns it had."""

from dataclasses import dataclass, field

import numpy as np

_BLOCK_ROWS = 1 << 15  # neighbouring blocks are merged up to about this many rows
_MAX_BLOCKS = 64  # more blocks than this are merged


@dataclass(frozen=True)
class RowBlock:
    """Rows first … first + count − 1. `data` is float32, columns × rows, and is never written to."""

    first: int
    columns: tuple[str, ...]
    data: np.ndarray

    @property
    def end(self) -> int:
        """The row after the last one."""
        return self.first + self.data.shape[1]


@dataclass(frozen=True)
class RowHistory:
    """Rows `start` … `end` − 1: a value, so that forks and earlier states of a session share its blocks."""

    blocks: tuple[RowBlock, ...] = field(default=())
    first: int = 0  # where rows begin if there is no block

    @property
    def start(self) -> int:
        """The first row that is kept."""
        return self.blocks[0].first if self.blocks else self.first

    @property
    def end(self) -> int:
        """The row after the last one."""
        return self.blocks[-1].end if self.blocks else self.first

    def append(self, columns: tuple[str, ...], data: np.ndarray) -> "RowHistory":
        """Return the history with more rows at its end; data: columns × rows."""
        blocks = (*self.blocks, RowBlock(self.end, columns, data.astype(np.float32)))
        return RowHistory(blocks if len(blocks) <= _MAX_BLOCKS else _merged(blocks), self.first)

    def drop_oldest(self, rows: int) -> "RowHistory":
        """Return the history without its oldest blocks, as long as at least `rows` rows remain."""
        drop = 0
        while drop + 1 < len(self.blocks) and self.end - self.blocks[drop + 1].first >= rows:
            drop += 1
        return RowHistory(self.blocks[drop:], self.first) if drop else self

    def before(self, row: int) -> "RowHistory":
        """Return the history up to row `row` − 1."""
        kept = [block for block in self.blocks if block.first < row]
        if kept and kept[-1].end > row:
            last = kept[-1]
            kept[-1] = RowBlock(last.first, last.columns, last.data[:, : row - last.first])
        return RowHistory(tuple(kept), row)

    def rows(self, columns: tuple[str, ...], first: int, last: int) -> np.ndarray:
        """Return rows first … last − 1 as float32, columns × rows; NaN where a block has no such column."""
        first, last = max(0, first), min(last, self.end)
        out = np.full((len(columns), max(0, last - first)), np.nan, dtype=np.float32)
        for block in self.blocks:
            a, b = max(first, block.first), min(last, block.end)
            if a >= b:
                continue
            data = block.data[:, a - block.first : b - block.first]
            if block.columns == columns:
                out[:, a - first : b - first] = data
                continue
            place = {name: i for i, name in enumerate(block.columns)}
            for j, name in enumerate(columns):
                if name in place:
                    out[j, a - first : b - first] = data[place[name]]
        return out


def _merged(blocks: tuple[RowBlock, ...]) -> tuple[RowBlock, ...]:
    """Join neighbouring blocks of the same columns, so that a long session is not a long list."""
    groups: list[list[RowBlock]] = []
    for block in blocks:
        last = groups[-1] if groups else None
        if last and last[-1].columns == block.columns and block.first - last[0].first < _BLOCK_ROWS:
            last.append(block)
        else:
            groups.append([block])
    return tuple(_joined(group) for group in groups)


def _joined(blocks: list[RowBlock]) -> RowBlock:
    if len(blocks) == 1:
        return blocks[0]
    return RowBlock(blocks[0].first, blocks[0].columns, np.concatenate([block.data for block in blocks], axis=1))
