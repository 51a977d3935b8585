"""Partition of a program into a part that all runs of a batch share and a part that differs between runs.

States that do not depend on noise, differing parameters or differing initial values (Υ and Γ, often the plant) are
integrated once. Their values at every Runge–Kutta stage are inputs of the rest, which is integrated in SIMD lanes over
runs.
"""

from dataclasses import dataclass, replace

from thetascope.engine.compiler.graph import LEAVES, Graph, topological
from thetascope.engine.compiler.system import Program


@dataclass(frozen=True)
class Partition:
    """The two parts: ``shared`` emits the nodes ``handed``, which are the staged inputs ``handed.<i>`` of ``lanes``."""

    shared: Program | None
    lanes: Program
    handed: tuple[int, ...]  # nodes of the shared program's graph
    names: tuple[str, ...]


def partition(program: Program, differing: frozenset[str], staged: frozenset[str]) -> Partition:
    """Split a program by the names that differ between runs.

    Args:
        program: the program.
        differing: inputs, parameters and states (by their initial values) that differ between runs.
        staged: inputs that change within a step.
    """
    graph = program.graph
    reached = _reached(program, set(differing))
    lane_states = [i for i, s in enumerate(program.states) if s in reached]
    shared_states = [i for i, s in enumerate(program.states) if s not in reached]
    roots = [program.update[i] for i in lane_states]
    differs = _depends(graph, program.update, reached)
    moving = _depends(graph, program.update, {program.states[i] for i in shared_states} | set(staged) | {"t"})
    handed = _frontier(graph, roots, differs, moving)
    lanes_graph, moved = _copy(graph, roots, {node: f"handed.{k}" for k, node in enumerate(handed)})
    names = tuple(f"handed.{k}" for k in range(len(handed)))
    lanes = replace(
        program,
        states=tuple(program.states[i] for i in lane_states),
        graph=lanes_graph,
        update=tuple(moved[r] for r in roots),
        inputs=program.inputs + names,
        outputs={},
    )
    if not shared_states and not handed:
        return Partition(None, lanes, (), ())
    shared_roots = [program.update[i] for i in shared_states]
    shared_graph, moved = _copy(graph, [*shared_roots, *handed], {})
    shared = replace(
        program,
        states=tuple(program.states[i] for i in shared_states),
        graph=shared_graph,
        update=tuple(moved[r] for r in shared_roots),
        outputs={},
    )
    return Partition(shared, lanes, tuple(moved[h] for h in handed), names)


def _depends(graph: Graph, roots: tuple[int, ...] | list[int], names: set[str]) -> set[int]:
    """Return the nodes below the roots that depend on any of the names."""
    dependent: set[int] = set()
    for i in topological(graph, roots):
        op, *args = graph.nodes[i]
        if (op == "var" and args[0] in names) or (op not in LEAVES and any(a in dependent for a in args)):
            dependent.add(i)
    return dependent


def _reached(program: Program, reached: set[str]) -> set[str]:
    """Return the names and all states that depend on them."""
    while True:
        differs = _depends(program.graph, program.update, reached)
        more = {s for s, u in zip(program.states, program.update, strict=True) if u in differs} - reached
        if not more:
            return reached
        reached |= more


def _frontier(graph: Graph, roots: list[int], differs: set[int], moving: set[int]) -> list[int]:
    """Return the shared nodes that differing ones use directly and that change within a step; others are recomputed."""
    frontier: dict[int, None] = {}
    for i in topological(graph, roots):
        if i in differs and graph.nodes[i][0] not in LEAVES:
            frontier.update(dict.fromkeys(a for a in graph.nodes[i][1:] if a in moving and a not in differs))
    frontier.update(dict.fromkeys(r for r in roots if r in moving and r not in differs))
    return list(frontier)


def _copy(graph: Graph, roots: list[int], cut: dict[int, str]) -> tuple[Graph, dict[int, int]]:
    """Copy the nodes that the roots need, with those in ``cut`` replaced by variables; nothing is simplified.

    Returns:
        the new graph, and the new index of each node.
    """
    result, moved = Graph(), {}
    needed = _needed(graph, roots, cut)
    for i in sorted(needed):
        op, *args = graph.nodes[i]
        if i in cut:
            moved[i] = result.var(cut[i])
        elif op in LEAVES:
            moved[i] = result.raw(op, *args)
        else:
            moved[i] = result.raw(op, *(moved[a] for a in args))
    return result, moved


def _needed(graph: Graph, roots: list[int], cut: dict[int, str]) -> set[int]:
    """Return the nodes that the roots need, down to those in ``cut``."""
    visited: set[int] = set()
    stack = list(roots)
    while stack:
        i = stack.pop()
        if i in visited:
            continue
        visited.add(i)
        if i not in cut and graph.nodes[i][0] not in LEAVES:
            stack.extend(graph.nodes[i][1:])
    return visited
