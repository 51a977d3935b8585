"""A bank of filters of kalman_innovations.py, each for one change of every channel's θ, with the sums that rate it.

A change has the course

    w(d) = min(start + rate · (d − onset), top) + bend · (1 − fade^rows since onset)  for d ≥ onset, 0 before,

where d is time in decision intervals. Courses are a step (start 1, rate 0), a ramp without end (rate 1, top ∞), a ramp
with an end (rate 1/duration, top 1), and an exponential approach (bend 1, fade exp(−row/τ)). The filter assumes
θ₀ = known θ + size · w, within bounds, and Ω is its response to w. Where a size is zero, the course is that of an error
of the known θ. Each course is described by a few numbers, so that many hypotheses run side by side in lanes and return
only their sums: J = Σ ΩᵀΩ and s = Σ Ωᵀν over the outputs in use, q = Σ ν² of each output from ``begin`` on, and
``early``, the diagonal of J before ``until``.
"""

from functools import lru_cache

from thetascope.engine.compiler.graph import Graph
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.programs.program_store import derived

COURSE = (
    "onset",
    "start",
    "rate",
    "top",
    "bend",
    "fade",
    "size",
)  # of each channel; followed by BOUNDS
BOUNDS = ("least", "most", "own")
SPAN = ("begin", "until")


def sums(p: int, m: int) -> list[str]:
    """Return the names of the states that follow those of the filter: the bend of each course, and the sums."""
    J = [f"sum.J.{i}.{j}" for i in range(p) for j in range(i, p)]
    return [
        *(f"bent.{j}" for j in range(p)),
        *J,
        *(f"sum.s.{j}" for j in range(p)),
        *(f"sum.early.{j}" for j in range(p)),
        *(f"sum.q.{k}" for k in range(m)),
    ]


@lru_cache(maxsize=128)
def hypothesis_program(filter_: Program, p: int, m: int) -> Program:
    """Return a filter for p channels and m outputs with its sums.

    Its inputs ``base.j`` (the known θ) and ``d`` replace ``known.j`` and ``profile.j``. Parameters: COURSE and BOUNDS
    of each channel, and SPAN.
    """
    return derived(["hypothesis_program", filter_.digest], lambda: _write(filter_, p, m))


def _write(filter_: Program, p: int, m: int) -> Program:
    g, here = Graph(), {}
    d, zero = g.var("d"), g.const(0.0)
    bent = []
    for j in range(p):
        onset, start, rate, top, bend, fade, size, least, most, own = (
            g.var(f"{name}.{j}") for name in (*COURSE, *BOUNDS)
        )
        going = g.call("min", g.add(start, g.mul(rate, g.sub(d, onset))), top)
        begun, risen = g.call("le", onset, d), g.var(f"bent.{j}")
        course = g.call("where", begun, g.add(going, g.mul(bend, risen)), zero)
        left = g.mul(g.sub(g.const(1.0), fade), g.sub(g.const(1.0), risen))
        bent.append(g.call("where", begun, g.add(risen, left), risen))
        known = g.add(g.var(f"base.{j}"), g.mul(size, course))
        here |= {f"profile.{j}": course, f"known.{j}": g.add(own, g.call("min", g.call("max", known, least), most))}
    columns = [f"omega.{k}.{j}" for k in range(m) for j in range(p)] + [f"nu.{k}" for k in range(m)]
    replaced = g.absorb(filter_.graph, [*filter_.update, *(filter_.outputs[name] for name in columns)], here)
    omega = [[replaced[filter_.outputs[f"omega.{k}.{j}"]] for j in range(p)] for k in range(m)]
    nu = [replaced[filter_.outputs[f"nu.{k}"]] for k in range(m)]
    trusted_omega = [[g.mul(g.var(f"trusted.{k}"), o) for o in row] for k, row in enumerate(omega)]

    def added(name: str, products: list[tuple[int, int]], when: int | None = None) -> int:
        total = g.var(name)
        for a, b in products:
            product = g.mul(a, b)
            total = g.add(total, product if when is None else g.call("where", when, product, zero))
        return total

    early, since = g.call("lt", d, g.var("until")), g.call("le", g.var("begin"), d)
    update = [*(replaced[i] for i in filter_.update), *bent]
    update += [
        added(f"sum.J.{i}.{j}", [(trusted_omega[k][i], omega[k][j]) for k in range(m)])
        for i in range(p)
        for j in range(i, p)
    ]
    update += [added(f"sum.s.{j}", [(trusted_omega[k][j], nu[k]) for k in range(m)]) for j in range(p)]
    update += [added(f"sum.early.{j}", [(trusted_omega[k][j], omega[k][j]) for k in range(m)], early) for j in range(p)]
    update += [added(f"sum.q.{k}", [(nu[k], nu[k])], since) for k in range(m)]
    inputs = tuple(i for i in filter_.inputs if not i.startswith(("known.", "profile.")))
    channels = [f"{name}.{j}" for j in range(p) for name in (*COURSE, *BOUNDS)]
    return Program(
        name=f"hypotheses of {filter_.name}",
        time=DISCRETE,
        states=(*filter_.states, *sums(p, m)),
        inputs=(*inputs, *(f"base.{j}" for j in range(p)), "d"),
        parameters=(*filter_.parameters, *channels, *SPAN),
        graph=g,
        update=tuple(update),
        outputs={},
    )
