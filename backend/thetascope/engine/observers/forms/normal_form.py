"""The normal form of a MIMO nonlinear time-varying plant by time-varying Lie derivatives.

Equations (3)–(7) of the paper on reduced-order observers for MIMO nonlinear time-varying systems (Control Theory &
Applications 17, 2000):

    z = T(x, t) = (h1, L h1, …, L^{ρ1−1} h1, h2, …),   L φ = ∂φ/∂t + (∂φ/∂x) f                          (3), (5)
    z' = A z + B [α(z, t) + F(z, t) u],   y = C z,   one chain of ρi integrators per output             (6), (7)

ρi, the relative degree of output i, is the order of its first derivative that an input or a known signal enters. The
sum of all ρi must be n. Observers compute α + F u as L^{ρi} hi at x̂, so T is needed at the start and its inverse at
every step. The inverse is computed symbolically, one state at a time (invert).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from thetascope.engine.errors import SpecError
from thetascope.engine.language.derivatives import derivative, jacobian
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.model.plant_model import Model, clock
from thetascope.engine.observers.forms.observable_form import rank_at, sample, tidy
from thetascope.engine.observers.forms.sizes import TooLarge, check_jacobian, lie_derivative
from thetascope.engine.observers.forms.state_inversion import NoInverse, invert
from thetascope.engine.observers.support.matrices import Matrix, matrix
from thetascope.messages import Message

if TYPE_CHECKING:
    from sympy import Expr, ImmutableMatrix, Symbol

PAPER = "Reduced-order observer for MIMO nonlinear time-varying systems, Control Theory & Applications 17, 2000"


@dataclass(frozen=True)
class NormalForm:
    """A normal form in the model's symbols. ``blocks`` holds ρ1, …, ρm, summing to n."""

    outputs: tuple[str, ...]
    blocks: tuple[int, ...]
    T: ImmutableMatrix  # z as a function of x and t (n×1)
    top: ImmutableMatrix  # α + F u: the highest derivatives (m×1)
    F: ImmutableMatrix  # decoupling matrix (4): ∂top/∂u (m×inputs)
    z: tuple[Symbol, ...]
    inverse: dict[Symbol, Expr]  # each state as a function of z, t and parameters

    @property
    def firsts(self) -> tuple[int, ...]:
        """Return the positions of y1, y2, … in z."""
        return tuple(sum(self.blocks[:i]) for i in range(len(self.blocks)))

    @property
    def coordinate_names(self) -> list[str]:
        """Return labels of the coordinates z: ``y1``, ``L y1``, ``L² y1`` … by output, with L the derivative (3)."""
        powers = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
        orders = [(y, k) for y, rho in zip(self.outputs, self.blocks, strict=True) for k in range(rho)]
        return [y if k == 0 else f"L {y}" if k == 1 else f"L{str(k).translate(powers)} {y}" for y, k in orders]

    @property
    def unmeasured(self) -> tuple[int, ...]:
        """Return the positions in z of all coordinates except the outputs."""
        return tuple(k for k in range(sum(self.blocks)) if k not in self.firsts)

    def from_z(self, z: Iterable[Expr]) -> ImmutableMatrix:
        """Return x (n×1) at a given z."""
        swap = dict(zip(self.z, z, strict=True))
        return sympy.ImmutableMatrix([e.xreplace(swap) for e in self.inverse.values()])

    @property
    def from_outputs(self) -> dict[Symbol, Expr]:
        """Return the states that the outputs alone determine, each as a function of the outputs' entries of z and t."""
        hidden = {self.z[k] for k in self.unmeasured}
        return {x: e for x, e in self.inverse.items() if not (e.free_symbols & hidden)}


def brunovsky(blocks: Sequence[int]) -> tuple[Matrix, Matrix, Matrix]:
    """Return A (n×n), B (n×m) and C (m×n) of (7) for m chains of integrators.

    ``blocks`` holds the lengths of the chains, which may be 0; shortened by one they give Ã, B̃, C̃ of (11).
    """
    n, m = sum(blocks), len(blocks)
    start = [sum(blocks[:i]) for i in range(m)]
    A = matrix(n, n, lambda i, j: int(j == i + 1 and j not in start))
    B = matrix(n, m, lambda i, j: int(blocks[j] > 0 and i == start[j] + blocks[j] - 1))
    C = matrix(m, n, lambda i, j: int(blocks[i] > 0 and j == start[i]))
    return A, B, C


def block_column(gain: Matrix, blocks: Sequence[int]) -> Matrix:
    """Return the block diagonal matrix (n×m) of a gain that is given as one column, block after block."""
    ends = [sum(blocks[: j + 1]) for j in range(len(blocks))]
    return matrix(sum(blocks), len(blocks), lambda i, j: gain[i] if ends[j] - blocks[j] <= i < ends[j] else 0)


def normal_form(model: Model) -> NormalForm:
    """Return the normal form of a model. Raises SpecError with the reason where it does not exist."""
    return _cached(_Key(model))


class _Key:
    """A model as a dictionary key by its data: an observer and the default of its gain share the computation."""

    def __init__(self, model: Model):
        self.model = model

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and other.model.data == self.model.data

    def __hash__(self) -> int:
        return hash(self.model.id)


@lru_cache(maxsize=8)
def _cached(key: _Key) -> NormalForm:
    model = key.model
    if model.time != "continuous":
        raise _refused(model, Message("observer.reason.discrete"))
    try:
        chains = [_chain(model, i) for i in range(model.m)]
    except TooLarge as why:
        raise _refused(model, why.message) from None
    blocks = tuple(len(chain) - 1 for chain in chains)
    if sum(blocks) != model.n:
        raise _refused(model, Message("observer.reason.degree", degrees=blocks, total=sum(blocks), states=model.n))
    map_ = sympy.ImmutableMatrix([e for chain in chains for e in chain[:-1]])
    top = sympy.ImmutableMatrix([chain[-1] for chain in chains])
    slopes = jacobian(map_, model.x)
    if max(rank_at(slopes, sample(model, seed)) for seed in range(4)) < model.n:
        raise _refused(model, Message("observer.reason.dependent"))
    z = tuple(sympy.Symbol(f"z[{k + 1}]", real=True) for k in range(model.n))  # a name that no plant can use
    try:
        inverse = invert(list(zip(z, map_, strict=True)), model)
    except NoInverse as why:
        raise _refused(model, Message("observer.reason.inverse", why=why.message)) from None
    F = jacobian(top, model.u) if model.u else sympy.ImmutableMatrix(model.m, 0, [])
    return NormalForm(model.outputs, blocks, map_, top, sympy.ImmutableMatrix(F), z, {x: inverse[x] for x in model.x})


def _chain(model: Model, i: int) -> list[Expr]:
    """Return h_i and its derivatives up to the first that an input or a known signal enters (Definition 2).

    If none ever enters, return them up to the first that adds no new coordinate.
    """
    f = model.f.xreplace(model.expansion)
    outside = set(model.u) | set(model.signals)
    chain = [model.h.xreplace(model.expansion)[i]]
    if chain[0].free_symbols & outside:
        raise _refused(model, Message("observer.reason.direct", output=model.outputs[i]))
    while True:
        following = tidy(derivative(chain[-1], clock()) + lie_derivative(chain[-1], model.x, f))  # (3)
        check_jacobian([*chain, following], model.x)
        stop = following.free_symbols & outside or not _is_new(model, chain, following)
        chain.append(following)
        if stop:
            return chain
        if len(chain) > model.n:
            raise _refused(model, Message("observer.reason.no-input", count=model.n, output=model.outputs[i]))


def _is_new(model: Model, chain: list[Expr], following: Expr) -> bool:
    slopes = jacobian([*chain, following], model.x)
    return max(rank_at(slopes, sample(model, seed)) for seed in range(4)) == len(chain) + 1


def _refused(model: Model, why: Message) -> SpecError:
    return SpecError("observers.kind", model.id, Message("observer.normal-form.none", why=why))
