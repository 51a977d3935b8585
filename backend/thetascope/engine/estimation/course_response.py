"""The response of the innovations to a course of one channel's θ, where the matrices of the filter are known.

The matrices of the filter of kalman_innovations.py along its rows do not depend on the course whose response is asked
for, so one run of the filter gives them for any number of courses, and each response is the recursion of V alone:

    Ω = C V + D w,    V⁺ = F (V − K Ω) + G w,    w: the course.
"""

from functools import lru_cache

from thetascope.engine.compiler.graph import Graph
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.estimation.covariance_equations import reader, total
from thetascope.engine.programs.program_store import derived


@lru_cache(maxsize=128)
def course_response(filter_: Program, n: int, m: int) -> Program:
    """Return the recursion for a filter with n states and m outputs, one step per row.

    Inputs: the filter's outputs ``F.i.j``, ``C.k.i``, ``K.k.i`` and ``weight.k`` that are not constant, ``G.i`` and
    ``D.k`` of the channel, and the course ``w``. States: V of the channel. Outputs: ``omega.k``, Ω/σ of each output.
    """
    return derived(["course_response", filter_.digest], lambda: _write(filter_, n, m))


def _write(filter_: Program, n: int, m: int) -> Program:
    g, given = Graph(), []
    part = reader(g, filter_, given)

    w, V = g.var("w"), [g.var(f"V.{i}") for i in range(n)]
    outputs = {}
    for k in range(m):
        c, K = [part(f"C.{k}.{i}") for i in range(n)], [part(f"K.{k}.{i}") for i in range(n)]
        omega = g.add(total(g, list(zip(c, V, strict=True))), g.mul(g.var(f"D.{k}"), w))
        outputs[f"omega.{k}"] = g.mul(omega, part(f"weight.{k}"))
        V = [g.sub(v, g.mul(gain, omega)) for v, gain in zip(V, K, strict=True)]
    F = [[part(f"F.{i}.{j}") for j in range(n)] for i in range(n)]
    moved = [g.mul(g.var(f"G.{i}"), w) for i in range(n)]
    V = [g.add(total(g, list(zip(row, V, strict=True))), b) for row, b in zip(F, moved, strict=True)]
    return Program(
        name=f"course response of {filter_.name}",
        time=DISCRETE,
        states=tuple(f"V.{i}" for i in range(n)),
        inputs=(*given, *(f"G.{i}" for i in range(n)), *(f"D.{k}" for k in range(m)), "w"),
        parameters=(),
        graph=g,
        update=tuple(V),
        outputs={name: outputs[name] for name in sorted(outputs)},
    )
