"""The computational cost of an observer: the processor time of its kernel calls, measured during the run.

A kernel that joins the plant and the first observer has one time for both. It is divided between them by the number of
operations of their graphs. This underestimates the observer: over the library's experiments its share is 0.6 to 1.0
(median 0.88) of the time that it takes in a separate kernel, because a processor interleaves both. Where there are
other observers to compare it with, it is therefore measured again in a separate kernel (`alone` in run_experiment.py).
"""

from collections.abc import Iterable, Mapping
from functools import lru_cache

from thetascope.engine.compiler.graph import LEAVES, topological
from thetascope.engine.compiler.system import Program

PLANT = ""  # no observer's label is empty
Spent = dict[str, tuple[float, float]]  # observer's label → processor seconds, simulated seconds

_SLOW = {"div": 4, "sqrt": 4, "piece": 8}  # approximate cost in additions
_ONE_INSTRUCTION = {
    "add",
    "sub",
    "mul",
    "neg",
    "fma",
    "min",
    "max",
    "sign",
    "lt",
    "le",
    "and",
    "or",
    "where",
    "floor",
    "abs",
}
_LIBRARY = 20  # a call of the C library


@lru_cache(maxsize=256)
def operations(program: Program) -> int:
    """Return the cost of one evaluation of the update law in additions: a quotient counts 4, a C library call 20."""
    nodes = (program.graph.nodes[i][0] for i in topological(program.graph, program.update))
    return sum(1 if op in _ONE_INSTRUCTION else _SLOW.get(op, _LIBRARY) for op in nodes if op not in LEAVES)


def divided(seconds: float, parts: Mapping[str, Program]) -> dict[str, float]:
    """Divide the time of one kernel among its programs in proportion to their operations."""
    weights = (
        {name: operations(program) for name, program in parts.items()} if len(parts) > 1 else dict.fromkeys(parts, 1)
    )
    total = sum(weights.values()) or 1
    return {name: seconds * weight / total for name, weight in weights.items()}


def costs(spans: Iterable[Spent]) -> dict[str, float]:
    """Return the processor seconds per simulated second over all spans, by observer's label."""
    total: dict[str, tuple[float, float]] = {}
    for spent in spans:
        for name, (seconds, simulated) in spent.items():
            before = total.get(name, (0.0, 0.0))
            total[name] = before[0] + seconds, before[1] + simulated
    return {name: seconds / simulated for name, (seconds, simulated) in total.items() if simulated > 0}
