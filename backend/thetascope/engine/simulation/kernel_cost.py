"""What an observer costs to compute: the processor time of its kernel's calls, measured in the run itself.

Where plant and first observer are one kernel there is one time for both, which is divided by their operations, counted
on their graphs. That flatters it: over the library's experiments its part is 0.6 to 1.0 of the time that it takes in a
kernel of its own, 0.88 in the middle, as a processor works on both at once. So where there are others to compare it
with, it is measured once more in a kernel of its own, as they are (`alone` in run.py).
"""

from collections.abc import Iterable, Mapping
from functools import lru_cache

from thetascope.engine.compiler.graph import LEAVES, topological
from thetascope.engine.compiler.system import Program

PLANT = ""  # no observer's label is empty
Spent = dict[str, tuple[float, float]]  # by observer's label: seconds of the processor, seconds simulated

_SLOW = {"div": 4, "sqrt": 4}  # of what an addition takes, about
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
    """Operations of one evaluation of the update law, in additions: a quotient counts 4, a call of the C library 20."""
    nodes = (program.graph.nodes[i][0] for i in topological(program.graph, program.update))
    return sum(1 if op in _ONE_INSTRUCTION else _SLOW.get(op, _LIBRARY) for op in nodes if op not in LEAVES)


def divided(seconds: float, parts: Mapping[str, Program]) -> dict[str, float]:
    """The time of one kernel, divided among the programs it is made of by their operations."""
    weights = (
        {name: operations(program) for name, program in parts.items()} if len(parts) > 1 else dict.fromkeys(parts, 1)
    )
    total = sum(weights.values()) or 1
    return {name: seconds * weight / total for name, weight in weights.items()}


def costs(spans: Iterable[Spent]) -> dict[str, float]:
    """Processor seconds per simulated second over all spans, of each observer by label."""
    total: dict[str, tuple[float, float]] = {}
    for spent in spans:
        for name, (seconds, simulated) in spent.items():
            before = total.get(name, (0.0, 0.0))
            total[name] = before[0] + seconds, before[1] + simulated
    return {name: seconds / simulated for name, (seconds, simulated) in total.items() if simulated > 0}
