"""The evidence for a fault that begins at any row, accumulated backwards in time.

Along the rows of the filter of kalman_innovations.py, Ω is linear in V, and V is linear in a fault's course. For a
fault that begins in some row (V = 0 there), J = Σ ΩᵀΩ and s = Σ Ωᵀν over all following rows are therefore a quadratic
and a linear form in (V, w, r), where V, the course w and its slope r are those of that row:

    J = [V w r] M [V w r]ᵀ,   s = [V w r] μ,   w⁺ = w + r δ,   r⁺ = ρ r.

M and μ of a row follow from those of the next row by the adjoint of the filter's recursion, which only adds squares, so
that nothing cancels. One pass thus gives J and s of steps (w = 1) and ramps (r = 1) for every onset, in place of one
run of the filter per onset as in Willsky & Jones, IEEE TAC 21(1), 1976. A ramp rises evenly (ρ = 1, δ: the share of a
decision interval that one row takes) or approaches its final value as w = 1 − exp(−time/τ) (ρ = exp(−row/τ), δ = 1 −
ρ). A ramp that has ended continues with the V and w of that row and r = 0.
"""

from functools import lru_cache

from thetascope.engine.compiler.graph import Graph
from thetascope.engine.compiler.system import DISCRETE, Program
from thetascope.engine.estimation.covariance_equations import total
from thetascope.engine.programs.program_store import derived

Matrix = list[list[int]]
SYMMETRIC = ("vv", "ww")  # blocks of which only the upper triangle is stored


def parts(filter_: Program) -> dict[str, int]:
    """Return the filter's outputs that determine V, with their nodes: the inputs of the backward pass in each row."""
    return {name: node for name, node in filter_.outputs.items() if not name.startswith("omega.")}


def forms(n: int, p: int) -> dict[str, tuple[tuple[int, ...], list[tuple[int, ...]]]]:
    """Return the blocks of M and μ: their shapes and stored entries. Blocks of slopes hold each channel separately."""
    both, each = [(i, j) for i in range(n) for j in range(p)], [(j,) for j in range(p)]
    return {
        "vv": ((n, n), [(i, j) for i in range(n) for j in range(i, n)]),
        "vw": ((n, p), both),
        "ww": ((p, p), [(i, j) for i in range(p) for j in range(i, p)]),
        "vr": ((n, p), both),
        "wr": ((p,), each),
        "rr": ((p,), each),
        "v": ((n,), [(i,) for i in range(n)]),
        "w": ((p,), each),
        "r": ((p,), each),
    }


@lru_cache(maxsize=128)
def onsets(filter_: Program, n: int, p: int, m: int) -> Program:
    """Return the backward pass of a filter with n states, p channels and m outputs, one step per row, last row first.

    Inputs: `parts` (those that are not constant). Parameters: ``trusted.k`` (0: output k is ignored), ``delta`` and
    ``rho``. The states are `forms`, zero after the last row.
    """
    return derived(["onsets", filter_.digest], lambda: _Writer(filter_, n, p, m).program())


class _Writer:
    def __init__(self, filter_: Program, n: int, p: int, m: int):
        self.filter, self.graph, self.n, self.p, self.m = filter_, Graph(), n, p, m
        self.given: list[str] = []

    def program(self) -> Program:
        n, p, m = self.n, self.p, self.m
        F, G = self._matrix("F", n, n), self._matrix("G", n, p)
        C, D, K = self._matrix("C", m, n), self._matrix("D", m, p), self._matrix("K", m, n)
        outputs = [(C[k], D[k], K[k], self._part(f"weight.{k}"), self._part(f"nu.{k}")) for k in range(m)]
        M = {name: self._block(name, shape) for name, (shape, _) in forms(n, p).items()}
        M = self._through(M, F, G)
        for k in range(m - 1, -1, -1):
            M = self._before_correction(M, *outputs[k], self.graph.var(f"trusted.{k}"))
        kept = [(name, place) for name, (_, places) in forms(n, p).items() for place in places]
        return Program(
            name=f"onsets of {self.filter.name}",
            time=DISCRETE,
            states=tuple(_name(name, place) for name, place in kept),
            inputs=tuple(self.given),
            parameters=(*(f"trusted.{k}" for k in range(m)), "delta", "rho"),
            graph=self.graph,
            update=tuple(_at(M[name], place) for name, place in kept),
            outputs={},
        )

    def _part(self, name: str) -> int:
        value = self.filter.graph.value(self.filter.outputs[name])
        if value is not None:
            return self.graph.const(value)
        self.given.append(name)
        return self.graph.var(name)

    def _matrix(self, name: str, rows: int, columns: int) -> Matrix:
        return [[self._part(f"{name}.{i}.{j}") for j in range(columns)] for i in range(rows)]

    def _block(self, name: str, shape: tuple[int, ...]) -> list:
        if len(shape) == 1:
            return [self.graph.var(_name(name, (i,))) for i in range(shape[0])]
        order = sorted if name in SYMMETRIC else tuple
        return [[self.graph.var(_name(name, tuple(order((i, j))))) for j in range(shape[1])] for i in range(shape[0])]

    def _through(self, M: dict, F: Matrix, G: Matrix) -> dict:
        """Return M before the prediction V⁺ = F V + G w, w⁺ = w + r δ, r⁺ = ρ r: the quadratic form in V, w and r."""
        g, n, p = self.graph, range(self.n), range(self.p)
        delta, rho = g.var("delta"), g.var("rho")
        Ft, Gt = _transposed(F, self.n), _transposed(G, self.p)
        toV = [[total(g, [(M["vv"][i][k], G[k][j]) for k in n]) for j in p] for i in n]
        toV = [[g.add(toV[i][j], M["vw"][i][j]) for j in p] for i in n]  # M [G; 1]: the coefficient of V⁺ w
        moved = [[g.add(g.mul(rho, M["vr"][i][j]), g.mul(delta, M["vw"][i][j])) for j in p] for i in n]
        FM = [[total(g, [(Ft[i][k], M["vv"][k][j]) for k in n]) for j in n] for i in n]
        kept = [g.mul(rho, M["wr"][j]) for j in p]
        grown = [g.add(kept[j], g.mul(delta, M["ww"][j][j])) for j in p]
        GM = [[total(g, [(Gt[i][k], M["vw"][k][j]) for k in n]) for j in p] for i in p]
        GV = [[total(g, [(Gt[i][k], toV[k][j]) for k in n]) for j in p] for i in p]
        return {
            "vv": [[total(g, list(zip(FM[i], Ft[j], strict=True))) for j in n] for i in n],
            "vw": [[total(g, [(Ft[i][k], toV[k][j]) for k in n]) for j in p] for i in n],
            "ww": [[g.add(M["ww"][i][j], g.add(GV[i][j], GM[j][i])) for j in p] for i in p],
            "vr": [[total(g, [(Ft[i][k], moved[k][j]) for k in n]) for j in p] for i in n],
            "wr": [g.add(grown[j], total(g, [(Gt[j][k], moved[k][j]) for k in n])) for j in p],
            "rr": [g.add(g.mul(g.mul(rho, rho), M["rr"][j]), g.mul(delta, g.add(kept[j], grown[j]))) for j in p],
            "v": [total(g, list(zip(Ft[i], M["v"], strict=True))) for i in n],
            "w": [g.add(M["w"][j], total(g, list(zip(Gt[j], M["v"], strict=True)))) for j in p],
            "r": [g.add(g.mul(rho, M["r"][j]), g.mul(delta, M["w"][j])) for j in p],
        }

    def _before_correction(
        self, M: dict, c: list[int], d: list[int], K: list[int], weight: int, nu: int, trusted: int
    ) -> dict:
        """Return M before the correction by an output, V⁺ = V − K ω with ω = c V + d w; ω/σ adds to the evidence."""
        g, n, p = self.graph, range(self.n), range(self.p)
        MK = [total(g, list(zip(M["vv"][i], K, strict=True))) for i in n]
        square = g.add(total(g, list(zip(K, MK, strict=True))), g.mul(trusted, g.mul(weight, weight)))  # KᵀMK + 1/σ²
        Kw = [total(g, [(K[k], M["vw"][k][j]) for k in n]) for j in p]
        Kr = [total(g, [(K[k], M["vr"][k][j]) for k in n]) for j in p]
        score = g.sub(g.mul(trusted, g.mul(weight, nu)), total(g, list(zip(K, M["v"], strict=True))))
        sc, sd = [g.mul(square, b) for b in c], [g.mul(square, b) for b in d]

        def less(a: int, *products: tuple[int, int]) -> int:
            for x, y in products:
                a = g.sub(a, g.mul(x, y))
            return a

        return {
            "vv": [
                [g.add(less(M["vv"][i][j], (c[i], MK[j]), (MK[i], c[j])), g.mul(sc[i], c[j])) for j in n] for i in n
            ],
            "vw": [
                [g.add(less(M["vw"][i][j], (MK[i], d[j]), (c[i], Kw[j])), g.mul(sc[i], d[j])) for j in p] for i in n
            ],
            "ww": [
                [g.add(less(M["ww"][i][j], (d[i], Kw[j]), (Kw[i], d[j])), g.mul(sd[i], d[j])) for j in p] for i in p
            ],
            "vr": [[less(M["vr"][i][j], (c[i], Kr[j])) for j in p] for i in n],
            "wr": [less(M["wr"][j], (d[j], Kr[j])) for j in p],
            "rr": M["rr"],
            "v": [g.add(M["v"][i], g.mul(c[i], score)) for i in n],
            "w": [g.add(M["w"][j], g.mul(d[j], score)) for j in p],
            "r": M["r"],
        }


def _name(block: str, place: tuple[int, ...]) -> str:
    return ".".join([block, *map(str, place)])


def _at(block: list, place: tuple[int, ...]) -> int:
    return block[place[0]] if len(place) == 1 else block[place[0]][place[1]]


def _transposed(a: Matrix, columns: int) -> Matrix:
    return [[row[j] for row in a] for j in range(columns)]
