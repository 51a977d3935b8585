"""The evidence in the data for every fault of the plant, independent of the observers: a regression with white noise.

An extended Kalman filter for x that assumes the known θ₀ (zero at first) has innovations that depend on θ to first
order as

    ν = Ω (θ − θ₀) + noise of covariance Σ,    Ω = C V + Ψ,    V⁺ = F (V − K Ω) + G,

where V is the sensitivity of the filter's x̂ to a constant θ (Zhang 2002; Zhao, Li & Li 2012, (34a) and (35), with the
filter's gain). With V = 0 at some instant, V is the sensitivity to a θ that has acted from that instant on. Outputs are
processed one after the other (their noises are independent), so each gives a scalar of variance one:
ν/σ = (Ω/σ) (θ − θ₀) + white noise. All decisions use only sums of ΩᵀΩ/σ² and Ωᵀν/σ² over windows. With G and Ψ
multiplied by a course over time, V is the sensitivity to a θ with this course. An output that is not in use has ν and
Ω, but does not correct the filter.

Between rows x changes by φ₁(AΔ) f Δ, which is exact where f is affine and inputs are constant; f takes inputs and t in
the middle of the interval. Where x is outside the physical domain, f and
its derivatives are evaluated at the nearest point inside. The process noise of each state equation is a share of the
state's scale (``q``); R is the measurement noise.
"""

import math
from collections.abc import Mapping
from functools import lru_cache

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.graph import Graph
from thetascope.engine.compiler.system import BEGIN, DISCRETE, WIDTH, Program
from thetascope.engine.estimation.covariance_equations import total
from thetascope.engine.programs.program_store import derived

HALVINGS = 2  # of the interval between rows, for the exponential of A; as many doublings undo them
_MOST_HALVINGS = 48
_BORDER = 8.0  # fastest rate times interval up to which HALVINGS suffice: Taylor's polynomial is stable up to 2.8 · 4
_MARGIN = 3  # further halvings, since an estimate may pass through faster regions than the healthy run
AHEAD = "ahead."  # prefix of inputs in the middle of the interval that follows a row
Matrix = list[list[int]]


def halvings(fastest: float, interval: float) -> int:
    """Return how often an interval in s is halved for a plant whose fastest rate is ``fastest`` in 1/s.

    Without the halvings of a stiff plant Taylor's polynomial is unstable, and the filter does not stay finite.
    """
    ratio = fastest * interval
    if not _BORDER < ratio < math.inf:
        return HALVINGS
    return min(_MOST_HALVINGS, math.ceil(math.log2(ratio)) + _MARGIN)


@lru_cache(maxsize=128)
def innovations(plant: Program, halved: int = HALVINGS) -> Program:
    """Return the filter for a plant, with one step per row; exp(A Δ) comes from Δ halved ``halved`` times.

    Inputs: those of the plant (θ apart) at the row and, as ``ahead.*``, in the middle of the interval after it,
    ``measured.y.*``, ``fresh.k`` (whether output k is new in this row), ``known.j`` (θ₀)
    and ``profile.j``: V and Ω are sensitivities to a θ_j − θ₀_j that is a constant times this profile. Parameters:
    those of the plant, the bounds ``low.i`` and ``high.i`` of its domain, ``q.i``, ``R.k`` (variance of one row's y),
    ``trusted.k`` (0: output k does not correct the filter) and ``interval``. Outputs: ``omega.k.j`` and ``nu.k``, both
    divided by the innovation's standard deviation (``weight.k`` is its reciprocal), and the matrices of V's recursion:
    ``F.i.j``, ``G.i.j`` (constant θ), ``C.k.i``, ``D.k.j`` (Ψ), ``K.k.i``.
    """
    key = ["innovations", plant.digest] + ([str(halved)] if halved != HALVINGS else [])
    return derived(key, lambda: _Writer(plant, halved).program())


class _Writer:
    def __init__(self, plant: Program, halved: int):
        self.plant, self.graph, self.halved = plant, Graph(), halved
        self.theta = [i for i in plant.inputs if i.startswith("theta.")]
        self.known = [i for i in plant.inputs if i not in self.theta]
        self.y = list(plant.outputs)
        self.n, self.p, self.m = len(plant.states), len(self.theta), len(self.y)
        g = self.graph
        self.prior = [g.var(f"prior.{i}") for i in range(self.n)]
        self.V = [[g.var(f"V.{i}.{j}") for j in range(self.p)] for i in range(self.n)]
        self.P = [[g.var(f"P.{min(i, j)}.{max(i, j)}") for j in range(self.n)] for i in range(self.n)]

    def program(self) -> Program:
        plant, g, n, p = self.plant, self.graph, self.n, self.p
        outputs = self._correct(*self._linear(list(plant.outputs.values())))
        f, A, G = self._linear(list(plant.update), self._ahead())
        F, E = self._transition(A)
        if plant.time == DISCRETE:
            prior = f
        else:
            G = self._times(E, G)
            prior = [g.add(x, total(g, list(zip(row, f, strict=True)))) for x, row in zip(self.prior, E, strict=True)]
        if plant.after:
            prior, F, G = self._events(prior, F, G)
        moved = [[g.mul(b, g.var(f"profile.{j}")) for j, b in enumerate(row)] for row in G]
        V = [
            [g.add(total(g, [(F[i][k], self.V[k][j]) for k in range(n)]), moved[i][j]) for j in range(p)]
            for i in range(n)
        ]
        P = self._spread(F)
        outputs |= {
            f"{name}.{i}.{j}": node
            for name, part in (("F", F), ("G", G))
            for i, row in enumerate(part)
            for j, node in enumerate(row)
        }
        per_state = [f"{name}.{i}" for name in ("q", "low", "high") for i in range(n)]
        return Program(
            name=f"innovations of {plant.name}",
            time=DISCRETE,
            states=(
                *(f"prior.{i}" for i in range(n)),
                *(f"V.{i}.{j}" for i in range(n) for j in range(p)),
                *(f"P.{i}.{j}" for i in range(n) for j in range(i, n)),
            ),
            inputs=(
                *self.known,
                *(f"{AHEAD}{i}" for i in self.known),
                *(f"measured.{o}" for o in self.y),
                *(f"fresh.{k}" for k in range(self.m)),
                *(f"known.{j}" for j in range(p)),
                *(f"profile.{j}" for j in range(p)),
            ),
            parameters=(
                *plant.parameters,
                *per_state,
                *(f"R.{k}" for k in range(self.m)),
                *(f"trusted.{k}" for k in range(self.m)),
                "interval",
            ),
            graph=g,
            update=(*prior, *(V[i][j] for i in range(n) for j in range(p)), *P),
            outputs=outputs,
        )

    def _ahead(self) -> dict[str, int]:
        """Return what known inputs and t are on average until the next row; nothing in discrete time."""
        if self.plant.time == DISCRETE:
            return {}
        g = self.graph
        middle = g.add(g.var("t"), g.mul(g.const(0.5), g.var("interval")))
        return {i: g.var(f"{AHEAD}{i}") for i in self.known} | {"t": middle}

    def _events(self, end: list[int], F: Matrix, G: Matrix) -> tuple[list[int], Matrix, Matrix]:
        """Return the state, F and G with the events on the way from the present estimate to the next row."""
        plant, g = self.plant, self.graph
        source, begins = Graph(plant.graph.nodes), [f"{BEGIN}{s}" for s in plant.states]
        slopes = derivatives(source, plant.after, (*plant.states, *begins))
        here = dict(zip(plant.states, end, strict=True)) | dict(zip(begins, self.prior, strict=True))
        here |= {WIDTH: g.var("interval")} | {t: g.var(f"known.{j}") for j, t in enumerate(self.theta)} | self._ahead()
        moved = g.absorb(source, [*plant.after, *(node for row in slopes for node in row.values())], here)
        zero = g.const(0.0)
        at_end, at_begin = (
            [[moved[row[s]] if s in row else zero for s in names] for row in slopes] for names in (plant.states, begins)
        )
        F = [
            [g.add(a, b) for a, b in zip(*rows, strict=True)]
            for rows in zip(self._times(at_end, F), at_begin, strict=True)
        ]
        return [moved[i] for i in plant.after], F, self._times(at_end, G)

    def _linear(self, roots: list[int], replaced: Mapping[str, int] | None = None) -> tuple[list[int], Matrix, Matrix]:
        """Return values and Jacobians in x and θ (times its profile) at the present estimate, ``self.prior``, θ₀."""
        plant, g = self.plant, self.graph
        source = Graph(plant.graph.nodes)
        slopes = derivatives(source, roots, (*plant.states, *self.theta))
        wanted = [*roots, *(node for row in slopes for node in row.values())]
        inside = [
            g.call("min", g.call("max", x, g.var(f"low.{i}")), g.var(f"high.{i}")) for i, x in enumerate(self.prior)
        ]
        here = dict(zip(plant.states, inside, strict=True)) | {t: g.var(f"known.{j}") for j, t in enumerate(self.theta)}
        moved, zero = g.absorb(source, wanted, here | dict(replaced or {})), g.const(0.0)
        J, H = (
            [[moved[row[s]] if s in row else zero for s in names] for row in slopes]
            for names in (plant.states, self.theta)
        )
        # outside the domain: the value at the nearest point inside, continued along its tangent
        values = [
            g.add(moved[r], total(g, [(a, g.sub(x, b)) for a, x, b in zip(row, self.prior, inside, strict=True)]))
            for r, row in zip(roots, J, strict=True)
        ]
        return values, J, H

    def _correct(self, level: list[int], C: Matrix, Psi: Matrix) -> dict[str, int]:
        """Correct prior, V and P by one output after the other; return Ω/σ, ν/σ and the matrices of V's recursion."""
        g, n, p = self.graph, self.n, self.p
        outputs, first = {}, list(self.prior)
        for k, name in enumerate(self.y):
            c, fresh = C[k], g.var(f"fresh.{k}")
            cP = [total(g, [(c[i], self.P[i][j]) for i in range(n)]) for j in range(n)]
            variance = g.add(total(g, list(zip(cP, c, strict=True))), g.var(f"R.{k}"))
            moved = total(
                g, [(a, g.sub(x, b)) for a, x, b in zip(c, self.prior, first, strict=True)]
            )  # by the preceding outputs
            nu = g.sub(g.var(f"measured.{name}"), g.add(level[k], moved))
            direct = [g.mul(b, g.var(f"profile.{j}")) for j, b in enumerate(Psi[k])]
            omega = [g.add(total(g, [(c[i], self.V[i][j]) for i in range(n)]), direct[j]) for j in range(p)]
            weight = g.div(fresh, g.call("sqrt", variance))
            outputs |= {f"omega.{k}.{j}": g.mul(o, weight) for j, o in enumerate(omega)}
            outputs[f"nu.{k}"] = g.mul(nu, weight)
            followed = g.div(g.mul(fresh, g.var(f"trusted.{k}")), variance)
            gain = [g.mul(followed, b) for b in cP]
            outputs |= {f"C.{k}.{i}": b for i, b in enumerate(c)} | {f"D.{k}.{j}": b for j, b in enumerate(Psi[k])}
            outputs |= {f"K.{k}.{i}": b for i, b in enumerate(gain)} | {f"weight.{k}": weight}
            self.prior = [g.add(x, g.mul(K, nu)) for x, K in zip(self.prior, gain, strict=True)]
            self.V = [
                [g.sub(v, g.mul(K, o)) for v, o in zip(row, omega, strict=True)]
                for row, K in zip(self.V, gain, strict=True)
            ]
            upper = {(i, j): g.sub(self.P[i][j], g.mul(gain[i], cP[j])) for i in range(n) for j in range(i, n)}
            self.P = [[upper[min(i, j), max(i, j)] for j in range(n)] for i in range(n)]
        return outputs

    def _transition(self, A: Matrix) -> tuple[Matrix, Matrix]:
        """Return exp(A Δ) and its integral over Δ for constant A: Taylor to order 4 on Δ/2^s, doubled s times."""
        g, n = self.graph, self.n
        if self.plant.time == DISCRETE:
            return A, []
        one, zero = g.const(1.0), g.const(0.0)
        unit = [[one if i == j else zero for j in range(n)] for i in range(n)]
        h = g.mul(g.var("interval"), g.const(0.5**self.halved))
        Ah = [[g.mul(a, h) for a in row] for row in A]
        power, F, E = unit, unit, unit
        for order in range(1, 5):
            power = self._times(power, Ah)
            F = self._plus(F, power, 1.0 / _factorial(order))
            E = self._plus(E, power, 1.0 / _factorial(order + 1))
        E = [[g.mul(e, h) for e in row] for row in E]
        for _ in range(self.halved):
            E = self._plus(E, self._times(F, E), 1.0)
            F = self._times(F, F)
        return F, E

    def _times(self, a: Matrix, b: Matrix) -> Matrix:
        g = self.graph
        return [
            [total(g, [(row[k], b[k][j]) for k in range(len(b))]) for j in range(len(b[0]) if b else 0)] for row in a
        ]

    def _plus(self, a: Matrix, b: Matrix, factor: float) -> Matrix:
        g = self.graph
        return [
            [g.add(x, g.mul(y, g.const(factor))) for x, y in zip(r, s, strict=True)] for r, s in zip(a, b, strict=True)
        ]

    def _spread(self, F: Matrix) -> list[int]:
        """Return the upper triangle of F P Fᵀ + Q. Q is per second (per step in discrete time)."""
        g, n = self.graph, self.n
        FP = self._times(F, self.P)
        q = [g.mul(g.var(f"q.{i}"), g.var("interval")) for i in range(n)]
        zero = g.const(0.0)
        return [
            g.add(total(g, list(zip(FP[i], F[j], strict=True))), q[i] if i == j else zero)
            for i in range(n)
            for j in range(i, n)
        ]


def _factorial(k: int) -> int:
    return 1 if k < 2 else k * _factorial(k - 1)
