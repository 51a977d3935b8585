"""The uncertainty of an observer's θ̂: its equations linearised, and the covariance that measurement noise causes.

Let e be the deviation of an observer's estimates (x̂, θ̂) from their values without noise and with the true θ. To first
order, from the derivatives of the observer's equations (engine/compiler/autodiff.py),

    e' = A e + B n,    A = ∂(x̂', θ̂')/∂(x̂, θ̂),    B = ∂(x̂', θ̂')/∂y,    n white of intensity R,
    S' = A S + S Aᵀ + B R Bᵀ,

for every kind of observer; no property of a paper's theorem is used. Between two rows A and B are those of the first,
and S is exact (discretisation.py): S⁺ = F S Fᵀ + Q. Observers with a sample period have F = A and Q = B R Bᵀ for each
sample. The initial S is the uncertainty of the first estimates.

Knowledge of a fault fades while no new information arrives. Let η be the noise that enters its estimate divided by the
estimate's variance: twice the learning rate where the two balance. Where η is far below its recent average h, the
variance grows by FADING·h instead, at most at the plant's slowest rate, so that the band widens when excitation is
lost.

Gains that are states themselves (Γ, P, Υ) are taken as given: noise in them multiplies a residual that is zero but for
noise, an effect of second order. States through which noise reaches θ̂ on its way, such as a filter of the output,
belong to the estimates; their names begin with ``via.`` (`Observer.carried`).
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.graph import Graph
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.programs.program_store import derived

FADING = 0.04  # growth rate of a variance without new information, relative to the previous learning rate
MOST = 1e9  # scales: the largest deviation that is kept


@dataclass(frozen=True)
class Shape:
    """Names in an observer's program: its estimates of the state and of θ, the outputs it receives, and the states
    through which noise reaches θ̂."""

    x: tuple[str, ...]
    theta: tuple[str, ...]
    outputs: tuple[str, ...]
    via: tuple[str, ...] = ()

    @property
    def estimates(self) -> tuple[str, ...]:
        """Return all states whose covariance is computed, θ̂ last."""
        return (*self.x, *self.via, *self.theta)


def shape_of(program: Program) -> Shape:
    """Return which states of an observer's program are x̂ and θ̂, and which inputs are y."""
    return Shape(
        tuple(s for s in program.states if s.startswith("xh.")),
        tuple(s for s in program.states if s.startswith("thetah.")),
        tuple(i for i in program.inputs if i.startswith("y.")),
        tuple(s for s in program.states if s.startswith("via.")),
    )


@lru_cache(maxsize=128)
def companion(program: Program) -> Program:
    """Return the program of A and B for an observer's program; its inputs are the observer's states and inputs.

    Outputs: ``slope.i.j`` (A) and ``noise.i.k`` (B).
    """
    return derived(["companion", program.digest], lambda: _write(program))


def _write(program: Program) -> Program:
    shape, graph = shape_of(program), Graph()
    estimates = shape.estimates
    place = {s: i for i, s in enumerate(program.states)}
    moved = graph.absorb(program.graph, program.update)
    given = [f"now.{o}" if program.time == DISCRETE else o for o in shape.outputs]
    rates = derivatives(graph, [moved[program.update[place[s]]] for s in estimates], (*estimates, *given))
    zero = graph.const(0.0)
    outputs = {f"slope.{i}.{j}": row.get(s, zero) for i, row in enumerate(rates) for j, s in enumerate(estimates)}
    outputs |= {f"noise.{i}.{k}": row.get(y, zero) for i, row in enumerate(rates) for k, y in enumerate(given)}
    return Program(
        name=f"companion of {program.name}",
        time=program.time,
        states=(),
        inputs=(*program.states, *program.inputs),
        parameters=program.parameters,
        graph=graph,
        update=(),
        outputs=outputs,
    )


@lru_cache(maxsize=64)
def recursion(n: int, p: int) -> Program:
    """Return the program of S for n estimates, the last p of which are θ̂; one step is an interval or a sample.

    The states are the upper triangle of S in units of the scales, and h of each θ̂. Inputs: ``F.i.j``, ``Q.i.j`` and
    ``W.j`` (the noise that enters θ̂_j, BRBᵀ). Parameters: ``interval``, ``memory`` (the plant's slowest rate),
    ``follow`` (the share by which h approaches η) and ``end`` (the weight of S after the step in η).
    """
    return derived(["recursion", n, p], lambda: _write_recursion(n, p))


def _write_recursion(n: int, p: int) -> Program:
    g = Graph()
    upper = [(i, j) for i in range(n) for j in range(i, n)]
    S = [[g.var(f"spread.{min(i, j)}.{max(i, j)}") for j in range(n)] for i in range(n)]
    F = [[g.var(f"F.{i}.{j}") for j in range(n)] for i in range(n)]
    FS = [[total(g, [(F[i][k], S[k][j]) for k in range(n)]) for j in range(n)] for i in range(n)]
    after = {(i, j): g.add(total(g, [(FS[i][k], F[j][k]) for k in range(n)]), g.var(f"Q.{i}.{j}")) for i, j in upper}
    recent = []
    for j in range(p):
        i = n - p + j
        growth, h = _fading(g, g.var(f"W.{j}"), S[i][i], after[i, i], g.var(f"lately.{j}"))
        after[i, i] = g.add(after[i, i], growth)
        recent.append(h)
    shares = [_share(g, after[i, i]) for i in range(n)]
    return Program(
        name=f"covariance of {n} estimates",
        time=DISCRETE,
        states=(*(f"spread.{i}.{j}" for i, j in upper), *(f"lately.{j}" for j in range(p))),
        inputs=(
            *(f"F.{i}.{j}" for i in range(n) for j in range(n)),
            *(f"Q.{i}.{j}" for i, j in upper),
            *(f"W.{j}" for j in range(p)),
        ),
        parameters=("interval", "memory", "follow", "end"),
        graph=g,
        update=(*(g.mul(g.mul(shares[i], shares[j]), after[i, j]) for i, j in upper), *recent),
        outputs={},
    )


def _share(g: Graph, variance: int) -> int:
    """Return the factor of a deviation that limits it to MOST scales: nothing overflows, and S stays a covariance."""
    limit = g.const(MOST * MOST)
    return g.call("sqrt", g.div(limit, g.call("max", variance, limit)))


def _fading(g: Graph, noise: int, before: int, after: int, recent: int) -> tuple[int, int]:
    """Return the growth of a variance without new information, and the next h, which follows η."""
    end, tiny = g.var("end"), g.const(1e-300)
    inverse = [g.div(g.const(1.0), g.call("max", S, tiny)) for S in (before, after)]
    eta = g.mul(noise, g.add(inverse[0], g.mul(end, g.sub(inverse[1], inverse[0]))))
    rate = g.call("min", g.mul(g.const(FADING), recent), g.var("memory"))
    rate = g.add(rate, g.mul(g.const(1e-12), g.var("memory")))  # never zero
    share = g.div(rate, g.add(g.const(1.0), g.power(g.div(eta, rate), 4)))
    variance = g.add(before, g.mul(end, g.sub(after, before)))
    growth = g.mul(g.mul(share, variance), g.var("interval"))
    return growth, g.add(recent, g.mul(g.var("follow"), g.sub(eta, recent)))


def reader(graph: Graph, filter_: Program, given: list[str]) -> Callable[[str], int]:
    """Return a function that gives the node of a filter's output in a graph: a constant, else an input.

    Names of inputs are added to ``given``.
    """

    def part(name: str) -> int:
        value = filter_.graph.value(filter_.outputs[name])
        if value is not None:
            return graph.const(value)
        given.append(name)
        return graph.var(name)

    return part


def total(graph: Graph, products: list[tuple[int, int]]) -> int:
    """Return the node of a sum of products."""
    result = graph.const(0.0)
    for a, b in products:
        result = graph.add(result, graph.mul(a, b))
    return result
