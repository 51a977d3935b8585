"""The scales of a plant: sizes of states and outputs, and rates, in the plant's own units.

Every number that is not given by the user (default gains, process noise, tolerances, the bound of a divergence) is a
multiple of these scales, so that units of states, outputs, faults and time never change an answer. They come from the
healthy run, engine/simulation/healthy_run.py.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

Rows = tuple[tuple[float, ...], ...]
"""A matrix as rows of numbers, which can be compared and hashed."""


@dataclass(frozen=True)
class Slopes:
    """The linearisation of a healthy plant: medians, entry by entry, along its run, in the plant's own units.

    Attributes:
        A, C: ∂f/∂x (n×n) and ∂h/∂x (m×n).
        Phi, Psi: the effects of all fault channels on the rates (n×p) and on the outputs (m×p).
    """

    A: Rows
    C: Rows
    Phi: Rows
    Psi: Rows


@dataclass(frozen=True)
class Scales:
    """Scales of one plant under the inputs of one experiment.

    Attributes:
        states, outputs: the size of a change of each state and output, without any offset.
        extents: the largest absolute value of each state that a healthy plant reaches, at least its scale.
        rate: the slowest rate of the plant in 1/s that matters, see `healthy_run`.
        span: the time in s over which the plant was simulated or is to be watched.
        amplification: the largest factor by which a small change of the states, relative to `extents`, grows along the
            run; at least 1.
        chain: with one output, its slope along the first state, then the slope of each state's rate along the next
            state: medians along the run (n,). Empty with several outputs.
        slopes: the linearisation that constant gains are designed for; None for a large or discrete plant.
        fastest: the largest rate of the plant in 1/s along the run; 0 in discrete time.
    """

    states: tuple[float, ...]
    outputs: tuple[float, ...]
    extents: tuple[float, ...]
    rate: float
    span: float
    amplification: float = 1.0
    chain: tuple[float, ...] = ()
    slopes: Slopes | None = None
    fastest: float = 0.0


@dataclass(frozen=True)
class HealthyRun:
    """A simulation without faults that is done when its scales are needed, once for each key.

    ``key`` is a hash of everything that the scales depend on.
    """

    key: str
    simulate: Callable[[], Scales] = field(compare=False, repr=False)

    @property
    def scales(self) -> Scales:
        """Return the scales; the first call simulates."""
        return _scales(self)


@lru_cache(maxsize=512)
def _scales(run: HealthyRun) -> Scales:
    return run.simulate()


def fixed(scales: Scales) -> HealthyRun:
    """Return a healthy run whose scales are known."""
    return HealthyRun(repr(scales), lambda: scales)
