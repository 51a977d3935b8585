"""What an observer's file offers: its gains, options, equations and the assumptions it checks."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from thetascope.engine.compiler.system import Program
from thetascope.engine.model.plant_model import Model
from thetascope.engine.model.result import Check
from thetascope.engine.observers.support.dimensions import NUMBER, Dimension
from thetascope.engine.observers.support.draft import Draft, Size
from thetascope.engine.observers.support.scales import HealthyRun, Scales
from thetascope.messages import Message


@dataclass(frozen=True)
class Context:
    """What defaults may depend on: the plant's size, the noise that the experiment declares, its sampling."""

    n: int
    m: int
    p: int
    noise_std: tuple[float, ...]  # per output; 0 where none is declared
    step: float
    period: float  # sample period a discrete observer works at, s
    model: Mapping = field(default_factory=dict)  # the plant's data
    channels: tuple[str, ...] = ()  # the fault channels to estimate
    noise_hold: tuple[float, ...] = ()  # per output: the sample time of the declared noise, s
    healthy: HealthyRun | None = None  # the source of all scales
    poles: str = ""  # the option of wished_poles.py, where the user gives it

    @property
    def scales(self) -> Scales:
        """Return the scales of states, outputs and time; the first use simulates the plant without faults."""
        assert self.healthy is not None, "a context that is asked for scales has a healthy run"
        return self.healthy.scales


Count = str | Callable[[Context], int]
"""A number of rows or columns: n, m, p, n+p, n-m, or a function of the Context; see `counted_by`."""


@dataclass(frozen=True)
class Gain:
    """A number, a column or a matrix of numbers that the user may move while the observer runs.

    Args:
        name: unique among the observer's gains.
        meaning: for the user, an entry of the catalogues.
        default: a number, a list, a list of rows, or a function of the Context that returns one of these.
        low, high: bounds of every entry, inclusive; None: no bound. A gain with a unit is bounded by its sign only,
            because any other number would depend on the unit.
        positive: whether every entry must be greater than 0.
        size: the number of entries of a column, or of rows of a matrix; None for a single number.
        columns: the number of columns of a matrix; None for a column.
        rows: labels of the rows; by default the names of the states, outputs or channels that ``size`` counts.
        symbol: as the paper and the page write it.
        unit: its dimension. An experiment in other units has the same results with gains converted by it.
        orders: by row, a power to which the dimension is raised; by default 1 in every row.
        live: False where it acts at the start only, or on diagnostics only, so that moving it later has no effect.
    """

    name: str
    meaning: Message
    default: float | tuple | Callable[[Context], object]
    low: float | None = 0.0
    high: float | None = None
    size: Count | None = None
    symbol: str = ""
    unit: Dimension = NUMBER
    live: bool = True
    columns: Count | None = None
    rows: Callable[[Context], Sequence[str]] | None = None
    orders: Callable[[Context], Sequence[int]] | None = None
    positive: bool = False

    def shape(self, context: Context) -> Size:
        """Return None for a number, the length of a column, or (rows, columns)."""
        if self.size is None:
            return None
        rows = count(self.size, context)
        return rows if self.columns is None else (rows, count(self.columns, context))

    def bounds_problem(self, number: float) -> Message | None:
        """Return why a number is out of bounds, or None."""
        if not math.isfinite(number) or (self.positive and number <= 0):
            return Message("observer.gain.not-positive", meaning=self.meaning)
        if self.low is not None and self.high is not None and not self.low <= number <= self.high:
            limits = {"low": self.low, "high": self.high}
            return Message("observer.gain.outside-bounds", meaning=self.meaning, **limits)
        if self.low is not None and number < self.low:
            return Message("observer.gain.too-small", meaning=self.meaning, low=self.low)
        return None

    def row_labels(self, context: Context) -> tuple[str, ...]:
        """Return the label of each row; nothing for a single number."""
        if self.size is None:
            return ()
        return tuple(self.rows(context)) if self.rows else labels(self.size, context)

    def column_labels(self, context: Context) -> tuple[str, ...]:
        """Return the label of each column of a matrix; nothing for a column."""
        return () if self.columns is None else labels(self.columns, context)


def count(size: Count, context: Context) -> int:
    """Return the number of rows or columns that a gain has for a plant."""
    if callable(size):
        return size(context)
    counts = {"n": context.n, "m": context.m, "p": context.p}
    total, sign = 0, 1
    for part in size.replace("+", " + ").replace("-", " - ").split():
        if part in "+-":
            sign = 1 if part == "+" else -1
        else:
            total += sign * (counts[part] if part in counts else int(part))
    return total


def counted_by(size: Callable[[Context], int]) -> Message:
    """Return the meaning of a function that counts rows or columns: the entry `gain.size.<its name>`."""
    return Message(f"gain.size.{size.__name__.replace('_', '-')}")


def labels(size: Count, context: Context) -> tuple[str, ...]:
    """Return the names of the states, outputs or channels that a size counts; 1, 2, … for any other size."""
    model = context.model
    if size == "p" and len(context.channels) == context.p:
        return context.channels
    groups = {"n": "states", "m": "outputs"}
    if isinstance(size, str) and size in groups and groups[size] in model:
        return tuple(item["name"] for item in model[groups[size]])
    return tuple(str(i + 1) for i in range(count(size, context)))


@dataclass(frozen=True)
class Option:
    """A structural choice: it changes the equations, not a number in them. ``kind``: choice, integer or channels.

    One of the kind poles is a text by which the default gains are designed (wished_poles.py).

    ``default``: a value, or a function of the Context.
    """

    name: str
    meaning: Message
    kind: str
    default: object
    choices: tuple[str, ...] = ()
    low: int = 0
    high: int = 0


@dataclass(frozen=True)
class Truth:
    """The simulated plant beside an observer, for checks and diagnostics; the observer itself never sees it.

    Args:
        x: true states along the rows (rows, n), in the order of the model's states.
        theta: true faults of the channels that the observer estimates (rows, p).
    """

    x: np.ndarray
    theta: np.ndarray


@dataclass(frozen=True)
class Observed:
    """One observer's run, as its checks and diagnostics see it.

    ``values`` holds every recorded quantity as an array over the recorded rows: the observer's states, its outputs,
    its inputs (``u.* signal.* y.*``), ``t``; its parameters (``g.* m.* x0.* theta0.*``) as numbers, or as arrays over
    the rows where they were changed during the run.
    """

    model: Model | None
    program: Program
    channels: tuple[str, ...]
    facts: dict
    values: dict[str, np.ndarray]
    interval: float  # between rows, s
    context: Context
    first_row: int = 0  # number of the first of these rows, counted from t = 0
    born: int = 0  # row at which the observer began to watch
    wanted: int = 0  # how many of these rows only fill windows: what diagnostics say of them is not looked at
    truth: Truth | None = None  # None where the rows are a record
    probe: Callable[[Sequence[str], Mapping[str, np.ndarray | float]], np.ndarray] | None = None
    """Returns outputs of the observer's program, by name, for other values than the recorded ones: (names, rows)."""

    @property
    def noisy(self) -> tuple[str, ...]:
        """Names of the measured outputs, ``y.*``; ``intensity.y.*`` in the values is their noise's std² · sample
        time."""
        return tuple(n.removeprefix("intensity.") for n in self.values if n.startswith("intensity."))

    def at(self, rows: np.ndarray) -> "Observed":
        """Return the run at some of its rows only."""
        values = {name: value[rows] if np.ndim(value) else value for name, value in self.values.items()}
        truth = self.truth and Truth(self.truth.x[rows], self.truth.theta[rows])
        return replace(self, values=values, truth=truth)

    def gain(self, name: str) -> float:
        """A scalar gain, as it was last."""
        return _last(self.values[f"g.{name}"])

    def gains(self, name: str) -> np.ndarray:
        """Return a gain that is a column or a matrix, as it was last: shape (rows,) or (rows, columns)."""
        prefix = f"g.{name}."
        places = {n.removeprefix(prefix): v for n, v in self.values.items() if n.startswith(prefix)}
        found = {tuple(int(i) for i in place.split(".")): _last(v) for place, v in places.items()}
        shape = tuple(max(index) + 1 for index in zip(*found, strict=True)) if found else (0,)
        return np.array([found[index] for index in sorted(found)]).reshape(shape)

    def matrix(self, name: str, rows: int, cols: int, symmetric: bool = False) -> np.ndarray:
        """A recorded matrix (states or outputs ``name.i.j``) over time: shape (time, rows, cols)."""
        length = len(self.values["t"])
        made = np.empty((length, rows, cols))
        for i in range(rows):
            for j in range(cols):
                a, b = (min(i, j), max(i, j)) if symmetric else (i, j)
                made[:, i, j] = self.values[f"{name}.{a}.{b}"]
        return made


def _last(value: np.ndarray | float) -> float:
    return float(np.ravel(value)[-1])


@dataclass(frozen=True)
class Observer:
    """One kind of observer. ``write`` puts its equations into a Draft; it raises SpecError where it cannot be built.

    ``equations``: (number in the paper, formula) for a reader, in the notation of
    engine/language/render/unicode_math.py; ``where``: (symbol, its meaning). The catalogues have a title, a summary and
    when to take it for every id. ``chooses`` returns the fault channels to estimate where the user names none, for a
    context with all of them; by default all. ``constants``: the numbers of `Draft.constant`, designed for the plant.
    ``carried``: for each state whose name begins with ``via.``, its scale and the deviation of its first value; see
    engine/estimation/covariance_equations.py.
    """

    id: str
    source: str
    gains: tuple[Gain, ...]
    write: Callable[[Draft], None]
    checks: Callable[[Observed], list[Check]]
    options: tuple[Option, ...] = ()
    time: str = "continuous"  # "discrete": works at a sample period; "plant": in the plant's own time
    estimates_theta: bool = True
    residuals: bool = False  # columns `residual.<channel>` in `diagnostics`: above 1 is an alarm
    takes_events: bool = False  # its theory allows for states that jump
    diagnostics: Callable[[Observed], dict[str, np.ndarray]] = lambda run: {}
    equations: tuple[tuple[str, str], ...] = ()
    where: tuple[tuple[str, Message], ...] = ()
    chooses: Callable[[Context], tuple[str, ...]] | None = None
    constants: Callable[[Context], dict[str, np.ndarray]] | None = None
    carried: Callable[[Context], Sequence[tuple[float, float]]] = lambda context: ()

    @property
    def takes_channels(self) -> bool:
        """Return whether it is made for a choice of fault channels: to estimate them, or for residuals."""
        return self.estimates_theta or self.residuals

    @property
    def title(self) -> Message:
        """Return the name of the kind for the user."""
        return Message(f"observer.{self.id}.title")

    @property
    def summary(self) -> Message:
        """Return the purpose of the kind in a sentence."""
        return Message(f"observer.{self.id}.summary")

    @property
    def when(self) -> Message:
        """Return when to take the kind: the end of a sentence that begins with "Take it"."""
        return Message(f"observer.{self.id}.when")
