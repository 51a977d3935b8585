"""System: states, inputs, parameters, update law and outputs, written in SymPy; and its lowered form, Program.

Plants and observers are Systems. Lowering turns a System into an expression graph (see graph.py), from which kernels
are compiled, which NumPy evaluates, and which is cached. A Program does not need SymPy.
"""

import hashlib
import json
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from thetascope.engine.compiler import graph as graphs
from thetascope.engine.compiler.graph import Graph

if TYPE_CHECKING:
    import sympy

CONTINUOUS, DISCRETE = "continuous", "discrete"
WIDTH, BEGIN = "step.width", "begin."
"""The name of the width of a step, and the prefix of the states at its beginning, in the equations of its end."""


@dataclass(frozen=True)
class System:
    """The equations of a plant or an observer.

    ``update`` holds one expression per state: its derivative (continuous time) or its next value (discrete time).
    ``definitions`` are intermediate quantities in order; later ones, the update and the outputs may use them.
    ``after`` holds one expression per state, its value at the end of a step with the plant's events, or nothing; it
    may also use the states at the beginning of the step, ``begin.<state>``, and its width ``step.width``.
    Symbols are matched by name. ``t`` is time in seconds and is always available.
    """

    name: str
    time: str
    states: tuple["sympy.Symbol", ...]
    inputs: tuple["sympy.Symbol", ...]
    parameters: tuple["sympy.Symbol", ...]
    update: tuple["sympy.Expr", ...]
    outputs: dict[str, "sympy.Expr"] = field(default_factory=dict)
    definitions: tuple[tuple["sympy.Symbol", "sympy.Expr"], ...] = ()
    after: tuple["sympy.Expr", ...] = ()

    def lower(self) -> "Program":
        """Return the Program. Raises ValueError for a symbol that is not a state, input, parameter, definition or t."""
        from thetascope.engine.compiler.lowering import Lowering

        known = {s.name for s in (*self.states, *self.inputs, *self.parameters)} | {"t"}
        if self.after:
            known |= {WIDTH, *(f"{BEGIN}{s.name}" for s in self.states)}
        lowering = Lowering(Graph(), known, {s.name for s in self.parameters}, self._ranks())
        for symbol, expression in self.definitions:
            lowering.define(symbol, expression)
        roots = [lowering(e) for e in (*self.update, *self.outputs.values(), *self.after)]
        graph, roots = graphs.contract(lowering.graph, roots, lowering.rank)
        n = len(self.states)
        return Program(
            name=self.name,
            time=self.time,
            states=tuple(s.name for s in self.states),
            inputs=tuple(s.name for s in self.inputs),
            parameters=tuple(s.name for s in self.parameters),
            graph=graph,
            update=tuple(roots[:n]),
            outputs=dict(zip(self.outputs, roots[n:], strict=False)),
            after=tuple(roots[n + len(self.outputs) :]),
        )

    def _ranks(self) -> dict[str, int]:
        """Return the ranks of names in sums and products (see Lowering): inputs, t, states in order, measured outputs.

        Parameters have no entry, which is rank 0: they come first.
        """
        measured = [s.name for s in self.inputs if s.name.startswith("y.")]
        given = [s.name for s in self.inputs if s.name not in measured]
        order = [*given, "t", *(s.name for s in self.states), *measured]
        return {name: i for i, name in enumerate(order, start=1)}


@dataclass(frozen=True, eq=False)
class Program:
    """A lowered System. ``update``, ``outputs`` and ``after`` are node indices of ``graph``. Equal digests mean
    equality."""

    name: str
    time: str
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    parameters: tuple[str, ...]
    graph: Graph
    update: tuple[int, ...]
    outputs: dict[str, int]
    after: tuple[int, ...] = ()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Program) and self.digest == other.digest

    def __hash__(self) -> int:
        return hash(self.digest)

    @cached_property
    def digest(self) -> str:
        """Return the SHA-256 of everything that determines the results."""
        return hashlib.sha256(json.dumps(self.to_json(), separators=(",", ":")).encode()).hexdigest()

    @cached_property
    def used_inputs(self) -> frozenset[str]:
        """Return the inputs, t included, that the update law depends on; outputs do not count."""
        return frozenset(graphs.variables(self.graph, self.update)) & frozenset((*self.inputs, "t"))

    def to_json(self) -> dict:
        """Return the program as JSON values; constants are hexadecimal floats, which are exact."""
        return {
            "name": self.name,
            "time": self.time,
            "states": list(self.states),
            "inputs": list(self.inputs),
            "parameters": list(self.parameters),
            "nodes": graphs.nodes_to_json(self.graph.nodes),
            "update": list(self.update),
            "outputs": self.outputs,
        } | ({"after": list(self.after)} if self.after else {})

    @classmethod
    def from_json(cls, data: dict) -> "Program":
        """Return the program of `to_json`."""
        graph = Graph()
        for node in graphs.nodes_from_json(data["nodes"]):
            graph.raw(*node)
        return cls(
            name=data["name"],
            time=data["time"],
            states=tuple(data["states"]),
            inputs=tuple(data["inputs"]),
            parameters=tuple(data["parameters"]),
            graph=graph,
            update=tuple(data["update"]),
            outputs=dict(data["outputs"]),
            after=tuple(data.get("after", ())),
        )

    def evaluate(self, names: list[str] | tuple[str, ...], values: dict) -> list:
        """Return the values of outputs (by name) or updates (``"d." + state``), with NumPy; see graph.evaluate."""
        position = {s: i for i, s in enumerate(self.states)}
        roots = [self.update[position[n[2:]]] if n.startswith("d.") else self.outputs[n] for n in names]
        return graphs.evaluate(self.graph, roots, values)


def join(first: Program, second: Program, links: dict[str, tuple[str, str | None]]) -> Program:
    """Return one program that runs two together; ``links`` connects inputs of the second to outputs of the first.

    A link is ``{input: (output, noise)}``: the input becomes the output plus the input called ``noise`` (if given).
    The equations stay unchanged, so the joined program computes the same bits as the two separate ones.
    """
    graph = Graph()
    moved = graph.absorb(first.graph, (*first.update, *first.outputs.values(), *first.after))
    feed, noises = {}, []
    for name, (output, noise) in links.items():
        node = moved[first.outputs[output]]
        if noise is not None:
            node = graph.raw("add", node, graph.var(noise))
            noises.append(noise)
        feed[name] = node
    later = graph.absorb(second.graph, (*second.update, *second.outputs.values(), *second.after), feed)
    after: tuple[int, ...] = ()
    if first.after or second.after:
        sides = ((first, moved), (second, later))
        after = tuple(
            index[node] if p.after else graph.var(state)
            for p, index in sides
            for state, node in zip(p.states, p.after or p.update, strict=True)
        )
    inputs = dict.fromkeys((*first.inputs, *noises, *(i for i in second.inputs if i not in links)))
    return Program(
        name=f"{first.name}+{second.name}",
        time=first.time,
        states=first.states + second.states,
        inputs=tuple(inputs),
        parameters=tuple(dict.fromkeys(first.parameters + second.parameters)),
        graph=graph,
        update=tuple(moved[u] for u in first.update) + tuple(later[u] for u in second.update),
        # of equal names the first program's output is kept: y.* is the measurement, not an observer's estimate of it
        after=after,
        outputs={**{k: later[v] for k, v in second.outputs.items()}, **{k: moved[v] for k, v in first.outputs.items()}},
    )
