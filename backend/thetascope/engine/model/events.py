"""Events of a continuous plant: where a condition becomes true, states take new values.

A state with the rate 0 that only events change is a memory, such as the position of a relay with hysteresis; an event
that changes other states is a reset, such as the bounce of a ball.

Conditions are examined at the end of every step. An event whose condition was false at the beginning is located within
the step: the margin of its condition (b − a of a < b, the least of margins joined by `and`, the largest of those joined
by `or`) and the states count as linear over the step, the earliest event of the step acts there, and one Euler step,
implicit in each state's own decay, covers the rest. The error of the states is of second order in the step. All other
events whose conditions hold act at the end of the step, in their order; the values of one event are computed together,
and later events see them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from thetascope.engine.compiler.system import WIDTH
from thetascope.engine.language.lazy_sympy import functions, sympy

if TYPE_CHECKING:
    from sympy import Expr, ImmutableMatrix, Matrix, Symbol


@dataclass(frozen=True)
class Event:
    """An event: its condition, 1 or 0, and the new value of each state that it changes."""

    condition: Expr
    values: dict[Symbol, Expr]

    @property
    def used(self) -> set[Symbol]:
        """Return the symbols on which it depends."""
        return {s for e in (self.condition, *self.values.values()) for s in e.free_symbols}


@dataclass(frozen=True)
class Sensitivity:
    """The derivatives S (n × q) of the states by any quantities, to be carried through events.

    ``jacobian(vector)`` returns ∂vector/∂x in the model's symbols, definitions among them.
    """

    S: list[list[Expr]]
    jacobian: Callable[[Matrix], ImmutableMatrix]


def modes(plant: Mapping) -> tuple[bool, ...]:
    """Return for each state of a plant's data whether only events change it: observers do not correct it, because it
    follows from the other states."""
    changed = {name for event in plant.get("events", ()) for name in event["set"]}
    return tuple(s["name"] in changed and plant["dynamics"][s["name"]].strip() == "0" for s in plant["states"])


class _Chain:
    """Writes conditions and values of events at states, with the definitions that they use.

    Args:
        events: the events in order.
        definitions: the plant's definitions.
        known: inputs, signals, parameters and t by the model's symbol.
        let: names an intermediate result and returns its symbol.
    """

    def __init__(
        self,
        events: Sequence[Event],
        definitions: Sequence[tuple[Symbol, Expr]],
        known: Mapping[Symbol, Expr],
        let: Callable[[str, Expr], Expr],
    ):
        self.events, self.definitions, self.known, self.let = events, definitions, known, let

    def inside(self, mark: str, event: Event, present: Mapping[Symbol, Expr]) -> dict[Symbol, Expr]:
        """Return the values of all symbols of an event at the present states."""
        inside, wanted = {**self.known, **present}, event.used
        for symbol, expression in reversed(self.definitions):
            wanted |= expression.free_symbols if symbol in wanted else set()
        for symbol, expression in self.definitions:
            if symbol in wanted:
                inside[symbol] = self.let(f"{mark}.{symbol.name}", expression.xreplace(inside))
        return inside

    def margins(self, mark: str, states: Mapping[Symbol, Expr]) -> list[Expr]:
        """Return the margins of all conditions at the same states."""
        return [
            self.let(f"{mark}{k}", margin(event.condition.xreplace(self.inside(f"{mark}{k}", event, states))))
            for k, event in enumerate(self.events)
        ]

    def through(
        self, mark: str, states: Mapping[Symbol, Expr], fires: Callable[[int, Expr], Expr], slopes: Sensitivity | None
    ) -> tuple[dict[Symbol, Expr], list[list[Expr]]]:
        """Return states and S after the events; ``fires(k, condition)`` is whether event k acts."""
        present, place = dict(states), {s: i for i, s in enumerate(states)}
        S = [] if slopes is None else list(slopes.S)
        for k, event in enumerate(self.events):
            inside = self.inside(f"{mark}{k}", event, present)
            acts = self.let(f"{mark}{k}.acts", fires(k, event.condition.xreplace(inside)))
            if slopes is not None:
                J = slopes.jacobian(sympy.Matrix(list(event.values.values()))).xreplace(inside)
                before, S = S, list(S)
                for i, s in enumerate(event.values):
                    columns = zip(*before, strict=True)
                    moved = [sympy.Add(*(J[i, j] * v for j, v in enumerate(column))) for column in columns]
                    pairs = enumerate(zip(moved, before[place[s]], strict=True))
                    S[place[s]] = [
                        self.let(f"{mark}{k}.S.{s.name}.{q}", functions.Where(acts, new, old))
                        for q, (new, old) in pairs
                    ]
            fresh = {s: functions.Where(acts, v.xreplace(inside), present[s]) for s, v in event.values.items()}
            present |= {s: self.let(f"{mark}{k}.{s.name}", value) for s, value in fresh.items()}
        return present, S


def margin(condition: Expr) -> Expr:
    """Return a number that is positive where a condition holds and negative where it does not."""
    if condition.is_Number:
        return sympy.S.One if condition else sympy.S.NegativeOne
    a, b = condition.args
    name = condition.func.__name__
    if name in ("Less", "LessEqual"):
        return b - a
    return (functions.Min if name == "And_" else functions.Max)(margin(a), margin(b))


def events_at_end(
    events: Sequence[Event],
    definitions: Sequence[tuple[Symbol, Expr]],
    states: Mapping[Symbol, Expr],
    known: Mapping[Symbol, Expr],
    let: Callable[[str, Expr], Expr],
    sensitivity: Sensitivity | None = None,
) -> tuple[list[Expr], list[list[Expr]]]:
    """Return the states after all events whose conditions hold, and S after them (empty without one).

    Args:
        events, definitions, known, let: as in `_Chain`.
        states: the states before the events, by the model's symbol.
        sensitivity: S before the events. Times of events count as fixed.
    """
    present, S = _Chain(events, definitions, known, let).through("event", states, lambda k, c: c, sensitivity)
    return list(present.values()), S


def events_of_step(
    events: Sequence[Event],
    definitions: Sequence[tuple[Symbol, Expr]],
    ends: tuple[Mapping[Symbol, Expr], Mapping[Symbol, Expr]],
    known: Mapping[Symbol, Expr],
    let: Callable[[str, Expr], Expr],
    rate: Callable[[list[Expr]], Sequence[tuple[Expr, Expr]]],
) -> list[Expr]:
    """Return the states at the end of a step with its events.

    Args:
        events, definitions, known, let: as in `_Chain`.
        ends: the states at the beginning and, without events, at the end of the step.
        rate: the right-hand side f at given states, and ∂f_i/∂x_i.
    """
    chain, (begin, end) = _Chain(events, definitions, known, let), ends
    before, after = chain.margins("begin", begin), chain.margins("end", end)
    never, zero = sympy.Integer(2), sympy.S.Zero
    places = []
    for k, (a, b) in enumerate(zip(before, after, strict=True)):
        crosses = functions.And_(functions.LessEqual(a, zero), functions.Less(zero, b))
        places.append(let(f"place{k}", functions.Where(crosses, a / functions.Divisor(a - b), never)))
    first = places[0]
    for k, place in enumerate(places[1:], start=1):
        first = let(f"first{k}", functions.Min(first, place))
    share = let("share", functions.Min(first, sympy.S.One))
    located = [
        let(f"located{k}", functions.And_(functions.LessEqual(place, first), functions.Less(place, never)))
        for k, place in enumerate(places)
    ]
    inner = {s: let(f"inner.{s.name}", begin[s] + share * (end[s] - begin[s])) for s in end}
    moved, _ = chain.through("at", inner, lambda k, condition: located[k], None)
    rest = let("rest", (1 - share) * sympy.Symbol(WIDTH, real=True))
    rates = rate(list(moved.values()))
    happens = let("happens", functions.Less(first, never))
    arrived = {}
    for s, (f, slope) in zip(end, rates, strict=True):
        decay = let(f"decay.{s.name}", rest * functions.Max(-slope, zero))
        # of second order for slow states (the trapezoidal rule), stable for fast ones (the implicit Euler rule)
        damping = let(f"damping.{s.name}", 1 + functions.Max(decay / 2, decay - sympy.S.Half))
        arrived[s] = let(f"arrived.{s.name}", functions.Where(happens, moved[s] + rest * f / damping, end[s]))

    def others(k: int, condition: Expr) -> Expr:
        return functions.And_(condition, functions.Less(located[k], sympy.S.Half))

    return list(chain.through("last", arrived, others, None)[0].values())
