"""The arrays that the loops of this folder share.

Sizes: n states, m outputs, p faults, nu inputs and known signals, npar parameters, d directions (derivatives), na = n
or n + m (with coloured noise), discrete (1: the plant is in discrete time).
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from thetascope.engine.loops.declaration import Bundle

Array = np.ndarray


@dataclass
class Equations(Bundle):
    """Parameters of the plant, and the bounds of the states within which its equations hold.

    ``chosen``: the directions whose derivatives G are computed, as many as a call says; others are 0.
    """

    par: Annotated[Array, "npar"]
    low: Annotated[Array, "n"]
    high: Annotated[Array, "n"]
    chosen: Annotated[Array, "d"]


@dataclass
class Noise(Bundle):
    """Noise: q, intensity per second of each state; r, variance of each reading; its coloured part.

    The coloured part of output k has the variance s2 and the correlation exp(−rate·Δ) over Δ seconds.
    """

    q: Annotated[Array, "n"]
    r: Annotated[Array, "m"]
    rate: Annotated[Array, "m"]
    s2: Annotated[Array, "m"]


@dataclass
class Rows(Bundle):
    """Recorded rows: times, width and number of integration steps of the interval after each row, inputs, readings.

    ``between``: the inputs over the interval after a row, those of the row if they are held. Negative numbers of steps
    are those of the method for stiff plants.

    ``extra_at``: which matrix of ``extra`` is added to the covariance over the interval, −1 for none.
    """

    t: Annotated[Array, "rows"]
    width: Annotated[Array, "rows"]
    steps: Annotated[Array, "rows"]
    u: Annotated[Array, "rows nu"]
    between: Annotated[Array, "rows nu"]
    y: Annotated[Array, "rows m"]
    extra_at: Annotated[Array, "rows"]
    extra: Annotated[Array, "extras n n"]


@dataclass
class Faults(Bundle):
    """Known faults θ: their mean over the interval after each row, and their value in the row."""

    interval: Annotated[Array, "rows p"]
    row: Annotated[Array, "rows p"]


@dataclass
class Path(Bundle):
    """The linearised filter along rows.

    φ, F and G hold at the filtered state x, h, H and J at the prediction ``prior``; K and sd are gain and standard
    deviation of each reading, nu the innovations divided by sd (NaN where a cell is missing), z and spread the
    filtered state and the diagonal of its covariance.
    """

    x: Annotated[Array, "rows n"]
    phi: Annotated[Array, "rows n"]
    F: Annotated[Array, "rows n n"]
    G: Annotated[Array, "rows n d"]
    prior: Annotated[Array, "rows n"]
    h: Annotated[Array, "rows m"]
    H: Annotated[Array, "rows m n"]
    J: Annotated[Array, "rows m d"]
    K: Annotated[Array, "rows m na"]
    sd: Annotated[Array, "rows m"]
    nu: Annotated[Array, "rows m"]
    z: Annotated[Array, "rows na"]
    spread: Annotated[Array, "rows na"]


@dataclass
class Bank(Bundle):
    """Onsets that are watched: the row (−1: free) and time of each, the response U of the filter to a fault from there
    on, and the sums a = Σ Ω ν (for each replica of ν) and b = Σ Ω². Columns: a step of every direction, then a ramp."""

    onset: Annotated[Array, "slots"]
    begun: Annotated[Array, "slots"]
    U: Annotated[Array, "slots na 2*d"]
    a: Annotated[Array, "slots replicas 2*d"]
    b: Annotated[Array, "slots 2*d"]


@dataclass
class Alarms(Bundle):
    """The largest statistic of each row, and for the first replica its onset, column and size."""

    largest: Annotated[Array, "rows replicas"]
    onset: Annotated[Array, "rows"]
    column: Annotated[Array, "rows"]
    size: Annotated[Array, "rows"]
