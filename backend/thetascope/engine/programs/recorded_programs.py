"""Programs for a record: a plant at rest, observers that predict where readings are missing, and true intervals.

A record takes the place of the plant's outputs, so its plant has no motion and outputs of zero, to which the readings
are added as noise is added to those of a simulated plant (`engine/inputs/readings.py`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from thetascope.engine.compiler.graph import Graph, variables
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.programs.program_store import derived

PERIOD = "g.period"
_UNTRUSTED = 1e12  # times its noise: the noise of a reading that is missing


def at_rest(plant: Program) -> Program:
    """Return a plant's program with the same names whose states do not move and whose outputs are zero."""

    def write() -> Program:
        graph = Graph()
        zero = graph.const(0.0)
        update = tuple(graph.var(s) if plant.time == DISCRETE else zero for s in plant.states)
        return replace(plant, graph=graph, update=update, outputs=dict.fromkeys(plant.outputs, zero), after=())

    return derived(["at rest", plant.digest], write)


def predicting(observer: Program, outputs: Sequence[str], present: Mapping[str, str]) -> Program:
    """Return an observer's program that corrects only with readings that are there.

    Where a reading is missing the observer gets its own estimate ŷ in its place, so that the error is zero; a filter
    with the noise ``r`` of each output takes the reading for very noisy, so that its covariance grows. An output whose
    ŷ depends on the readings keeps the last one.

    Args:
        observer: the program.
        outputs: all outputs ``y.*`` in their order.
        present: output → name of the input that is 1 where its reading is there, else 0.
    """
    prefix = "now." if observer.time == DISCRETE else ""

    def write() -> Program:
        graph, feed, added = Graph(), {}, []
        for output, name in present.items():
            flag = f"{prefix}{name}"
            is_there = graph.call("lt", graph.const(0.0), graph.var(flag))
            noise = f"g.r.{list(outputs).index(output)}"
            added.append(flag)
            if noise in observer.parameters:
                r = graph.var(noise)
                feed[noise] = graph.call("where", is_there, r, graph.mul(r, graph.const(_UNTRUSTED)))
            estimate = observer.outputs.get(output)
            if observer.time == DISCRETE or estimate is None or _reads(observer, estimate):
                continue
            own = graph.absorb(observer.graph, [estimate])[estimate]
            feed[output] = graph.call("where", is_there, graph.var(output), own)
        roots = (*observer.update, *observer.outputs.values(), *observer.after)
        moved = graph.absorb(observer.graph, roots, feed)
        return replace(
            observer,
            inputs=(*observer.inputs, *added),
            graph=graph,
            update=tuple(moved[i] for i in observer.update),
            outputs={name: moved[i] for name, i in observer.outputs.items()},
            after=tuple(moved[i] for i in observer.after),
        )

    return derived(["predicting", observer.digest, list(outputs), dict(present)], write)


def over_intervals(observer: Program) -> Program:
    """Return the program of an observer that works at samples with the sample interval as an input."""

    def write() -> Program:
        rest = tuple(name for name in observer.parameters if name != PERIOD)
        return replace(observer, inputs=(*observer.inputs, PERIOD), parameters=rest)

    return derived(["over intervals", observer.digest], write)


def _reads(program: Program, node: int) -> bool:
    """Return whether a node depends on a measured output."""
    names = variables(program.graph, [node])
    return any(name.removeprefix("now.").startswith("y.") for name in names)
