"""Draft: where an observer writes its equations down, and what it may use: t, u, the known signals and y. Nothing else.

The plant's state and the true θ have no symbol here, so an observer cannot see them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from thetascope.engine.compiler.system import CONTINUOUS, System
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.plant_model import Definition, Model, clock, symbols

if TYPE_CHECKING:
    from sympy import Expr, ImmutableMatrix, Matrix, Symbol

# Over a sample interval: just after its start, in the middle, just before its end; and at the instant of its end, when
# y is taken, just after any jump there.
START, MIDDLE, END, NOW = "", "mid.", "end.", "now."


@dataclass(frozen=True)
class ModelAt:
    """The plant's model at an estimate: f (n×1), h (m×1), Phi (n×p), Psi (m×p), and its Jacobians A (n×n), C (m×n).

    f, h, Phi, Psi and the Jacobians are saturated to the plant's physical domain; the estimate is not.
    A is the Jacobian of f + Φθ̂ in x, C that of h + Ψθ̂ (θ̂ as given; zero where none was).
    """

    f: Matrix
    h: Matrix
    Phi: ImmutableMatrix
    Psi: ImmutableMatrix
    jacobians: Callable[[], tuple[ImmutableMatrix, ImmutableMatrix]]
    put: Callable[[Expr], Expr]  # any expression in the model's own symbols, at this estimate

    @cached_property
    def A(self) -> ImmutableMatrix:
        return self.jacobians()[0]

    @cached_property
    def C(self) -> ImmutableMatrix:
        return self.jacobians()[1]


@dataclass
class Draft:
    """Collects the equations of one observer for one plant.

    ``channels`` are the fault channels it is to estimate, ``gains`` maps a gain's name to its number of entries
    (None for a scalar), ``options`` are its structural choices.
    """

    model: Model
    channels: tuple[str, ...]
    gains: dict[str, int | None]
    options: dict[str, object] = field(default_factory=dict)
    time: str = CONTINUOUS

    def __post_init__(self) -> None:
        self._states: list[Symbol] = []
        self._initial: dict[Symbol, Expr] = {}
        self._update: dict[Symbol, Expr] = {}
        self._definitions: list[tuple[Symbol, Expr]] = []
        self._outputs: dict[str, Expr] = {}
        self._points = 0
        self.facts: dict[str, object] = {}  # what was found while designing; shown to the user, must be JSON

    # ---- what an observer may use ----------------------------------------------------------------------------------

    @property
    def n(self) -> int:
        return self.model.n

    @property
    def m(self) -> int:
        return self.model.m

    @property
    def p(self) -> int:
        return len(self.channels)

    def gain(self, name: str) -> Symbol | ImmutableMatrix:
        """A gain as a symbol, or as a column of symbols; its number is given at run time."""
        size = self.gains[name]
        if size is None:
            return sympy.Symbol(f"g.{name}", real=True)
        return sympy.ImmutableMatrix(size, 1, symbols("g", [f"{name}.{i}" for i in range(size)]))

    @property
    def period(self) -> Symbol:
        """The sample period in seconds (discrete observers)."""
        return sympy.Symbol("g.period", real=True, positive=True)

    def measured(self, when: str = START) -> ImmutableMatrix:
        """y as measured (m×1). Discrete observers see it at the START of the sample interval, and NOW, at its end."""
        return sympy.ImmutableMatrix(self.m, 1, symbols(f"{when}y", self.model.outputs))

    @property
    def x0(self) -> ImmutableMatrix:
        """The initial estimate of the state, given at run time (n×1)."""
        return sympy.ImmutableMatrix(self.n, 1, symbols("x0", self.model.states))

    @property
    def theta0(self) -> ImmutableMatrix:
        """The initial estimate of θ, given at run time (p×1)."""
        return sympy.ImmutableMatrix(self.p, 1, symbols("theta0", self.channels))

    # ---- writing down ----------------------------------------------------------------------------------------------

    def states(self, name: str, rows: int, cols: int = 1, initial: Matrix | Expr | float = 0) -> ImmutableMatrix:
        """Declare rows × cols states. ``initial`` is a matrix, or one value for all."""
        made = sympy.ImmutableMatrix(rows, cols, lambda i, j: sympy.Symbol(f"{name}.{i}.{j}", real=True))
        self._declare(
            list(made), [initial[i] for i in range(rows * cols)] if isinstance(initial, sympy.MatrixBase) else initial
        )
        return made

    def symmetric(self, name: str, size: int, initial: Matrix) -> ImmutableMatrix:
        """Declare a symmetric matrix of states; only its upper triangle is kept."""
        made = sympy.ImmutableMatrix(
            size, size, lambda i, j: sympy.Symbol(f"{name}.{min(i, j)}.{max(i, j)}", real=True)
        )
        upper = [(i, j) for i in range(size) for j in range(i, size)]
        self._declare([made[i, j] for i, j in upper], [initial[i, j] for i, j in upper])
        return made

    def estimate_of_state(self, initial: Matrix | None = None) -> ImmutableMatrix:
        """Declare x̂ (n×1), starting from x0 unless said otherwise."""
        made = sympy.ImmutableMatrix(self.n, 1, symbols("xh", self.model.states))
        self._declare(list(made), list(self.x0 if initial is None else initial))
        return made

    def estimate_of_theta(self) -> ImmutableMatrix:
        """Declare θ̂ (p×1), starting from theta0."""
        made = sympy.ImmutableMatrix(self.p, 1, symbols("thetah", self.channels))
        self._declare(list(made), list(self.theta0))
        return made

    def _declare(self, states: list[Symbol], initial: Sequence | float) -> None:
        values = initial if isinstance(initial, (list, tuple)) else [initial] * len(states)
        for state, value in zip(states, values, strict=True):
            if state in self._initial:
                raise ValueError(f"state {state} is declared twice")
            self._states.append(state)
            self._initial[state] = sympy.sympify(value)

    def let(self, name: str, value):
        """Name an intermediate scalar or matrix and return its symbols: keeps expressions small. Zeros stay zeros."""
        if not isinstance(value, sympy.MatrixBase):
            return self._let(name, sympy.sympify(value))
        return sympy.ImmutableMatrix(*value.shape, lambda i, j: self._let(f"{name}.{i}.{j}", value[i, j]))

    def let_symmetric(self, name: str, value: Matrix) -> ImmutableMatrix:
        """As ``let`` for a matrix known to be symmetric: computed once above the diagonal."""
        size = value.shape[0]
        upper = {(i, j): self._let(f"{name}.{i}.{j}", value[i, j]) for i in range(size) for j in range(i, size)}
        return sympy.ImmutableMatrix(size, size, lambda i, j: upper[min(i, j), max(i, j)])

    def _let(self, name: str, value: Expr) -> Expr:
        if value.is_Number or value.is_Symbol:
            return value
        symbol = sympy.Symbol(f"let.{name}", real=True)
        self._definitions.append((symbol, value))
        return symbol

    def set(self, states: Symbol | ImmutableMatrix, value: Matrix | Expr) -> None:
        """Give the derivative (continuous) or next value (discrete) of states declared before."""
        if isinstance(states, sympy.Symbol):
            self._update[states] = sympy.sympify(value)
            return
        for i in range(states.shape[0]):
            for j in range(states.shape[1]):
                self._update.setdefault(states[i, j], sympy.sympify(value[i, j]))

    def output(self, name: str, value: Expr) -> None:
        """Offer a named quantity to be recorded, e.g. ``Omega.0.1``."""
        self._outputs[name] = sympy.sympify(value)

    def outputs(self, name: str, matrix: Matrix) -> None:
        """Offer all entries of a matrix as ``name.i.j``."""
        for i in range(matrix.shape[0]):
            for j in range(matrix.shape[1]):
                self.output(f"{name}.{i}.{j}", matrix[i, j])

    def estimates(self, x: Matrix, theta: Matrix | None, y: Matrix) -> None:
        """Offer x̂ (in the user's coordinates), θ̂ and ŷ: what is recorded as L.x.*, L.theta.*, L.y.*."""
        for prefix, names, values in (
            ("x", self.model.states, x),
            ("theta", self.channels if theta is not None else (), theta),
            ("y", self.model.outputs, y),
        ):
            for i, name in enumerate(names):
                self.output(f"{prefix}.{name}", values[i])

    # ---- the model at an estimate ------------------------------------------------------------------------------------

    def at(
        self,
        x: Sequence | Matrix,
        theta: Matrix | None = None,
        when: str | sympy.Rational = START,
        saturate: bool = True,
    ) -> ModelAt:
        """The plant's model at the estimate x (n×1) with inputs and signals at ``when``.

        ``when`` is START, MIDDLE, END, NOW, or a fraction of the sample interval; there, inputs and signals are on the
        parabola through the first three.

        Equations that are affine in the states take x̂ as it is; the others, h where not affine, and the fault
        coefficients take x̂ saturated to the plant's domain, and definitions saturated to theirs.
        """
        model = self.model
        self._points += 1
        mark = f"m{self._points}"
        outside = self._outside(when)
        plain = {s: sympy.sympify(e) for s, e in zip(model.x, x, strict=True)} | outside
        inside = dict(plain)
        if saturate:
            for s, e in zip(model.x, x, strict=True):
                inside[s] = self._let(f"{mark}.{s.name}", _clip(sympy.sympify(e), *map(_number, model.domain(s.name))))
        for d in model.definitions:
            inside[d.symbol] = self._let(f"{mark}.{d.symbol.name}", self._clipped(d, inside, saturate))
        plain |= {d.symbol: inside[d.symbol] for d in model.definitions}
        put = lambda e: e.xreplace(inside)
        f = sympy.Matrix([e.xreplace(plain if affine else inside) for e, affine in zip(model.f, model.is_affine)])
        flat_h = [not (model.jacobian(sympy.Matrix([e])).free_symbols & set(model.x)) for e in model.h]
        h = sympy.Matrix([e.xreplace(plain if flat else inside) for e, flat in zip(model.h, flat_h)])
        Phi, Psi = (
            sympy.ImmutableMatrix(M.applyfunc(put)) for M in (model.Phi(self.channels), model.Psi(self.channels))
        )
        return ModelAt(f, h, Phi, Psi, lambda: self._jacobians(theta, put), put)

    def _outside(self, when: str | sympy.Rational) -> dict[Symbol, Expr]:
        model = self.model
        fraction = {START: sympy.S.Zero, MIDDLE: sympy.S.Half, END: sympy.S.One, NOW: sympy.S.One}.get(when, when)
        swap: dict[Symbol, Expr] = {}
        for known, prefix, names in ((model.u, "u", model.inputs), (model.signals, "signal", model.signal_names)):
            here = (
                symbols(f"{when}{prefix}", names) if isinstance(when, str) else self._between(prefix, names, fraction)
            )
            swap |= dict(zip(known, here))
        swap |= dict(zip(model.parameters, symbols("m", model.parameter_names)))
        if fraction:
            swap[clock()] = clock() + fraction * self.period
        return swap

    def _between(self, prefix: str, names: Sequence[str], fraction: sympy.Rational) -> Sequence[Expr]:
        """Known quantities at a fraction of the sample interval: on the parabola through START, MIDDLE and END."""
        start, middle, end = (symbols(f"{when}{prefix}", names) for when in (START, MIDDLE, END))
        exact = {sympy.S.Zero: start, sympy.S.Half: middle, sympy.S.One: end}
        if fraction in exact:
            return exact[fraction]
        by_middle, by_end = 4 * fraction * (1 - fraction), fraction * (2 * fraction - 1)
        return [
            self._let(f"{prefix}.{n}.at{fraction}", a + by_middle * (b - a) + by_end * (c - a))
            for n, a, b, c in zip(names, start, middle, end)
        ]

    def _clipped(self, d: Definition, inside: dict, saturate: bool) -> Expr:
        value = d.expression.xreplace(inside)
        if not saturate or (d.low is None and d.high is None):
            return value
        low, high = (b.xreplace(inside) if b is not None else None for b in (d.low, d.high))
        return _clip(value, low, high)

    def _jacobians(self, theta: Matrix | None, put: Callable) -> tuple[ImmutableMatrix, ImmutableMatrix]:
        model = self.model
        A, C = model.jacobian(model.f), model.jacobian(model.h)
        if theta is not None and self.p:
            Phi, Psi = model.Phi(self.channels), model.Psi(self.channels)
            for j in range(self.p):  # ∂(Φθ)/∂x, one channel at a time
                A = A + model.jacobian(Phi[:, j]) * sympy.Symbol(f"theta#{j}")
                C = C + model.jacobian(Psi[:, j]) * sympy.Symbol(f"theta#{j}")
            swap = {sympy.Symbol(f"theta#{j}"): theta[j] for j in range(self.p)}
            A, C = A.xreplace(swap), C.xreplace(swap)
        return sympy.ImmutableMatrix(A.applyfunc(put)), sympy.ImmutableMatrix(C.applyfunc(put))

    # ---- the finished System ------------------------------------------------------------------------------------------

    def system(self, name: str) -> System:
        """The System: inputs ``u.* signal.* y.*`` (discrete also ``mid.* end.* now.*``), parameters ``g.* m.* x0.* theta0.*``.

        Initial values of the states are offered as outputs ``init.<state>``.
        """
        missing = [s.name for s in self._states if s not in self._update]
        if missing:
            raise ValueError(f"{name}: no update for {', '.join(missing)}")
        outputs = dict(self._outputs) | {f"init.{s.name}": self._initial[s] for s in self._states}
        times = (START,) if self.time == CONTINUOUS else (START, MIDDLE, END, NOW)
        model = self.model
        inputs = [
            s
            for w in times
            for prefix, names in (("u", model.inputs), ("signal", model.signal_names), ("y", model.outputs))
            for s in symbols(w + prefix, names)
        ]
        gains = [
            s
            for g, size in self.gains.items()
            for s in (symbols("g", [g]) if size is None else symbols("g", [f"{g}.{i}" for i in range(size)]))
        ]
        if self.time != CONTINUOUS:
            gains.append(self.period)
        parameters = (*gains, *symbols("m", model.parameter_names), *self.x0, *self.theta0)
        return System(
            name=name,
            time=self.time,
            states=tuple(self._states),
            inputs=tuple(inputs),
            parameters=tuple(parameters),
            update=tuple(self._update[s] for s in self._states),
            outputs=outputs,
            definitions=tuple(self._definitions),
        )


def _number(bound: float | None) -> Expr | None:
    return None if bound is None else sympy.Float(bound)


def _clip(value: Expr, low: Expr | None, high: Expr | None) -> Expr:
    if low is not None:
        value = sympy.Max(value, low, evaluate=False)
    return value if high is None else sympy.Min(value, high, evaluate=False)
