"""How a program is called again and again: its kernel and where its numbers come from, found once."""

from dataclasses import dataclass
from functools import lru_cache

from thetascope.engine.compiler.graph import variables
from thetascope.engine.compiler.jit import Kernel, Layout, kernel
from thetascope.engine.compiler.system import Program


@dataclass(frozen=True)
class Plan:
    """``held`` and ``staged`` name the signals in the order in which the kernel wants them, ``params`` the parameters."""

    program: Program
    kernel: Kernel
    held: tuple[str, ...]
    staged: tuple[str, ...]
    params: tuple[str, ...]


@lru_cache(maxsize=512)
def plan(
    program: Program, emitted: tuple[int, ...], signals: tuple[tuple[str, bool], ...], given: tuple[str, ...] = ()
) -> Plan:
    """The plan for a program that emits these nodes.

    ``signals``: names, and whether they are held. ``given``: inputs that are staged behind the staged signals.
    """
    used = variables(program.graph, [*program.update, *emitted]) - set(given)
    held = tuple(sorted(n for n, is_held in signals if n in used and is_held))
    staged = tuple(sorted(n for n, is_held in signals if n in used and not is_held))
    layout = Layout(held=held, staged=staged + given, emitted=emitted)
    return Plan(program, kernel(program, layout), held, staged, layout.shared_params(program))
