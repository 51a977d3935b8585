"""Query parameters of tables, the times and columns that are returned, and their formats in the OpenAPI document."""

from typing import Annotated, Any

from fastapi import Query

from thetascope.export import MEDIA_TYPES
from thetascope.messages import Message
from thetascope.runs.specs.refusals import invalid
from thetascope_schemas.experiment.base import MAX_TIME

_TIME = {"ge": 0, "le": MAX_TIME, "allow_inf_nan": False}
First = Annotated[float | None, Query(alias="from", description="First time in s.", **_TIME)]
Last = Annotated[float | None, Query(alias="to", description="Last time in s.", **_TIME)]

Names = Annotated[str | None, Query(description="Columns, separated by commas; `*` matches any text.", max_length=8000)]


def tables(*formats: str) -> dict[str, Any]:
    """Return the description of an answer that is a table in one of these formats."""
    return {"content": {MEDIA_TYPES[format].partition(";")[0]: {} for format in formats}}


def check(start: float | None, end: float | None) -> None:
    """Raise InvalidSpec for a span that ends before it begins."""
    if start is not None and end is not None and start > end:
        raise invalid("from", start, Message("span.reversed", start=start, end=end))
