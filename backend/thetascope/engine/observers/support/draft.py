"""Draft: the equations of one observer for one plant, as functions of t, u, the known signals φ and the measured y.

The plant's state and the true θ have no symbol here, so an observer cannot use them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, overload

from thetascope.engine.compiler.system import BEGIN, CONTINUOUS, System
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.events import Sensitivity, events_at_end, events_of_step
from thetascope.engine.model.plant_model import Model, symbols
from thetascope.engine.observers.support.matrices import Matrix, Product, column, expression, symbols_matrix, symmetric
from thetascope.engine.observers.support.model_at import END, MIDDLE, NOW, START, ModelAt, Points
from thetascope.engine.observers.support.symmetry import require_symmetric

if TYPE_CHECKING:
    from sympy import Expr, ImmutableMatrix, Rational, Symbol

__all__ = ["END", "MIDDLE", "NOW", "START", "Draft", "Matrix", "ModelAt"]

Size = int | tuple[int, int] | None
"""The size of a gain: None for a number, rows for a column, (rows, columns) for a matrix."""


@dataclass
class Draft:
    """Collects the equations of one observer for one plant.

    Args:
        model: the plant's model.
        channels: the fault channels to estimate.
        gains: the size of each gain by name.
        options: the structural choices by name.
        time: continuous or discrete.
    """

    model: Model
    channels: tuple[str, ...]
    gains: dict[str, Size]
    options: dict[str, object] = field(default_factory=dict)
    time: str = CONTINUOUS

    def __post_init__(self) -> None:
        self._states: list[Symbol] = []
        self._initial: dict[Symbol, Expr] = {}
        self._update: dict[Symbol, Expr] = {}
        self._definitions: dict[Symbol, Expr] = {}
        self._names: set[str] = set()
        self._outputs: dict[str, Expr] = {}
        self._products: dict[tuple[ImmutableMatrix, ImmutableMatrix], Matrix] = {}
        self._symmetric: list[Matrix] = []
        self._claimed_symmetric: list[tuple[str, Matrix]] = []
        self._constants: dict[str, list[Symbol]] = {}
        self._points = Points(self.channels, self.period, self._let)
        self.facts: dict[str, Any] = {}
        """Results of the design that checks and the user need; must be JSON."""

    # ---- quantities that an observer may use -------------------------------------------------------------------------

    @property
    def n(self) -> int:
        """Return the number of states."""
        return self.model.n

    @property
    def m(self) -> int:
        """Return the number of outputs."""
        return self.model.m

    @property
    def p(self) -> int:
        """Return the number of fault channels to estimate."""
        return len(self.channels)

    def gain(self, name: str) -> Any:
        """Return a gain: a symbol, or a Matrix of symbols. Its numbers are given at run time."""
        size = self.gains[name]
        names = gain_symbols(name, size)
        if size is None:
            return sympy.Symbol(names[0], real=True)
        rows, columns = size if isinstance(size, tuple) else (size, 1)
        return Matrix(symbols_matrix(rows, columns, lambda i, j: names[i * columns + j]), name, self)

    def constant(self, name: str, rows: int, columns: int) -> Matrix:
        """Return numbers designed for the plant, rows × columns, which `Observer.constants` gives at run time."""
        entries = symbols_matrix(rows, columns, lambda i, j: f"k.{name}.{i}.{j}")
        self._constants[name] = list(entries)
        return Matrix(entries, name, self)

    @property
    def period(self) -> Symbol:
        """Return the sample period in seconds (discrete observers)."""
        return sympy.Symbol("g.period", real=True, positive=True)

    def measured(self, when: str = START) -> Matrix:
        """Return y as measured (m×1). Discrete observers have it at START and, for the end of the sample interval,
        NOW."""
        return self._matrix(column(symbols(f"{when}y", self.model.outputs)), "y")

    def inputs(self, when: str = START) -> Matrix:
        """Return u at an instant (inputs × 1)."""
        return self._matrix(column(symbols(f"{when}u", self.model.inputs)), "u")

    @property
    def x0(self) -> Matrix:
        """Return the initial estimate of the state, given at run time (n×1)."""
        return self._matrix(column(symbols("x0", self.model.states)), "x0")

    @property
    def theta0(self) -> Matrix:
        """Return the initial estimate of θ, given at run time (p×1)."""
        return self._matrix(column(symbols("theta0", self.channels)), "theta0")

    # ---- declarations ------------------------------------------------------------------------------------------------

    def states(self, name: str, rows: int, cols: int = 1, initial: Matrix | Expr | float = 0) -> Matrix:
        """Declare rows × cols states. ``initial`` is a matrix, or one value for all."""
        states = symbols_matrix(rows, cols, lambda i, j: f"{name}.{i}.{j}")
        self._declare(list(states), list(initial) if isinstance(initial, Matrix) else [initial] * (rows * cols))
        return Matrix(states, name, self)

    def symmetric(self, name: str, size: int, initial: Matrix) -> Matrix:
        """Declare a symmetric matrix of states; its upper triangle is integrated."""
        states = symbols_matrix(size, size, lambda i, j: f"{name}.{min(i, j)}.{max(i, j)}")
        upper = [(i, j) for i in range(size) for j in range(i, size)]
        self._declare([states[i, j] for i, j in upper], [initial[i, j] for i, j in upper])
        self._symmetric.append(Matrix(states, name, self))
        return self._symmetric[-1]

    def estimate_of_state(self, initial: Matrix | None = None) -> Matrix:
        """Declare x̂ (n×1). It starts from x0 by default."""
        states = symbols("xh", self.model.states)
        self._declare(states, list(self.x0 if initial is None else initial))
        return self._matrix(column(states), "x")

    def estimate_of_theta(self) -> Matrix:
        """Declare θ̂ (p×1). It starts from theta0."""
        states = symbols("thetah", self.channels)
        self._declare(states, list(self.theta0))
        return self._matrix(column(states), "theta")

    def _declare(self, states: Iterable[Symbol], initial: Iterable[Expr | float]) -> None:
        for state, value in zip(states, initial, strict=True):
            if state in self._initial:
                raise ValueError(f"the state {state} is declared twice")
            self._states.append(state)
            self._initial[state] = expression(value)

    # ---- equations ---------------------------------------------------------------------------------------------------

    @overload
    def let(self, name: str, value: Matrix, symmetric: bool = False) -> Matrix: ...
    @overload
    def let(self, name: str, value: Expr | float, symmetric: bool = False) -> Expr: ...
    def let(self, name: str, value: Matrix | Expr | float, symmetric: bool = False) -> Matrix | Expr:
        """Name an intermediate result and return its symbols, so that it is written once and expressions stay small.

        Args:
            name: unique in the draft.
            value: a scalar or a matrix. Numbers and symbols in it stay unchanged.
            symmetric: the value is symmetric, so it is computed above the diagonal only.

        Raises ValueError if the name exists.
        """
        if not isinstance(value, Matrix):
            return self._let(name, expression(value))
        named = self._named(name, value, symmetric)
        if isinstance(value, Product):
            self._remember(*value.last, named)
        return named

    def _named(self, name: str, value: Matrix, is_symmetric: bool = False) -> Matrix:
        entries = value.entries
        self._names.add(name)

        def entry(i: int, j: int) -> Expr:
            return self._let(f"{name}.{i}.{j}", entries[i, j])

        if is_symmetric:
            self._claimed_symmetric.append((name, value))
            return self._matrix(symmetric(value.shape[0], entry), name)
        return Matrix(sympy.ImmutableMatrix(*value.shape, entry), name, self)

    def _let(self, name: str, value: Expr) -> Expr:
        symbol = sympy.Symbol(f"let.{name}", real=True)
        if symbol in self._definitions:
            raise ValueError(f"{name} is defined twice")
        if value.is_Number or value.is_Symbol:
            return value
        self._definitions[symbol] = value
        return symbol

    def name_product(self, left: Matrix, right: Matrix, entries: ImmutableMatrix) -> Matrix:
        """Name an intermediate product after its factors; see matrices.py."""
        name = f"{left.name}{right.name}" or "product"
        unique = next(n for n in (name, *(f"{name}#{k}" for k in range(2, 10_000))) if n not in self._names)
        named = self._named(unique, Matrix(entries))
        self._remember(left, right, named)
        return named

    def named_product(self, left: Matrix, right: Matrix) -> Matrix | None:
        """Return the product of two matrices, or of their transposes, where it has a name."""
        return self._products.get((left.entries, right.entries))

    def _remember(self, left: Matrix, right: Matrix, product: Matrix) -> None:
        self._products.setdefault((left.entries, right.entries), product)
        self._products.setdefault((right.entries.T, left.entries.T), product.T)

    def set(self, states: Symbol | Matrix, value: Matrix | Expr | float) -> None:
        """Set the derivative (continuous time) or the next value (discrete time) of states.

        The value of a symmetric matrix must be symmetric. Raises ValueError for a second value, another shape, or a
        state that was not declared.
        """
        if not isinstance(states, Matrix):
            self._set(states, expression(value))
            return
        if not isinstance(value, Matrix) or value.shape != states.shape:
            raise ValueError(f"{states.name} {states.shape} is set to {getattr(value, 'shape', 'a scalar')}")
        left, right = states.entries, value.entries
        (rows, columns), mirrored = states.shape, left == left.T
        if mirrored and rows > 1:
            self._claimed_symmetric.append((states.name, value))
        for i in range(rows):
            for j in range(i if mirrored else 0, columns):
                self._set(left[i, j], right[i, j])

    def _set(self, state: Symbol, value: Expr) -> None:
        if state not in self._initial:
            raise ValueError(f"{state} is set but is no state")
        if state in self._update:
            raise ValueError(f"{state} is set twice")
        self._update[state] = value

    def output(self, name: str, value: Expr) -> None:
        """Declare a quantity that can be recorded, for example ``Omega.0.1``. Raises ValueError if the name exists."""
        if name in self._outputs:
            raise ValueError(f"the output {name} is offered twice")
        self._outputs[name] = expression(value)

    def outputs(self, name: str, matrix: Matrix) -> None:
        """Declare all entries of a matrix as outputs ``name.i.j``."""
        rows, columns = matrix.shape
        for i in range(rows):
            for j in range(columns):
                self.output(f"{name}.{i}.{j}", matrix[i, j])

    def estimates(self, x: Iterable[Expr], theta: Iterable[Expr] | None, y: Iterable[Expr]) -> None:
        """Declare x̂ (in the plant's coordinates), θ̂ and ŷ as outputs: columns L.x.*, L.theta.* and L.y.* of a run."""
        groups = (("x", self.model.states, x), ("theta", self.channels, theta), ("y", self.model.outputs, y))
        for prefix, names, values in groups:
            for name, value in zip(names, values, strict=True) if values is not None else ():
                self.output(f"{prefix}.{name}", value)

    def at(
        self,
        x: Iterable[Expr],
        theta: Sequence[Expr] | Matrix | None = None,
        when: str | Rational = START,
        saturate: bool = True,
        model: Model | None = None,
    ) -> ModelAt:
        """Return the plant's model at an estimate.

        Equations that are affine in the states use x̂ unchanged. The others, an h that is not affine, and the fault
        coefficients use x̂ saturated to the plant's domain, and definitions saturated to theirs.

        Args:
            x: the estimate of the state (n×1).
            theta: the estimate of θ (p×1), for the Jacobians.
            when: inputs and signals are those at START, MIDDLE, END, NOW, or at a fraction of the sample interval (on
                the parabola through the first three).
            saturate: False uses the model without saturation.
            model: another model of the plant, with the same states, inputs and outputs.
        """
        return self._points.at(model or self.model, x, None if theta is None else list(theta), when, saturate)

    def _matrix(self, value: Matrix, name: str) -> Matrix:
        return Matrix(value.entries, name, self)

    # ---- the finished System -----------------------------------------------------------------------------------------

    @property
    def definitions(self) -> tuple[tuple[Symbol, Expr], ...]:
        """Return the intermediate results in their order."""
        return tuple(self._definitions.items())

    def system(self, name: str) -> System:
        """Return the System: inputs ``u.* signal.* y.*`` (discrete time also ``mid.* end.* now.*``), parameters
        ``g.* m.* x0.* theta0.*``. Initial values of the states are offered as outputs ``init.<state>``.

        Raises ValueError where a state has no update, or a matrix that should be symmetric is not.
        """
        missing = [s.name for s in self._states if s not in self._update]
        if missing:
            raise ValueError(f"{name}: no update for {', '.join(missing)}")
        require_symmetric(self._claimed_symmetric, self.definitions, self._symmetric)
        model, times = self.model, (START,) if self.time == CONTINUOUS else (START, MIDDLE, END, NOW)
        groups = (("u", model.inputs), ("signal", model.signal_names), ("y", model.outputs))
        inputs = [s for when in times for prefix, names in groups for s in symbols(when + prefix, names)]
        gains = [sympy.Symbol(s, real=True) for g, size in self.gains.items() for s in gain_symbols(g, size)]
        gains += [s for constants in self._constants.values() for s in constants]
        if self.time != CONTINUOUS:
            gains.append(self.period)
        after = self._after_events(name)
        return System(
            name=name,
            time=self.time,
            states=tuple(self._states),
            inputs=tuple(inputs),
            parameters=(*gains, *symbols("m", model.parameter_names), *self.x0, *self.theta0),
            update=tuple(self._update[s] for s in self._states),
            outputs=dict(self._outputs) | {f"init.{s.name}": self._initial[s] for s in self._states},
            definitions=self.definitions,
            after=after,
        )

    def _after_events(self, name: str) -> tuple[Expr, ...]:
        """Return the states after the plant's events, examined at x̂; none without events or at a sample period."""
        if not self.model.events or self.time != CONTINUOUS:
            return ()
        estimate = symbols("xh", self.model.states)
        if not set(estimate) <= set(self._states):
            raise ValueError(f"{name} takes events, but does not estimate every state")
        model, theta = self.model, list(symbols("thetah", self.channels))
        end = dict(zip(model.x, estimate, strict=True))
        begin = {s: sympy.Symbol(f"{BEGIN}{e.name}", real=True) for s, e in end.items()}
        definitions = [(d.symbol, d.expression) for d in model.definitions]

        def rate(x: list[Expr]) -> list[tuple[Expr, Expr]]:
            known = theta if set(theta) <= set(self._states) else [sympy.S.Zero] * len(theta)
            at = self.at(x, known)
            f = at.f + at.Phi @ column(known) if theta else at.f
            return [(e, at.A[i, i]) for i, e in enumerate(f)]

        def let(part: str, value: Expr) -> Expr:
            return self._let(f"end.{part}", value)

        moved = events_of_step(model.events, definitions, (begin, end), self._points.known(model, START), let, rate)
        after = dict(zip(estimate, moved, strict=True))
        return tuple(after.get(s, s) for s in self._states)

    def events_at(
        self, name: str, x: Iterable[Expr], when: str | Rational = START, S: Matrix | None = None
    ) -> tuple[list[Expr], list[list[Expr]]]:
        """Return the estimate x (n×1) after the plant's events, and its sensitivity S (n×q) after them.

        ``name`` is unique in the draft; inputs and signals are those at an instant.
        """
        model = self.model
        states = dict(zip(model.x, map(expression, x), strict=True))
        definitions = [(d.symbol, d.expression) for d in model.definitions]
        sensitivity = None if S is None else Sensitivity(S.entries.tolist(), model.jacobian)

        def let(part: str, value: Expr) -> Expr:
            return self._let(f"{name}.{part}", value)

        return events_at_end(model.events, definitions, states, self._points.known(model, when), let, sensitivity)


def gain_symbols(name: str, size: Size) -> list[str]:
    """Return the parameters of a program that hold a gain: ``g.K``, ``g.K.i`` or ``g.K.i.j`` row by row."""
    if size is None:
        return [f"g.{name}"]
    if isinstance(size, tuple):
        return [f"g.{name}.{i}.{j}" for i in range(size[0]) for j in range(size[1])]
    return [f"g.{name}.{i}" for i in range(size)]
