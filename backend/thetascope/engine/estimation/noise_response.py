"""The response of a score to measurement noise, accumulated backwards in time.

Along the rows of the filter of kalman_innovations.py a score g = Σ w ν/σ, a weighted sum of innovations, is a linear
function of the noise e of the measurements: the innovation of output k is ν = c ε + e, where ε is the error of the
filter's estimate, ε⁺ = F (ε − K ν). The adjoint μ = ∂g/∂ε of this recursion gives all derivatives in one pass, from the
last row to the first:

    μ ← Fᵀ μ,    for every output, the last one first:    ∂g/∂e = w/σ − K·μ,    μ ← μ + c ∂g/∂e.

The variance of g follows exactly for noise of any covariance, whatever process noise the filter assumes.
"""

from functools import lru_cache

from thetascope.engine.compiler.graph import Graph
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.estimation.covariance_equations import reader, total
from thetascope.engine.programs.program_store import derived


@lru_cache(maxsize=128)
def noise_response(filter_: Program, n: int, m: int) -> Program:
    """Return the pass for a filter with n states and m outputs, one step per row, last row first.

    Inputs: the filter's outputs ``F.i.j``, ``C.k.i``, ``K.k.i`` and ``weight.k`` that are not constant, and ``w.k``,
    the weight of each innovation in the score. States: μ, zero after the last row. Outputs: ``response.k``, ∂g/∂e of
    each output in the row.
    """
    return derived(["noise_response", filter_.digest], lambda: _write(filter_, n, m))


def _write(filter_: Program, n: int, m: int) -> Program:
    g, given = Graph(), []
    part = reader(g, filter_, given)

    mu = [g.var(f"mu.{i}") for i in range(n)]
    F = [[part(f"F.{i}.{j}") for j in range(n)] for i in range(n)]
    mu = [total(g, [(F[j][i], mu[j]) for j in range(n)]) for i in range(n)]
    outputs = {}
    for k in range(m - 1, -1, -1):
        K, c = [part(f"K.{k}.{i}") for i in range(n)], [part(f"C.{k}.{i}") for i in range(n)]
        own = g.mul(part(f"weight.{k}"), g.var(f"w.{k}"))
        response = g.sub(own, total(g, list(zip(K, mu, strict=True))))
        mu = [g.add(a, g.mul(b, response)) for a, b in zip(mu, c, strict=True)]
        outputs[f"response.{k}"] = response
    return Program(
        name=f"noise response of {filter_.name}",
        time=DISCRETE,
        states=tuple(f"mu.{i}" for i in range(n)),
        inputs=(*given, *(f"w.{k}" for k in range(m))),
        parameters=(),
        graph=g,
        update=tuple(mu),
        outputs={name: outputs[name] for name in sorted(outputs)},
    )
