"""Checks that several observers share. Each takes numbers from the run and gives a Check with the number in it."""

import numpy as np

from thetascope.engine.model.result import CANNOT_TELL, FAILS, HOLDS, Check
from thetascope.engine.observers.support.declaration import Observed


def verdict(condition: bool | None) -> str:
    return CANNOT_TELL if condition is None else (HOLDS if condition else FAILS)


def stable(name: str, matrix: np.ndarray, source: str, discrete: bool = False) -> Check:
    """Whether all eigenvalues lie in the open left half plane (or the open unit disc)."""
    eigenvalues = np.linalg.eigvals(matrix)
    value = float(np.abs(eigenvalues).max() if discrete else eigenvalues.real.max())
    limit = 1.0 if discrete else 0.0
    listed = ", ".join(f"{e.real:.4g}" if e.imag == 0 else f"{e:.4g}" for e in np.sort_complex(eigenvalues)[:8])
    what = "largest modulus" if discrete else "largest real part"
    return Check(name, verdict(value < limit), f"eigenvalues {listed}; {what} {value:.4g}", value, limit, source)


def windowed_gramian(omega: np.ndarray, run: Observed) -> np.ndarray:
    """∫ ΩᵀΩ over the last window (gain ``window``, s) at every row: Ω has shape (time, m, p), the answer (time, p, p).

    Zhao, Li & Li 2012, eq. (36). Until a whole window has passed the rows are NaN. Sums are taken within stretches of
    one window each, counted from t = 0: what stands in a row depends on the last two stretches only, bit for bit.
    """
    products = np.einsum("tki,tkj->tij", omega, omega) * run.record
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
    last = rows[whole] // length * length - 1 - run.first_row  # the end of the stretch before
    gramian[whole] = prefix[whole] + (prefix[last] - prefix[whole - length])
    return gramian


def window_rows(run: Observed) -> int:
    """Rows in the window of the excitation level."""
    return max(1, round(run.gain("window") / run.record))


def _stride(run: Observed) -> int:
    """λmin is found at rows that are multiples of this."""
    return max(1, window_rows(run) // 100)


def _earliest(run: Observed) -> int:
    """The first row whose Gramian matters: λmin at the first wanted row may be held since then."""
    stride = _stride(run)
    return max(0, (run.first_row + run.wanted) // stride * stride - run.first_row)


def smallest_eigenvalue(gramian: np.ndarray, run: Observed) -> np.ndarray:
    """λmin at about a hundred rows a window, held in between."""
    values = np.full(len(gramian), np.nan)
    begin = _earliest(run)
    rows = np.arange(begin, len(gramian))
    finite = np.isfinite(gramian[begin:]).all(axis=(1, 2))
    picked = rows[finite & ((run.first_row + rows) % _stride(run) == 0)]
    if not len(picked):
        return values
    small = np.linalg.eigvalsh(gramian[picked])[:, 0] if gramian.shape[1] > 1 else gramian[picked, 0, 0]
    known = rows[finite & (rows >= picked[0])]
    values[known] = small[np.searchsorted(picked, known, side="right") - 1]
    return values


def excitation(run: Observed) -> np.ndarray:
    """λmin of the windowed Gramian of Ω along the run (rows of the record)."""
    if not run.channels:
        return np.full(len(run.values["t"]), np.nan)
    omega = run.matrix("Omega", run.context.m, len(run.channels))
    return smallest_eigenvalue(windowed_gramian(omega, run), run)


def persistent_excitation(run: Observed, level: np.ndarray, source: str) -> Check:
    """Whether λmin of the windowed Gramian stays above the asked-for level δ."""
    finite = level[np.isfinite(level)]
    window, delta = run.gain("window"), run.gain("delta")
    if not len(finite):
        return Check(
            "persistent excitation",
            CANNOT_TELL,
            f"the run is shorter than the window of {window:g} s",
            None,
            delta,
            source,
        )
    settled = finite[len(finite) // 10 :]  # Υ starts at zero: the first windows are not yet those of the theorem
    value = float(settled.min())
    return Check(
        "persistent excitation",
        verdict(value >= delta),
        f"smallest eigenvalue of the Gramian of Ω over {window:g} s: {value:.3g}, asked for {delta:g}",
        value,
        delta,
        source,
    )


def positive_definite(run: Observed, name: str, size: int, source: str) -> Check:
    """Whether a recorded symmetric matrix stays positive definite."""
    matrices = run.matrix(name, size, size, symmetric=True)
    finite = matrices[np.isfinite(matrices).all(axis=(1, 2))]
    if not len(finite) or not size:
        why = "no finite value was recorded" if size else "there is nothing to estimate"
        return Check(f"{name} positive definite", CANNOT_TELL, why, None, 0.0, source)
    picked = finite[np.unique(np.linspace(0, len(finite) - 1, 200).astype(int))]
    value = float(np.linalg.eigvalsh(picked).min())
    return Check(
        f"{name} positive definite",
        verdict(value > 0),
        f"smallest eigenvalue over the run: {value:.3g}",
        value,
        0.0,
        source,
    )


def gain_at_least(run: Observed, name: str, least: float, source: str, why: str) -> Check:
    value = run.gain(name)
    return Check(f"{name} ≥ {least:g}", verdict(value >= least), f"{name} = {value:g}; {why}", value, least, source)


def claimed_sigma(run: Observed, name: str, scale: float | np.ndarray = 1.0) -> dict[str, np.ndarray]:
    """Columns ``claimed.<channel>``: the standard deviation of θ̂ that the observer's own equations claim, the root of the
    diagonal of a recorded covariance times ``scale``. What noise really makes of θ̂ is in ``sigma.<channel>`` (covariance.py).
    """
    return {
        f"claimed.{channel}": scale * np.sqrt(np.maximum(run.values[f"{name}.{j}.{j}"], 0.0))
        for j, channel in enumerate(run.channels)
    }
