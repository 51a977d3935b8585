"""Call plans: the kernel of a program and the order of its inputs, determined once for many calls."""

from dataclasses import dataclass
from functools import lru_cache

from thetascope.engine.compiler.graph import variables
from thetascope.engine.compiler.jit import Kernel, Layout, kernel
from thetascope.engine.compiler.system import Program


@dataclass(frozen=True)
class Plan:
    """A kernel with the names of its ``held`` and ``staged`` signals and its ``params``, each in the kernel's order."""

    program: Program
    kernel: Kernel
    held: tuple[str, ...]
    staged: tuple[str, ...]
    params: tuple[str, ...]


@lru_cache(maxsize=512)
def plan(
    program: Program,
    emitted: tuple[int, ...],
    signals: tuple[tuple[str, bool], ...],
    given: tuple[str, ...] = (),
    jump: tuple[int, ...] = (),
    implicit: bool = False,
) -> Plan:
    """Return the plan of a program that emits these nodes.

    Args:
        program: the program.
        emitted: nodes whose values the kernel returns at every stage.
        signals: names, and whether each signal is held over a segment.
        given: inputs that follow the staged signals in each staged row.
        jump: nodes that the states jump to at the head of every segment.
        implicit: whether the kernel takes implicit steps.
    """
    used = variables(program.graph, [*program.update, *program.after, *emitted, *jump]) - set(given)
    held = tuple(sorted(n for n, is_held in signals if n in used and is_held))
    staged = tuple(sorted(n for n, is_held in signals if n in used and not is_held))
    layout = Layout(held=held, staged=staged + given, emitted=emitted, jump=jump, implicit=implicit)
    return Plan(program, kernel(program, layout), held, staged, layout.shared_params(program))
