"""The closed loop: a plant with its measurement and its controllers as one System.

The plant's equations stay as they are; the inputs that controllers set become expressions or states of the System.

    clean.y = h + Ψθ      noisy.y = clean.y + noise.y      faulty.y = noisy.y after the sensor's faults
    y.y     = faulty.y, or where the sensor takes samples a state that takes faulty.y at its instants
    u.q     = the saturated law of a continuous controller, or a state that a sampled controller sets at its instants

Stuck readings, lost samples and delays enter through the inputs ``take.y`` and ``given.y`` (where ``take.y`` is 1 the
reading is ``given.y``), quantisation through ``resolution.y.i`` (0: none). At an instant, the input ``due.y.<output>``
or ``due.<controller>`` is 1 and the states *jump*: first y is sampled, then the controllers act in their order. The
outputs ``jump.<state>`` are the states after that. Between instants, these states have no derivative. Before its first
sample, a reading is the output at the beginning.

All quantities of one instant are ordered by what they depend on. If that is not possible, an input depends on itself
through a measured output without any state in between, an *algebraic loop*, which is refused.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from thetascope.engine.compiler.system import CONTINUOUS, System
from thetascope.engine.errors import SpecError
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.language.parser import parse
from thetascope.engine.model.loop_names import JUMP, SAMPLE
from thetascope.engine.model.plant_model import Model, clock
from thetascope.engine.model.true_plant import model_of
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr, Symbol


@dataclass
class _Equations:
    """Quantities of one instant, by symbol, and the name that a user knows each by."""

    values: dict[Symbol, Expr] = field(default_factory=dict)
    names: dict[Symbol, str] = field(default_factory=dict)

    def set(self, symbol: Symbol, value: Expr, name: str = "") -> None:
        self.values[symbol] = value
        self.names[symbol] = name

    def ordered(self, field_of: Mapping[Symbol, str]) -> list[tuple[Symbol, Expr]]:
        """Return the quantities so that each depends on earlier ones only. Raises SpecError for an algebraic loop."""
        done: dict[Symbol, Expr] = {}
        for symbol in self.values:
            self._visit(symbol, done, [], field_of)
        return list(done.items())

    def _visit(self, symbol: Symbol, done: dict, path: list[Symbol], field_of: Mapping[Symbol, str]) -> None:
        if symbol in done:
            return
        if symbol in path:
            raise self._algebraic([*path[path.index(symbol) :], symbol], field_of)
        parts = sorted(self.values[symbol].free_symbols & self.values.keys(), key=lambda s: s.name)
        for part in parts:
            self._visit(part, done, [*path, symbol], field_of)
        done[symbol] = self.values[symbol]

    def _algebraic(self, circle: list[Symbol], field_of: Mapping[Symbol, str]) -> SpecError:
        places = [s for s in circle if s in field_of]
        start = circle.index(places[0]) if places else 0
        around = circle[start:-1] + circle[: start + 1]
        names = [self.names[s] for s in reversed(around) if self.names[s]]
        names = [n for i, n in enumerate(names) if not i or n != names[i - 1]]
        place = field_of[places[0]] if places else "controllers"
        return SpecError(place, names[0], Message("controller.algebraic-loop", path=" → ".join(names)))


def closed_loop(data: Mapping, sampled: Sequence[str], quantisers: int) -> System:
    """Return the closed loop of a plant with controllers.

    Args:
        data: the plant, or the true plant, as plain data.
        sampled: names of the outputs whose sensors take samples.
        quantisers: most faults of quantisation on one output.

    Raises SpecError for a controller that reads a true state, and for an algebraic loop.
    """
    return _Writer(model_of(data), sampled, quantisers).system()


class _Writer:
    def __init__(self, model: Model, sampled: Sequence[str], quantisers: int):
        self.model, self.sampled, self.quantisers = model, tuple(sampled), quantisers
        self.controllers = model.data["controllers"]
        self.y = {n: _symbol("y", n) for n in model.outputs}
        self.u = {n: _symbol("u", n) for n in model.inputs}
        self.references = [_symbol("r", r["name"]) for r in model.data["references"]]
        self.c = {s["name"]: _symbol("c", s["name"]) for c in self.controllers for s in c["states"]}
        self.flow = _Equations()
        self.fields: dict[Symbol, str] = {}  # of the laws, for messages
        self.common = (
            {p.name: model.prefixed[p] for p in (*model.parameters, *model.signals)}
            | {r.name.partition(".")[2]: r for r in self.references}
            | {"t": clock()}
        )

    def is_sampled(self, controller: Mapping) -> bool:
        """Return whether a controller acts at instants."""
        return controller["period"] is not None

    # ---- expressions -------------------------------------------------------------------------------------------------

    def _scope(self, controller: Mapping, known: Mapping[str, Symbol]) -> dict[str, Symbol]:
        """Return the symbols that an expression of a controller may use; ``known``: its definitions so far."""
        return {**self.common, **self.y, **self.u, **self.c, **known}

    def _text(self, text: str, field_: str, scope: Mapping[str, Symbol]) -> Expr:
        hidden = [n for n in (*self.model.states, *(d.symbol.name for d in self.model.definitions)) if n not in scope]
        parsed = parse(text, [*scope, *hidden], field_, tables=self.model.tables)
        for name in parsed.names:
            if name in hidden:
                outputs = list(self.model.outputs)
                raise SpecError(field_, name, Message("controller.reads-state", name=name, outputs=outputs))
        return parsed.sympy(scope, self.model.tables)

    def _laws(self, i: int) -> Iterator[tuple[str, Symbol, Expr]]:
        """Yield (kind, symbol, expression) of the definitions, outputs and dynamics of a controller, in this order."""
        controller, known = self.controllers[i], {}
        for j, d in enumerate(controller["definitions"]):
            expression = self._text(
                d["expression"], f"controllers.{i}.definitions.{j}.expression", self._scope(controller, known)
            )
            known[d["name"]] = sympy.Symbol(d["name"], real=True)
            yield "definition", known[d["name"]], expression
        scope = self._scope(controller, known)
        for j, o in enumerate(controller["outputs"]):
            place, symbol = f"controllers.{i}.outputs.{j}.expression", self.u[o["input"]]
            self.fields.setdefault(symbol, place)
            yield "output", symbol, self._saturated(self._text(o["expression"], place, scope), o["saturation"])
        for s in controller["states"]:
            name = s["name"]
            yield (
                "state",
                self.c[name],
                self._text(controller["dynamics"][name], f"controllers.{i}.dynamics.{name}", scope),
            )

    def _saturated(self, value: Expr, limits: tuple[float | str | None, float | str | None]) -> Expr:
        from thetascope.engine.language.sympy_functions import Max, Min

        low, high = (self.common[b] if isinstance(b, str) else b if b is None else sympy.Float(b) for b in limits)
        value = value if low is None else Max(value, low)
        return value if high is None else Min(value, high)

    # ---- the measurement ---------------------------------------------------------------------------------------------

    def _measure(self) -> None:
        """Set the quantities between the plant's outputs and the readings."""
        from thetascope.engine.language.sympy_functions import Less, Where, floor

        _, h = self.model.with_faults()
        for name, value in zip(self.model.outputs, h, strict=True):
            clean, noisy, faulty = (_symbol(k, name) for k in ("clean", "noisy", "faulty"))
            self.flow.set(clean, value.xreplace(self.model.prefixed), name)
            self.flow.set(noisy, clean + _symbol("noise", name))
            reading = Where(_symbol("take", name), _symbol("given", name), noisy)
            for q in range(self.quantisers):
                step = _symbol("resolution", f"{name}.{q}")
                rounded = floor(reading / step + sympy.Rational(1, 2)) * step
                reading = Where(Less(sympy.Integer(0), step), rounded, reading)
            self.flow.set(faulty, reading)
            if name not in self.sampled:
                self.flow.set(self.y[name], faulty, name)

    # ---- instants ----------------------------------------------------------------------------------------------------

    def _jumps(self, states: list[Symbol]) -> tuple[list[tuple[Symbol, Expr]], dict[str, Expr]]:
        """Return the quantities after the readings of an instant, and the states after it, by ``jump.<state>``."""
        from thetascope.engine.language.sympy_functions import LessEqual, Where

        after: list[tuple[Symbol, Expr]] = []
        present: dict[Symbol, Symbol] = {}  # the latest value of each quantity that has changed

        def change(symbol: Symbol, due: str, value: Expr, otherwise: Symbol | None = None) -> Symbol:
            fresh = sympy.Symbol(f"after.{symbol.name}", real=True)
            after.append((fresh, Where(sympy.Symbol(due, real=True), value, otherwise or symbol)))
            return fresh

        for name in self.sampled:
            y, fresh = self.y[name], _symbol("faulty", name)
            before = sympy.Symbol(f"before.{y.name}", real=True)
            after.append((before, Where(LessEqual(y, y), y, fresh)))  # NaN: there was no sample yet
            present[y] = change(y, f"{SAMPLE}{name}", fresh, before)
        for i, controller in enumerate(self.controllers):
            if not self.is_sampled(controller):
                continue
            due, given, moved, defined = f"due.{controller['name']}", {}, {}, {}
            for kind, symbol, value in self._laws(i):
                # an input's law reads its value before, the dynamics its new one; all states move together
                value = value.xreplace({**present, **defined, **(given if kind == "state" else {})})
                if kind == "definition":
                    defined[symbol] = sympy.Symbol(f"after.{symbol.name}", real=True)
                    after.append((defined[symbol], value))
                else:
                    (given if kind == "output" else moved)[symbol] = change(symbol, due, value)
            present |= given | moved
        return after, {f"{JUMP}{s.name}": present.get(s, s) for s in states}

    # ---- the whole ---------------------------------------------------------------------------------------------------

    def system(self) -> System:
        model, swap = self.model, self.model.prefixed
        for d in model.definitions:
            self.flow.set(d.symbol, d.expression.xreplace(swap))
        self._measure()
        update: dict[Symbol, Expr] = {}
        held: list[Symbol] = [self.y[name] for name in self.sampled]
        for i, controller in enumerate(self.controllers):
            for kind, symbol, value in self._laws(i):
                if self.is_sampled(controller):
                    held += [symbol] if kind == "output" else []
                elif kind == "state":
                    update[symbol] = value
                else:
                    self.flow.set(symbol, value, symbol.name.partition(".")[2] if kind == "output" else "")
        still = sympy.Integer(0)
        f, _ = model.with_faults()
        plant = {swap[s]: e.xreplace(swap) for s, e in zip(model.x, f, strict=True)}
        own = {s: update.get(s, still if model.time == CONTINUOUS else s) for s in self.c.values()}
        kept = {s: still if model.time == CONTINUOUS else s for s in held}
        states = {**plant, **own, **kept}
        flow = self.flow.ordered(self.fields)
        after, jumps = self._jumps(list(states))
        events, more = model.after_events()
        moved = dict(zip([swap[s] for s in model.x], events, strict=False))
        controlled = {o["input"] for c in self.controllers for o in c["outputs"]}
        measured = {f"{k}.{n}": _symbol(k, n) for k in ("noisy", "y") for n in model.outputs}
        applied = {f"u.{n}": self.u[n] for n in model.inputs if n in controlled}
        return System(
            name=f"closed loop of {model.id}",
            time=model.time,
            states=tuple(states),
            inputs=(
                *(self.u[n] for n in model.inputs if n not in controlled),
                *(swap[s] for s in model.signals),
                *model.theta,
                *model.disturbances,
                *self.references,
                *(_symbol(k, n) for k in ("noise", "take", "given") for n in model.outputs),
                *(_symbol("resolution", f"{n}.{q}") for n in model.outputs for q in range(self.quantisers)),
                *(sympy.Symbol(d, real=True) for d in dues(model.data, self.sampled)),
            ),
            parameters=tuple(swap[s] for s in model.parameters),
            update=tuple(states.values()),
            outputs={**measured, **applied, **jumps},
            definitions=(*flow, *after, *more),
            after=tuple(moved.get(s, s) for s in states) if events else (),
        )


def dues(data: Mapping, sampled: Sequence[str]) -> tuple[str, ...]:
    """Return the names of the inputs that are 1 at the instants of sensors and of sampled controllers."""
    controllers = tuple(f"due.{c['name']}" for c in data["controllers"] if c["period"] is not None)
    return (*(f"{SAMPLE}{name}" for name in sampled), *controllers)


def _symbol(prefix: str, name: str) -> Symbol:
    return sympy.Symbol(f"{prefix}.{name}", real=True)
