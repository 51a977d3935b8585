"""Long computations as generators that yield between their steps, so that the caller decides when they continue."""

from collections.abc import Callable, Generator
from typing import TypeVar

T = TypeVar("T")

Steps = Generator[None, None, T]
"""A computation that yields before every step of about a millisecond and returns a T."""


def run_to_end(steps: Steps[T], between: Callable[[], object] | None = None) -> T:
    """Run all steps and return the result.

    Args:
        steps: the computation.
        between: called at every yield; an exception that it raises ends the computation there.
    """
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value
        if between is not None:
            between()
