"""Checks shared by several observers. Each computes a number from a run and returns it in a Check."""

from dataclasses import replace

import numpy as np

from thetascope.engine.model.result import CANNOT_TELL, FAILS, HOLDS, Check, Verdict
from thetascope.engine.observers.support.declaration import Observed
from thetascope.messages import Message

NO_VALUE = Message("check.no-value")
NOTHING = Message("check.nothing")
NO_ESTIMATE = Message("check.no-estimate")
_HELD = 0.9  # of its bound, at which forgetting no longer lets a covariance grow
_GREEK = {"Gamma": "Γ", "Upsilon": "Υ", "Omega": "Ω"}


def verdict(condition: bool | np.bool | None) -> Verdict:
    """Return "holds" for True, "fails" for False, and "cannot tell" for None."""
    return CANNOT_TELL if condition is None else (HOLDS if condition else FAILS)


def stable(matrix: str, values: np.ndarray, source: str, discrete: bool = False) -> Check:
    """Check that all eigenvalues lie in the open left half plane or, in discrete time, in the open unit disc.

    Args:
        matrix: the matrix as the paper writes it, for example ``A − KC``.
        values: its entries (n×n).
        source: paper and equation.
    """
    eigenvalues = np.linalg.eigvals(values)
    value = float(np.abs(eigenvalues).max() if discrete else eigenvalues.real.max())
    limit = 1.0 if discrete else 0.0
    listed = [f"{e.real:.4g}" if e.imag == 0 else f"{e:.4g}" for e in np.sort_complex(eigenvalues)[:8]]
    found = "check.unit-circle.eigenvalues" if discrete else "check.stable.eigenvalues"
    return Check(
        stability(matrix, discrete),
        verdict(value < limit),
        Message(found, eigenvalues=listed, value=value),
        value,
        limit,
        source,
    )


def stability(matrix: str, discrete: bool) -> Message:
    """Return the name of the check that a matrix is stable."""
    return Message("check.unit-circle" if discrete else "check.stable", matrix=matrix)


def windowed_gramian(omega: np.ndarray, run: Observed) -> np.ndarray:
    """Return ∫ ΩᵀΩ over the last window (gain ``window``, s) at every row (time, p, p); Ω has shape (time, m, p).

    Zhao, Li & Li 2012, eq. (36). Rows are NaN until a whole window has passed. Sums are accumulated in stretches of one
    window each, counted from t = 0, so that a row depends bit for bit on the last two stretches only.
    """
    products = np.einsum("tki,tkj->tij", omega, omega) * run.interval
    length = window_rows(run)
    rows = run.first_row + np.arange(len(products))
    prefix = np.empty_like(products)
    begin = 0
    while begin < len(rows):
        end = min(len(rows), (begin + run.first_row) // length * length + length - run.first_row)
        np.cumsum(products[begin:end], axis=0, out=prefix[begin:end])
        begin = end
    gramian = np.full_like(products, np.nan)
    whole = np.arange(max(run.born + length - run.first_row, length, _earliest(run)), len(rows))
    last = rows[whole] // length * length - 1 - run.first_row  # the end of the preceding stretch
    gramian[whole] = prefix[whole] + (prefix[last] - prefix[whole - length])
    return gramian


def window_rows(run: Observed) -> int:
    """Return the number of rows in the window of the excitation level."""
    return max(1, round(run.gain("window") / run.interval))


def _stride(run: Observed) -> int:
    """Return the stride in rows at which λmin is computed."""
    return max(1, window_rows(run) // 100)


def _earliest(run: Observed) -> int:
    """Return the first row whose Gramian matters: λmin at the first requested row may be held since then."""
    stride = _stride(run)
    return max(0, (run.first_row + run.wanted) // stride * stride - run.first_row)


def smallest_eigenvalue(gramian: np.ndarray, run: Observed) -> np.ndarray:
    """Return λmin at about a hundred rows per window, held in between; NaN without faults to estimate."""
    return eigenvalues(gramian, run)[:, 0] if gramian.shape[1] else np.full(len(gramian), np.nan)


def eigenvalues(gramian: np.ndarray, run: Observed) -> np.ndarray:
    """Return all eigenvalues (rows, p), ascending, at about a hundred rows per window, held in between."""
    values = np.full(gramian.shape[:2], np.nan)
    if gramian.shape[1] == 0:
        return values
    begin = _earliest(run)
    rows = np.arange(begin, len(gramian))
    finite = np.isfinite(gramian[begin:]).all(axis=(1, 2))
    picked = rows[finite & ((run.first_row + rows) % _stride(run) == 0)]
    if not len(picked):
        return values
    found = np.linalg.eigvalsh(gramian[picked]) if gramian.shape[1] > 1 else gramian[picked, :, 0]
    known = rows[finite & (rows >= picked[0])]
    values[known] = found[np.searchsorted(picked, known, side="right") - 1]
    return values


def excitation(run: Observed) -> np.ndarray:
    """Return λmin of the windowed Gramian of Ω along the run (rows of the record)."""
    omega = run.matrix("Omega", run.context.m, len(run.channels))
    return smallest_eigenvalue(windowed_gramian(omega, run), run)


def persistent_excitation(run: Observed, level: np.ndarray, source: str) -> Check:
    """Check that λmin of the windowed Gramian of Ω stays above the level δ, after Υ (zero at the start) has settled.

    Args:
        level: λmin at every row (``excitation``).
        source: paper and equation.
    """
    return excitation_above(run, level, source, "check.excitation.gramian")


def excitation_above(run: Observed, level: np.ndarray, source: str, found: str) -> Check:
    """Check an excitation against the gain ``delta``; ``found`` is the code of the sentence with its value."""
    name, window, delta = Message("check.excitation"), run.gain("window"), run.gain("delta")
    finite = level[np.isfinite(level)]
    if not len(finite):
        why = Message("check.window.short", window=window) if run.channels else NOTHING
        return Check(name, CANNOT_TELL, why, None, delta, source)
    value = float(finite[len(finite) // 10 :].min())  # the theorem does not apply to the first windows
    text = Message(found, window=window, value=value, level=delta)
    return Check(name, verdict(value >= delta), text, value, delta, source)


def positive_definite(run: Observed, name: str, size: int, source: str) -> Check:
    """Check that a recorded symmetric matrix (size × size) stays positive definite.

    Rows and columns are divided by the roots of the diagonal, so that the units of states and faults cancel.
    """
    title = Message("check.definite", matrix=_GREEK.get(name, name))
    matrices = run.matrix(name, size, size, symmetric=True)
    finite = matrices[np.isfinite(matrices).all(axis=(1, 2))]
    if not len(finite) or not size:
        return Check(title, CANNOT_TELL, NO_VALUE if size else NOTHING, None, 0.0, source)
    picked = finite[np.unique(np.linspace(0, len(finite) - 1, 200).astype(int))]
    value = float(np.linalg.eigvalsh(_unit_diagonal(picked)).min())
    return Check(title, verdict(value > 0), Message("check.definite.smallest", value=value), value, 0.0, source)


def bounded_covariance(run: Observed, name: str, source: str) -> Check:
    """Check a covariance of θ̂ as `positive_definite` does, and say from which time to the end its bound Γ̄ holds it.

    It is held where a diagonal entry is above 0.9 of its bound: there the input excites that fault too little.
    """
    size = len(run.channels)
    check = positive_definite(run, name, size, source)
    if check.value is None or not any(p.startswith("g.bound") for p in run.program.parameters):
        return check
    share = np.einsum("tii->ti", run.matrix(name, size, size, symmetric=True)) / run.gains("bound")
    free = np.flatnonzero(~(share > _HELD).any(axis=1))
    first = int(free[-1]) + 1 if len(free) else 0
    if first >= len(share):
        return check
    channels = [c for c, of_channel in zip(run.channels, share[-1] > _HELD, strict=True) if of_channel]
    args = {"value": check.value, "time": float(run.values["t"][first]), "channels": channels}
    return replace(check, text=Message("check.definite.bounded", **args))


def _unit_diagonal(matrices: np.ndarray) -> np.ndarray:
    """Return symmetric matrices (…, n, n) with rows and columns divided by the roots of their diagonals' sizes."""
    roots = np.sqrt(np.abs(np.einsum("...ii->...i", matrices)))
    roots = np.where(roots > 0, roots, 1.0)
    return matrices / roots[..., :, None] / roots[..., None, :]


def gain_at_least(run: Observed, name: str, symbol: str, least: float, source: str, why: Message) -> Check:
    """Check that a scalar gain is at least a bound; ``why`` gives the purpose of the bound."""
    value = run.gain(name)
    text = Message("check.gain.value", gain=symbol, value=value, why=why)
    return Check(Message("check.gain", gain=symbol, least=least), verdict(value >= least), text, value, least, source)


def claimed_sigma(run: Observed, name: str, scale: float | np.ndarray = 1.0) -> dict[str, np.ndarray]:
    """Return columns ``claimed.<channel>``: the standard deviation of θ̂ according to the observer's equations.

    It is the square root of the diagonal of a recorded covariance times ``scale``. The standard deviation that noise
    really causes is in ``sigma.<channel>`` (covariance.py).
    """
    return {
        f"claimed.{channel}": scale * np.sqrt(np.maximum(run.values[f"{name}.{j}.{j}"], 0.0))
        for j, channel in enumerate(run.channels)
    }
