"""Query parameters for the times between which rows are returned."""

from typing import Annotated

from fastapi import Query

from thetascope.messages import Message
from thetascope.runs.specs.refusals import invalid
from thetascope_schemas.experiment.base import MAX_TIME

_TIME = {"ge": 0, "le": MAX_TIME, "allow_inf_nan": False}
First = Annotated[float | None, Query(alias="from", description="First time in s.", **_TIME)]
Last = Annotated[float | None, Query(alias="to", description="Last time in s.", **_TIME)]


def check(start: float | None, end: float | None) -> None:
    """Raise InvalidSpec for a span that ends before it begins."""
    if start is not None and end is not None and start > end:
        raise invalid("from", start, Message("span.reversed", start=start, end=end))
