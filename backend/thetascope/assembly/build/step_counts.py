"""Convert intervals of a spec into whole numbers of steps."""

from thetascope.engine.errors import SpecError
from thetascope.messages import Message

_ON_GRID = 1e-6  # relative tolerance for one interval to be a multiple of another


def multiple(interval: float, step: float, field: str) -> int:
    """Return the number of steps in an interval. Raises SpecError unless it is a whole number of them, at least one."""
    count = round(interval / step)
    if count < 1 or abs(interval / step - count) > _ON_GRID * max(1, count):
        near = max(1, count) * step
        raise SpecError(field, interval, Message("experiment.time.no-multiple", time=interval, step=step, near=near))
    return count
