"""How sure an observer's θ̂ is: its own equations linearised, and the covariance that noise makes of that.

Let e be the deviation of an observer's estimates (x̂, θ̂) from where they would be without noise and with the true θ. To
first order, from the derivatives of the observer's own equations (engine/compiler/autodiff.py),

    e' = A e + B n,    A = ∂(x̂', θ̂')/∂(x̂, θ̂),    B = ∂(x̂', θ̂')/∂y,    n white of intensity R,
    S' = A S + S Aᵀ + B R Bᵀ,

whatever its kind: no property of a paper's theorem is used. Observers at a sample period obey the same with a step for
each sample, S⁺ = A S Aᵀ + B R Bᵀ. S starts at how far the first estimates may be off. What is known
of a fault fades while nothing is learnt of it: η, the noise that comes into its estimate divided by its variance, is twice the
rate of learning where the two balance. Where η is far below what it was lately (h), the variance grows by FADING·h instead,
at most at the plant's pace, so that the band widens when excitation is lost. Gains that are states themselves
(Γ, P, Υ) are taken as they are: what noise does to them meets a residual that is zero but for noise, and is of second order.
"""

from dataclasses import dataclass
from functools import lru_cache

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.graph import Graph
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.programs.program_store import derived

FADING = 0.04  # of the rate at which a fault was learnt of: by so much its variance grows while nothing is learnt


@dataclass(frozen=True)
class Shape:
    """Names in an observer's program: its estimates of the state and of θ, and the outputs it is given."""

    x: tuple[str, ...]
    theta: tuple[str, ...]
    outputs: tuple[str, ...]


def shape_of(program: Program) -> Shape:
    """Return which states of an observer's program are x̂ and θ̂, and which inputs are y."""
    return Shape(
        tuple(s for s in program.states if s.startswith("xh.")),
        tuple(s for s in program.states if s.startswith("thetah.")),
        tuple(i for i in program.inputs if i.startswith("y.")),
    )


@lru_cache(maxsize=128)
def companion(program: Program) -> Program:
    """The program of S for an observer's program; its inputs are the observer's states and inputs."""
    return derived(["companion", program.digest], lambda: _write(program))


def _write(program: Program) -> Program:
    shape, graph = shape_of(program), Graph()
    estimates = (*shape.x, *shape.theta)
    size, place = len(estimates), {s: i for i, s in enumerate(program.states)}
    moved = graph.absorb(program.graph, program.update)
    given = [f"now.{o}" if program.time == DISCRETE else o for o in shape.outputs]
    rates = derivatives(graph, [moved[program.update[place[s]]] for s in estimates], (*estimates, *given))
    zero = graph.const(0.0)
    A = [[row.get(s, zero) for s in estimates] for row in rates]
    B = [[row.get(y, zero) for y in given] for row in rates]
    return Program(
        name=f"companion of {program.name}",
        time=program.time,
        states=(
            *(f"spread.{i}.{j}" for i in range(size) for j in range(i, size)),
            *(f"lately.{j}" for j in range(len(shape.theta))),
        ),
        inputs=(*program.states, *program.inputs),
        parameters=(*program.parameters, *(f"intensity.{k}" for k in range(len(given))), "memory"),
        graph=graph,
        update=tuple(_covariance(graph, A, B, program.time, len(shape.x))),
        outputs={f"slope.{i}.{j}": A[i][j] for i in range(size) for j in range(size)},
    )


def _covariance(graph: Graph, A: list[list[int]], B: list[list[int]], time: str, n: int) -> list[int]:
    """A S + S Aᵀ + B R Bᵀ (continuous), A S Aᵀ + B R Bᵀ (one sample): the upper triangle; then h of each θ̂."""
    size, m = len(A), len(B[0]) if B else 0
    S = [[graph.var(f"spread.{min(i, j)}.{max(i, j)}") for j in range(size)] for i in range(size)]
    R = [graph.var(f"intensity.{k}") for k in range(m)]
    BR = [[graph.mul(B[i][k], R[k]) for k in range(m)] for i in range(size)]
    AS = [[total(graph, [(A[i][k], S[k][j]) for k in range(size)]) for j in range(size)] for i in range(size)]
    update, lately = [], []
    for i in range(size):
        for j in range(i, size):
            noise = total(graph, [(BR[i][k], B[j][k]) for k in range(m)])
            if time == DISCRETE:
                moved = total(graph, [(AS[i][k], A[j][k]) for k in range(size)])
            else:
                moved = graph.add(AS[i][j], AS[j][i])
            if i == j >= n:
                fading, h = _fading(graph, noise, S[i][i], f"lately.{i - n}", time)
                moved, lately = graph.add(moved, fading), [*lately, h]
            update.append(graph.add(moved, noise))
    return update + lately


def _fading(graph: Graph, noise: int, S: int, name: str, time: str) -> tuple[int, int]:
    """What is added to a variance while nothing is learnt, and h' (or its next value): h follows η in the time 1/``memory``."""
    h = graph.var(name)
    eta = graph.div(noise, graph.call("max", S, graph.const(1e-300)))
    rate = graph.call("min", graph.mul(graph.const(FADING), h), graph.var("memory"))
    rate = graph.add(rate, graph.const(1e-12))
    share = graph.div(rate, graph.add(graph.const(1.0), graph.power(graph.div(eta, rate), 4)))
    follows = graph.mul(graph.var("memory"), graph.sub(eta, h))
    return graph.mul(share, S), follows if time != DISCRETE else graph.add(h, follows)


def total(graph: Graph, products: list[tuple[int, int]]) -> int:
    """The node of a sum of products."""
    result = graph.const(0.0)
    for a, b in products:
        result = graph.add(result, graph.mul(a, b))
    return result
