"""Long computations in slices of milliseconds on the event loop, so that neither frames nor commands wait for them.

A computation is a generator that yields between its steps (`Steps`); between two slices nothing of it runs.
"""

from time import perf_counter
from typing import Any

from thetascope.diagnosis.yield_points import Steps
from thetascope.live.room.serial_queue import Callback


class TimeSlices:
    """Runs one computation at a time. Created and used on the event loop."""

    def __init__(self) -> None:
        self._job: tuple[Steps[Any], Callback] | None = None

    @property
    def busy(self) -> bool:
        """Whether a computation is under way."""
        return self._job is not None

    def begin(self, steps: Steps[Any], then: Callback) -> None:
        """Accept a computation without running it yet; `then(value, error)` is called in the slice that ends it."""
        self._job = steps, then

    def run_for(self, seconds: float) -> None:
        """Run the computation until a step ends after this time, or until it is done."""
        if self._job is None:
            return
        steps, then = self._job
        until = perf_counter() + seconds
        value: Any = None
        error: Exception | None = None
        try:
            while True:
                next(steps)
                if perf_counter() >= until:
                    return
        except StopIteration as end:
            value = end.value
        except Exception as failure:
            error = failure
        self._job = None
        then(value, error)
