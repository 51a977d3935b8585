"""Parity equations: residuals over a window of samples, each of them blind to one fault, whatever that fault does.

    x̂(k+1) = x̂(k) + ∫ f(x̂, u) dt,   δ(k) = y(k) − h(x̂(k)),   z = (δ(k−s), …, δ(k))
    z = O e + Σⱼ Tⱼ θⱼ + v,   rᵢ = |Pᵢ V^(−½) z| / √χ²

Chow & Willsky, IEEE TAC 29(7), 1984. O has the rows C Fʲ, Tⱼ holds the responses of the window to fault j at each of
its samples, and V is the covariance of the noise in a window. Pᵢ projects onto the complement of V^(−½)[O Tᵢ], so rᵢ
depends neither on the state nor on fault i. The parity relations hold for δ as they hold for y and u: a linear plant
and its model, driven by the same inputs, differ by e(k+1) = F e(k) + Φθ. For a plant that is not linear F, C, Φ and Ψ
are those of its operating point, and the model x̂ runs beside the plant without correction.

The square of |Pᵢ V^(−½) z| has a χ² distribution with as many degrees of freedom as Pᵢ has dimensions, so the threshold
follows from the accepted share of false alarms. Residuals are divided by it: rᵢ > 1 is an alarm.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import CANNOT_TELL, Check
from thetascope.engine.observers.classical.design import DISTINCT, Point, chosen, operating_point, requested
from thetascope.engine.observers.kalman.rk4_map import SUBSTEPS, carried
from thetascope.engine.observers.support.common_checks import NO_ESTIMATE, NOTHING, verdict
from thetascope.engine.observers.support.declaration import Context, Gain, Observed, Observer, Option
from thetascope.engine.observers.support.draft import NOW, Draft
from thetascope.engine.observers.support.kalman_defaults import learning_rate, noise_std, output_scales, pace
from thetascope.engine.observers.support.matrices import zeros
from thetascope.messages import Message

SOURCE = "Chow & Willsky 1984, IEEE TAC 29(7)"
MOST = 60  # samples in a window, less one
SEEN = 2.0  # thresholds that a typical fault must reach to count as seen
BLIND = 1e-6  # relative size of a singular value of V^(−½)[O Tᵢ], below which a direction is rounding
AT_REST = 1e-9  # real part of an eigenvalue of A, relative to the largest, that counts as 0: an integrator
_USUAL = 24  # the largest order taken by default
_LAST = 0.25  # share of the rows, at the end, on which faults are read from the residuals


@dataclass(frozen=True)
class Relations:
    """The parity relations of a plant: `each[i]` (d×N) with orthonormal noise for residual i, and its threshold.

    ``reach`` (p×p): the size of residual i, in thresholds, where a typical fault j has lasted for a whole window.
    """

    each: tuple[np.ndarray, ...]
    thresholds: np.ndarray
    reach: np.ndarray


def exponential(M: np.ndarray) -> np.ndarray:
    """Return exp(M): its series at M/2^k, squared k times."""
    doublings = max(0, int(np.frexp(np.abs(M).sum(axis=1).max(initial=0.0) / 0.5)[1]))
    total = term = np.eye(len(M))
    for k in range(1, 15):
        term = term @ M / (k * 2.0**doublings)
        total = total + term
    for _ in range(doublings):
        total = total @ total
    return total


def responses(point: Point, step: float, length: int) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return O (N×n) and for each fault T (N × length), N = length·m, of the plant sampled at a step in paces."""
    n, p = point.Phi.shape
    joint = np.zeros((n + p, n + p))
    joint[:n, :n], joint[:n, n:] = point.A, point.Phi
    both = exponential(joint * step)
    F, held, m = both[:n, :n], both[:n, n:], len(point.C)
    powers = [np.eye(n)]
    for _ in range(length - 1):
        powers.append(F @ powers[-1])
    T = np.zeros((p, length * m, length))
    for row in range(length):
        T[:, row * m : row * m + m, row] = point.Psi.T
        for at in range(row):  # a fault during the interval that follows sample `at`
            T[:, row * m : row * m + m, at] = (point.C @ powers[row - 1 - at] @ held).T
    return np.vstack([point.C @ power for power in powers]), list(T)


def covariance(c: Context, length: int) -> np.ndarray:
    """Return the covariance of the noise in a window, scaled (N×N): noise that is held is shared by its samples."""
    std, holds = np.array(noise_std(c)) / np.array(output_scales(c)), c.noise_hold or (0.0,) * c.m
    lag = np.abs(np.subtract.outer(np.arange(length), np.arange(length))) * c.period
    V = np.zeros((length, c.m, length, c.m))
    for i, hold in enumerate(holds):
        shared = np.maximum(0.0, 1.0 - lag / hold) if hold > 0 else (lag == 0).astype(float)
        V[:, i, :, i] = std[i] ** 2 * shared
    return V.reshape(length * c.m, length * c.m)


def relations(c: Context, point: Point, length: int, alpha: float) -> Relations:
    """Return the parity relations, in scaled outputs, with thresholds for the share alpha of false alarms."""
    from scipy.stats import chi2

    free, T = responses(point, c.period * pace(c), length)
    values, vectors = np.linalg.eigh(covariance(c, length))
    white = (vectors / np.sqrt(np.maximum(values, 1e-9 * values[-1]))).T
    each = [complement(white @ np.hstack([free, own])) @ white for own in T]
    limits = np.array([np.sqrt(chi2.isf(alpha, len(W))) for W in each])
    lasting = [own.sum(axis=1) for own in T]
    reach = np.array([[np.linalg.norm(W @ step) for step in lasting] for W in each]).reshape(len(T), len(T))
    return Relations(tuple(each), limits, reach / limits[:, None])


def complement(M: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis, as rows, of the directions that M (N×k) does not reach."""
    norms = np.linalg.norm(M, axis=0)
    U, singular, _ = np.linalg.svd(M / np.where(norms > 0, norms, 1.0))
    return U[:, int((singular > BLIND * singular.max(initial=0.0)).sum()) :].T


def fits(point: Point) -> bool:
    """Return whether there are outputs left when a fault is projected out, and each fault shows in some output."""
    if not point.channels:
        return True
    effects = np.vstack([point.Phi, point.Psi])
    return len(point.C) > 1 and bool((np.linalg.norm(effects, axis=0) > DISTINCT).all())


def constants(c: Context) -> dict[str, np.ndarray]:
    """Return the scale of each output (m×1). Raises SpecError for a plant without structured residuals."""
    requested(c, fits)
    return {"scale": np.reshape(output_scales(c), (-1, 1))}


def default_order(c: Context) -> int:
    """Return an order for which a window lasts as long as a fault takes to show, and more samples than states."""
    lasting = math.ceil(round(1 / (learning_rate(c) * c.period), 6))
    return min(max(c.n + 1, lasting), _USUAL)


ALPHA = Gain("alpha", Message("gain.false-share"), 1e-4, 1e-9, 0.5, symbol="α", live=False)
ORDER = Option("order", Message("option.parity-order"), "integer", default_order, low=1, high=MOST)


def write(d: Draft) -> None:
    """Write the model beside the plant and the window of its output errors.

    Raises SpecError for a window from which the state and a fault's course take everything: [O T] has n + s + 1 columns
    and m(s + 1) rows.
    """
    order = int(str(d.options["order"]))
    if d.p and d.m > 1 and (order + 1) * (d.m - 1) <= d.n:
        raise SpecError("options.order", order, Message("observer.parity.short", least=d.n // (d.m - 1)))
    x = d.estimate_of_state()
    predicted = carried(d, "flow", x, zeros(d.p))
    at = d.at(predicted, [0] * d.p, NOW)
    scale = d.constant("scale", d.m, 1)
    length = order + 1
    window = d.states("window", length, d.m)
    for k in range(length - 1):
        d.set(window[k, :], window[k + 1, :])
    for i in range(d.m):
        d.set(window[length - 1, i], (d.measured(NOW)[i] - at.h[i]) / scale[i])
    d.set(x, predicted)
    d.estimates(x, None, d.at(x, [0] * d.p).h)


def of_run(run: Observed) -> tuple[Relations, int]:
    """Return the parity relations of a run, and the number of samples in a window."""
    length = sum(name.startswith("window.") for name in run.program.states) // run.context.m
    return relations(run.context, operating_point(run.context).of(run.channels), length, run.gain("alpha")), length


def diagnostics(run: Observed) -> dict[str, np.ndarray]:
    """``residual.<channel>``: the residual that is blind to this channel, in thresholds; NaN until a window is full.

    Sums are taken term by term, so that a row has the same bits in any block of rows.
    """
    if not run.channels:
        return {}
    found, length = of_run(run)
    z = [run.values[f"window.{k}.{i}"] for k in range(length) for i in range(run.context.m)]
    rows = run.first_row + np.arange(len(run.values["t"])) - run.born
    filled = rows * run.interval >= length * run.context.period * (1 - 1e-9)
    columns = {}
    for name, W, limit in zip(run.channels, found.each, found.thresholds, strict=True):
        square = np.zeros(len(rows))
        for weights in W:
            part = np.zeros(len(rows))
            for weight, value in zip(weights, z, strict=True):
                part = part + weight * value
            square = square + part * part
        columns[f"residual.{name}"] = np.where(filled, np.sqrt(square) / limit, np.nan)
    return columns


def checks(run: Observed) -> list[Check]:
    """Check that the residuals tell the faults apart, and that what they show is one of their signatures."""
    if not run.channels:
        return [Check(Message("check.isolable"), CANNOT_TELL, NOTHING, source=SOURCE)]
    reach = of_run(run)[0].reach
    return [isolable(run, reach), beside(run), explained(run, reach)]


def beside(run: Observed) -> Check:
    """Check that the model beside the plant does not run away from it.

    Nothing corrects the model, and its error e grows with the largest real part of the eigenvalues of A. The relations
    are blind to e of a linear plant, as far as rounding allows; those of another plant hold for a small e only.
    """
    point, rate = operating_point(run.context), pace(run.context)
    values = np.linalg.eigvals(point.A) * rate
    value, limit = float(values.real.max()), AT_REST * float(np.abs(values).max(initial=0.0))
    runs_away = value > limit
    growth = min(value * run.interval * len(run.values["t"]), 700.0) if runs_away else 0.0
    text = Message("check.beside.grows" if runs_away else "check.beside.stays", value=value, growth=math.exp(growth))
    return Check(Message("check.beside"), verdict(not runs_away), text, value, limit, SOURCE)


def isolable(run: Observed, reach: np.ndarray) -> Check:
    """Check that a typical fault is seen by at least one residual, and no two faults by the same ones."""
    seen, names = reach > SEEN, run.channels
    alike = [
        f"{names[a]} = {names[b]}" for a, b in combinations(range(len(names)), 2) if (seen[:, a] == seen[:, b]).all()
    ]
    unseen = [name for name, column in zip(names, seen.T, strict=True) if not column.any()]
    listed = [
        f"{name}: {''.join('1' if s else '0' for s in column)}" for name, column in zip(names, seen.T, strict=True)
    ]
    text = Message("check.isolable.signatures", signatures=listed)
    if unseen:
        text = Message("check.isolable.unseen", signatures=listed, names=unseen)
    elif alike:
        text = Message("check.isolable.alike", signatures=listed, names=alike)
    least = float(reach.max(axis=0).min())
    return Check(Message("check.isolable"), verdict(not alike and not unseen), text, least, SEEN, SOURCE)


def explained(run: Observed, reach: np.ndarray) -> Check:
    """Check that the residuals over their thresholds, at the end of the run, are those of one fault or of none."""
    name = Message("check.signature")
    r = np.array([run.values[f"residual.{channel}"] for channel in run.channels])
    late = r[:, -max(1, int(_LAST * r.shape[1])) :]
    if not np.isfinite(late).all():
        return Check(name, CANNOT_TELL, NO_ESTIMATE, source=SOURCE)
    over = (late > 1).mean(axis=1) > 0.5
    if not over.any():
        return Check(name, verdict(True), Message("check.signature.none"), source=SOURCE)
    fitting = [c for c, column in zip(run.channels, (reach > SEEN).T, strict=True) if (column == over).all()]
    text = Message("check.signature.named", names=fitting) if fitting else Message("check.signature.unknown")
    return Check(name, verdict(bool(fitting)), text, source=SOURCE)


OBSERVER = Observer(
    id="parity",
    source="Chow & Willsky 1984, IEEE TAC 29(7), 603–614; Gertler 1998, Fault Detection and Diagnosis",
    gains=(ALPHA,),
    options=(ORDER, SUBSTEPS),
    write=write,
    checks=checks,
    diagnostics=diagnostics,
    time="discrete",
    estimates_theta=False,
    residuals=True,
    chooses=lambda c: chosen(c, fits),
    constants=constants,
    equations=(
        ("", "x̂⁺ = x̂ + ∫f(x̂, u)dt"),
        ("", "δ = y − h(x̂)"),
        ("", "z = Oe + Tθ + v"),
        ("", "P[O T] = 0"),
        ("", "r = |Pz|"),
    ),
    where=(
        ("z", Message("symbol.parity-window")),
        ("P", Message("symbol.parity-projection")),
        ("r", Message("symbol.parity-residual")),
    ),
)
