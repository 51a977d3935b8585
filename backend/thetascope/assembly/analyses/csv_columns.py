"""Read columns of numbers from CSV text with a header line."""

import csv

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.messages import Message
from thetascope_schemas.texts.names import normalised_path


def columns_of_csv(text: str) -> dict[str, np.ndarray]:
    """Return each column by its name. Raises SpecError with the line that is not a row of numbers."""
    try:
        written = text.splitlines()
        apart = next((c for c in (",", ";", "\t") if c in "".join(written[:1])), ",")
        if apart == ";":  # numbers may then have a decimal comma
            written = [line.replace(",", ".") for line in written]
        lines = csv.reader(written, delimiter=apart)
        names = [normalised_path(name.strip()) for name in next(lines, [])]
        rows = [(lines.line_num, line) for line in lines if line]
    except csv.Error as error:
        raise SpecError("csv", None, Message("record.csv.invalid", detail=str(error))) from None
    if not names or not all(names) or len(set(names)) < len(names):
        raise SpecError("csv", ",".join(names)[:60], Message("record.csv.names"))
    data = np.empty((len(rows), len(names)))
    for place, (number, line) in enumerate(rows):
        try:
            if len(line) != len(names):  # NumPy would repeat a single cell along the row
                raise ValueError
            data[place] = [float(cell) for cell in line]
        except ValueError:
            raise SpecError("csv", ",".join(line)[:60], Message("record.csv.row", line=number, n=len(names))) from None
    return dict(zip(names, data.T, strict=True))
