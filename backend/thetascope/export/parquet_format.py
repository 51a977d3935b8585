"""Write Parquet: one column of float64 for each column; missing values are null."""

import io

from thetascope.export.selection import Table


def parquet_bytes(table: Table) -> bytes:
    """Return the file's bytes; numbers read back to exactly the same float64."""
    import polars as pl  # its threads start with the import; few runs are exported in this format

    stream = io.BytesIO()
    columns = {name: pl.Series(column, nan_to_null=True) for name, column in zip(table.names, table.data, strict=True)}
    pl.DataFrame(columns).write_parquet(stream)
    return stream.getvalue()
