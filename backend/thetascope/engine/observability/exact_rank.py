"""Rank and null space of a matrix given row by row, in decimal arithmetic of many digits."""

from decimal import Decimal

TOLERANCE = Decimal("1e-60")  # relative to a row: smaller entries are rounding errors
Row = list[Decimal]


class Elimination:
    """The reduced row echelon form of the rows added so far."""

    def __init__(self, columns: int):
        self.columns = columns
        self.rows: dict[int, Row] = {}  # by the column of the pivot, which is 1

    @property
    def rank(self) -> int:
        """Return the rank of the rows so far."""
        return len(self.rows)

    def take(self, row: Row) -> bool:
        """Add a row; return whether it raises the rank."""
        size = max(map(abs, row), default=Decimal(0))
        if not size:
            return False
        row = [v / size for v in row]
        for pivot, known in self.rows.items():
            row = _less(row, row[pivot], known)
        place = max(range(self.columns), key=lambda j: abs(row[j]))
        if abs(row[place]) <= TOLERANCE:
            return False
        new = [v / row[place] for v in row]
        self.rows = {pivot: _less(known, known[place], new) for pivot, known in self.rows.items()}
        self.rows[place] = new
        return True

    def null_space(self) -> list[Row]:
        """Return a basis of the null space, one vector for each column without a pivot."""
        found = []
        for free in (j for j in range(self.columns) if j not in self.rows):
            vector = [Decimal(int(j == free)) for j in range(self.columns)]
            for pivot, row in self.rows.items():
                vector[pivot] = -row[free] if abs(row[free]) > TOLERANCE else Decimal(0)
            found.append(vector)
        return found


def _less(row: Row, factor: Decimal, other: Row) -> Row:
    return [a - factor * b for a, b in zip(row, other, strict=True)] if factor else row


def rank(rows: list[Row]) -> int:
    """Return the rank of a small matrix."""
    elimination = Elimination(len(rows[0]) if rows else 0)
    for row in rows:
        elimination.take(row)
    return elimination.rank
