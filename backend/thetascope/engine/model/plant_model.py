"""Model: the equations of a plant in SymPy, with Φ and Ψ from its fault channels.

    x' = f(x, u, φ, t) + Φ(x, u, φ, t) θ        (next value instead of derivative in discrete time)
    y  = h(x, u, φ, t) + Ψ(x, u, φ, t) θ

The engine reads plants as plain data (the dump of thetascope_schemas' Plant) and does not import the schemas.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from thetascope.engine.compiler.system import BEGIN, CONTINUOUS, DISCRETE, System
from thetascope.engine.errors import SpecError
from thetascope.engine.language.derivatives import derivative
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.language.parser import parse
from thetascope.engine.language.tables import tables_of
from thetascope.engine.model.algebraic import check_start, solutions, variable
from thetascope.engine.model.events import Event, events_of_step
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr, ImmutableMatrix, Matrix, Symbol

_MOST_PARTS = 20_000  # maximum number of nodes of an expanded definition


def clock() -> Symbol:
    """Return the symbol of time, t."""
    return sympy.Symbol("t", real=True)


def symbols(prefix: str, names: Sequence[str]) -> tuple[Symbol, ...]:
    """Return the real symbols ``prefix.name``."""
    return tuple(sympy.Symbol(f"{prefix}.{name}", real=True) for name in names)


@dataclass(frozen=True)
class Channel:
    """A fault channel: an unknown parameter θ, and its coefficients in the equations."""

    name: str
    kind: str  # actuator, process or sensor
    enters: dict[str, Expr]  # state or output name → coefficient
    data: dict


@dataclass(frozen=True)
class Definition:
    """An intermediate quantity, and its physical range [low, high] to which observers saturate it (None: no bound)."""

    symbol: Symbol
    expression: Expr
    low: Expr | None
    high: Expr | None


def expanded(definitions: Sequence[Definition], field: str) -> dict[Symbol, Expr]:
    """Return definitions, each with the earlier ones written out. Raises SpecError if one becomes too large."""
    written: dict[Symbol, Expr] = {}
    sizes: dict[Symbol, int] = {}
    for i, d in enumerate(definitions):
        # counted before it is expanded: each definition may double the last one, and 30 doublings make 10⁹ nodes
        sizes[d.symbol] = sum(sizes.get(part, 1) for part in sympy.preorder_traversal(d.expression))
        if sizes[d.symbol] > _MOST_PARTS:
            name = d.symbol.name
            raise SpecError(f"{field}.{i}.expression", name, Message("expression.definition.large", most=_MOST_PARTS))
        written[d.symbol] = d.expression.xreplace(written)
    return written


class Model:
    """The model of one plant. ``x``, ``u``, ``signals`` and ``parameters`` are tuples of real symbols without a prefix.

    ``f`` (n × 1) and ``h`` (m × 1) are the right-hand sides without faults; ``period`` is in s, None in continuous
    time.
    """

    def __init__(self, data: Mapping):
        self.data = dict(data)
        self.id = data["id"]
        discrete = data["time"]["kind"] == DISCRETE
        self.time = DISCRETE if discrete else CONTINUOUS
        self.period: float | None = data["time"]["period"] if discrete else None
        self.states = tuple(s["name"] for s in data["states"])
        self.inputs = tuple(s["name"] for s in data["inputs"])
        self.outputs = tuple(s["name"] for s in data["outputs"])
        self.signal_names = tuple(s["name"] for s in data["signals"])
        self.parameter_names = tuple(s["name"] for s in data["parameters"])
        self.tables = tables_of(data)
        self._symbols = {
            n: sympy.Symbol(n, real=True)
            for n in (*self.states, *self.inputs, *self.signal_names, *self.parameter_names)
        } | {"t": clock()}
        self.x, self.u, self.signals, self.parameters = (
            tuple(self._symbols[n] for n in names)
            for names in (self.states, self.inputs, self.signal_names, self.parameter_names)
        )
        self.algebraic = tuple(a["name"] for a in data.get("algebraic", ()))
        self._symbols |= {n: sympy.Symbol(n, real=True) for n in self.algebraic}
        self.definitions = tuple(self._definition(i, d) for i, d in enumerate(data["definitions"]))
        if self.algebraic:
            self.definitions = self._with_roots()
        self.f = sympy.Matrix([self.expression(data["dynamics"][s], f"dynamics.{s}") for s in self.states])
        self.h = sympy.Matrix(
            [self.expression(o["expression"], f"outputs.{i}.expression") for i, o in enumerate(data["outputs"])]
        )
        self.channels = tuple(self._channel(i, c) for i, c in enumerate(data["channels"]))
        self.events = tuple(self._event(i, e) for i, e in enumerate(data.get("events", ())))
        self.disturbances: tuple[Symbol, ...] = ()  # further inputs of a true plant

    # ---- reading the text ----------------------------------------------------------------------------------------

    def expression(self, text: str, field: str) -> Expr:
        """Return the expression of a text in the plant's names. Raises ExpressionError."""
        return parse(text, self._symbols, field, tables=self.tables).sympy(self._symbols, self.tables)

    def _definition(self, i: int, data: Mapping) -> Definition:
        """Return the i-th definition, and declare its symbol for later expressions."""
        expression = self.expression(data["expression"], f"definitions.{i}.expression")
        low, high = self._bounds(data, f"definitions.{i}")
        symbol = self._symbols[data["name"]] = sympy.Symbol(data["name"], real=True)
        return Definition(symbol, expression, low, high)

    def _with_roots(self) -> tuple[Definition, ...]:
        """Return the definitions, those of the algebraic variables before the ones that depend on them."""
        dependent, before, after = {self._symbols[n] for n in self.algebraic}, [], []
        for d in self.definitions:
            (after if d.expression.free_symbols & dependent else before).append(d)
            dependent |= {d.symbol} if d in after else set()
        inner = expanded(after, "definitions")
        allowed = {n: s for n, s in self._symbols.items() if s not in dependent}
        entries = list(enumerate(self.data["algebraic"]))
        unknowns = [variable(i, a, self._symbols, allowed, self.tables, inner) for i, a in entries]
        bounds = {a["name"]: self._bounds(a, f"algebraic.{i}") for i, a in entries}
        roots = [Definition(s, e, *bounds[s.name]) for s, e in solutions(unknowns)]
        definitions = (*before, *roots, *after)
        check_start(unknowns, [(d.symbol, d.expression) for d in definitions], self.data)
        return definitions

    def _bounds(self, data: Mapping, field: str) -> tuple[Expr | None, Expr | None]:
        low, high = data.get("domain") or (None, None)
        return self._bound(low, f"{field}.domain.0"), self._bound(high, f"{field}.domain.1")

    def _bound(self, bound: float | str | None, field: str) -> Expr | None:
        if bound is None:
            return None
        return self.expression(bound, field) if isinstance(bound, str) else sympy.Float(bound)

    def _event(self, i: int, data: Mapping) -> Event:
        condition = parse(data["when"], self._symbols, f"events.{i}.when", tables=self.tables, condition=True)
        values = {self._symbols[s]: self.expression(text, f"events.{i}.set.{s}") for s, text in data["set"].items()}
        return Event(condition.sympy(self._symbols, self.tables), values)

    def _channel(self, i: int, data: Mapping) -> Channel:
        enters = {
            where: self.expression(text, f"channels.{i}.enters.{where}") for where, text in data["enters"].items()
        }
        return Channel(data["name"], data["kind"], enters, dict(data))

    # ---- the matrices --------------------------------------------------------------------------------------------

    @property
    def n(self) -> int:
        """Return the number of states."""
        return len(self.states)

    @property
    def m(self) -> int:
        """Return the number of outputs."""
        return len(self.outputs)

    def channel(self, name: str) -> Channel:
        """Return a fault channel by name. Raises SpecError, which lists the known ones."""
        for channel in self.channels:
            if channel.name == name:
                return channel
        names = [c.name for c in self.channels]
        remedy = Message("suggest.all", names=names) if names else Message("suggest.none")
        raise SpecError("options.channels", name, Message("plant.channel.unknown", name=name), remedy)

    def Phi(self, channels: Sequence[str]) -> ImmutableMatrix:
        """Return Φ, n × p: the coefficients of p channels in the state equations."""
        entering = [self.channel(c) for c in channels]
        return sympy.ImmutableMatrix(self.n, len(entering), lambda i, j: entering[j].enters.get(self.states[i], 0))

    def Psi(self, channels: Sequence[str]) -> ImmutableMatrix:
        """Return Ψ, m × p: the coefficients of p channels in the output equations."""
        entering = [self.channel(c) for c in channels]
        return sympy.ImmutableMatrix(self.m, len(entering), lambda i, j: entering[j].enters.get(self.outputs[i], 0))

    @cached_property
    def expansion(self) -> dict[Symbol, Expr]:
        """Return the definitions, expanded to declared quantities. Raises SpecError if one becomes too large."""
        return expanded(self.definitions, "definitions")

    @cached_property
    def _slopes(self) -> dict[Symbol, dict[Symbol, Expr]]:
        """Return ∂definition/∂state, by the chain rule through earlier definitions, which stay symbols."""
        slopes: dict[Symbol, dict[Symbol, Expr]] = {}
        for d in self.definitions:
            slopes[d.symbol] = {s: self._total(d.expression, s, slopes) for s in self.x}
        return slopes

    @staticmethod
    def _total(e: Expr, state: Symbol, slopes: Mapping[Symbol, Mapping[Symbol, Expr]]) -> Expr:
        """Return the total derivative of an expression with respect to a state."""
        free = e.free_symbols
        direct = derivative(e, state) if state in free else sympy.S.Zero
        return direct + sum(
            (derivative(e, d) * s[state] for d, s in slopes.items() if d in free and s[state] != 0), sympy.S.Zero
        )

    def jacobian(self, vector: Matrix) -> ImmutableMatrix:
        """Return ∂vector/∂x, shape len(vector) × n. Definitions stay symbols, to substitute their saturated values."""
        return sympy.ImmutableMatrix(len(vector), self.n, lambda i, j: self._total(vector[i], self.x[j], self._slopes))

    @cached_property
    def is_affine(self) -> tuple[bool, ...]:
        """Return for each state equation whether it is affine in the states."""
        jacobian = self.jacobian(self.f)
        bound = set(self.x) | {d for d, s in self._slopes.items() if any(v != 0 for v in s.values())}
        return tuple(not (jacobian.row(i).free_symbols & bound) for i in range(self.n))

    def domain(self, state: str) -> tuple[float | None, float | None]:
        """Return the physical range [low, high] of a state; None: no bound."""
        entry = self.data["states"][self.states.index(state)]
        low, high = entry.get("domain") or (None, None)
        return low, high

    # ---- the plant itself ----------------------------------------------------------------------------------------

    def system(self) -> System:
        """Return the plant with its faults: states x.*, inputs u.*, signal.*, theta.*, parameters p.*, outputs y.*."""
        f, h = self.with_faults()
        swap = self.prefixed
        after, more = self.after_events()
        return System(
            name=self.id,
            time=self.time,
            states=tuple(swap[s] for s in self.x),
            inputs=(*(swap[s] for s in self.u), *(swap[s] for s in self.signals), *self.theta, *self.disturbances),
            parameters=tuple(swap[s] for s in self.parameters),
            update=tuple(e.xreplace(swap) for e in f),
            outputs={f"y.{name}": e.xreplace(swap) for name, e in zip(self.outputs, h, strict=True)},
            definitions=(*((d.symbol, d.expression.xreplace(swap)) for d in self.definitions), *more),
            after=after,
        )

    def after_events(self) -> tuple[tuple[Expr, ...], list[tuple[Symbol, Expr]]]:
        """Return the states after the events at the end of a step, in prefixed symbols, none without events; and the
        definitions that they use."""
        more: dict[Symbol, Expr] = {}

        def let(name: str, value: Expr) -> Expr:
            if value.is_Number or value.is_Symbol:
                return value
            symbol = sympy.Symbol(f"after.{name}", real=True)
            more[symbol] = value
            return symbol

        if not self.events:
            return (), []
        definitions = [(d.symbol, d.expression) for d in self.definitions]
        end = {s: self.prefixed[s] for s in self.x}
        begin = {s: sympy.Symbol(f"{BEGIN}{e.name}", real=True) for s, e in end.items()}
        f, _ = self.with_faults()

        slopes = self.jacobian(f)

        def rate(x: list[Expr]) -> list[tuple[Expr, Expr]]:
            inside = {**self.prefixed, **dict(zip(self.x, x, strict=True))}
            for symbol, expression in definitions:
                inside[symbol] = let(f"rate.{symbol.name}", expression.xreplace(inside))
            return [(f[i].xreplace(inside), slopes[i, i].xreplace(inside)) for i in range(self.n)]

        moved = events_of_step(self.events, definitions, (begin, end), self.prefixed, let, rate)
        return tuple(moved), list(more.items())

    @property
    def theta(self) -> tuple[Symbol, ...]:
        """Return the symbols ``theta.channel`` of all channels."""
        return symbols("theta", [c.name for c in self.channels])

    @cached_property
    def prefixed(self) -> dict[Symbol, Symbol]:
        """Return the symbol with its prefix (``x.``, ``u.``, ``signal.``, ``p.``) for every declared symbol."""
        groups = (("x", self.x), ("u", self.u), ("signal", self.signals), ("p", self.parameters))
        return {s: sympy.Symbol(f"{prefix}.{s.name}", real=True) for prefix, group in groups for s in group}

    def with_faults(self) -> tuple[Matrix, Matrix]:
        """Return f + Φθ (n × 1) and h + Ψθ (m × 1) with all channels."""
        channels = [c.name for c in self.channels]
        if not channels:
            return self.f, self.h
        theta = sympy.Matrix(self.theta)
        return self.f + self.Phi(channels) * theta, self.h + self.Psi(channels) * theta
