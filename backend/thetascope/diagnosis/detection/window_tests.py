"""Windowed likelihood-ratio tests on sums of evidence; runs and live sessions share them, row for row.

Evidence is a regression x(k) = Ω(k) (θ − θ₀) + noise of variance one, θ₀ being the known faults (zero: no fault). The
sums J = Σ ΩᵀΩ, s = Σ Ωᵀx, q = Σ xᵀx are stored at *decisions*, one every `stride` rows. Over a window of decisions the
generalised likelihood ratio of "θ_j has changed" against "no change" is, for each channel j,

    GLR_j = max over δ within bounds of (2 s_j δ − J_jj δ²) / v_j,    s_j²/(J_jj v_j) where no bound forbids it,

v_j being the variance of s_j/√J_jj in simulations without faults: one for white noise and an exact filter. It may be
several times larger than its mean where inputs have just switched; tests use the largest.

Willsky & Jones, IEEE TAC 21(1), 1976; Basseville & Nikiforov, Detection of Abrupt Changes, 1993, §2.4.3 and ch. 7.
Windows have a few lengths, each a third longer than the one before: Lai, JRSS B 57(4), 1995, shows that this loses
little.
"""

from dataclasses import dataclass, replace

import numpy as np

LONGEST = 600  # decisions in the longest window
_VISIBLE = 1e-12  # share of the largest information on any typical fault that counts as information
_TOGETHER = 128  # decisions that are scanned together: their windows fit into the processor's cache
GROWTH = 1.35  # ratio of successive lengths of windows


@dataclass(frozen=True)
class WindowSums:
    """Cumulative sums of evidence at decisions `first`, `first` + 1, …

    Attributes:
        first: number of the first decision.
        J: (decisions, p, p), Σ ΩᵀΩ of the trusted outputs.
        s: (decisions, p), Σ Ωᵀx of the trusted outputs.
        q: (decisions, m), Σ x² of each output, trusted or not.
        e: (decisions,), Σ x² of the trusted outputs.
        repeats: (decisions, m), not a sum: the number of latest rows in which an output repeated its value.
    """

    first: int
    J: np.ndarray
    s: np.ndarray
    q: np.ndarray
    e: np.ndarray
    repeats: np.ndarray

    @classmethod
    def empty(cls, p: int, m: int) -> "WindowSums":
        """Return the sums at decision 0: all zero."""
        return cls(0, np.zeros((1, p, p)), np.zeros((1, p)), np.zeros((1, m)), np.zeros(1), np.zeros((1, m)))

    @property
    def last(self) -> int:
        """The number of the latest decision."""
        return self.first + len(self.q) - 1

    def extended(
        self,
        omega: np.ndarray,
        x: np.ndarray,
        trusted_outputs: np.ndarray | None = None,
        y: np.ndarray | None = None,
        repeatable: np.ndarray | None = None,
    ) -> "WindowSums":
        """Return the sums with more decisions.

        Args:
            omega: (decisions, rows in each, m, p).
            x: (decisions, rows in each, m).
            trusted_outputs: (m,), 1 or 0; None: all are trusted.
            y: (rows + 1, m), measurements, from the row before the first on; None: no repeats are counted.
            repeatable: (rows, m), the rows for which a repeated value counts; None: one.
        """
        q = np.einsum("drm,drm->dm", x, x)
        repeats = np.zeros_like(q)
        if y is not None:
            repeats = _repeats(self.repeats[-1], y, repeatable)[x.shape[1] - 1 :: x.shape[1]]
        if trusted_outputs is not None and not trusted_outputs.all():
            omega, x = omega * trusted_outputs[:, None], x * trusted_outputs
        J, s, e = (
            np.einsum("drmi,drmj->dij", omega, omega),
            np.einsum("drmi,drm->di", omega, x),
            np.einsum("drm,drm->d", x, x),
        )
        # added one after the other, so that the sums do not depend on how a run is cut
        return WindowSums(
            self.first,
            _cumulated(self.J, J),
            _cumulated(self.s, s),
            _cumulated(self.q, q),
            _cumulated(self.e, e),
            np.concatenate([self.repeats, repeats]),
        )

    def until(self, decision: int) -> "WindowSums":
        """Return the sums up to a decision."""
        return self._cut(slice(None, decision - self.first + 1))

    def recent(self, keep: int) -> "WindowSums":
        """Return the last `keep` decisions."""
        cut = max(0, len(self.q) - keep)
        return self if cut == 0 else replace(self._cut(slice(cut, None)), first=self.first + cut)

    def _cut(self, part: slice) -> "WindowSums":
        return WindowSums(self.first, self.J[part], self.s[part], self.q[part], self.e[part], self.repeats[part])

    def over(self, begin: np.ndarray | int, end: np.ndarray | int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return J, s, e of the rows after decision `begin`, up to decision `end`; both may be arrays."""
        a, b = np.asarray(begin) - self.first, np.asarray(end) - self.first
        return self.J[b] - self.J[a], self.s[b] - self.s[a], self.e[b] - self.e[a]


def _cumulated(sums: np.ndarray, terms: np.ndarray) -> np.ndarray:
    """Return cumulative sums with more terms added (the first axis: decisions)."""
    return np.concatenate([sums, np.cumsum(np.concatenate([sums[-1:], terms]), axis=0)[1:]])


def _repeats(before: np.ndarray, y: np.ndarray, weight: np.ndarray | None) -> np.ndarray:
    """Return for how many rows in succession y (rows + 1, m) has repeated its value at each row (rows, m), counted on
    from `before` (m,); `weight`: (rows, m), the rows for which a row counts, None: one."""
    same = y[1:] == y[:-1]
    count = np.cumsum(same if weight is None else same * weight, axis=0)
    since = np.maximum.accumulate(np.where(same, 0, count), axis=0)
    carried = np.where(np.logical_and.accumulate(same, axis=0), before, 0.0)
    return count - since + carried


def lengths(most: int) -> np.ndarray:
    """Return the lengths of windows in decisions: 1, 2, 3, 4, 5, 7, … up to `most`."""
    sizes, length = [], 1.0
    while length <= min(most, LONGEST):
        sizes.append(int(length))
        length = max(length + 1, length * GROWTH)
    return np.array(sizes)


@dataclass(frozen=True)
class WindowNoise:
    """The statistics of windows without a fault, from simulations.

    Attributes:
        lengths: (lengths,), of the windows, in decisions.
        v: (lengths, p), variance of s_j/√J_jj.
        largest_v: (lengths, p), the same where it is largest along the run; the tests use it.
        early_v: (lengths, p), the same for windows that begin before decision `ready`.
        ready: decision at which the filter's covariance has settled.
        energy, energy_std: (lengths,), mean and standard deviation of the energy of all outputs.
    """

    lengths: np.ndarray
    v: np.ndarray
    largest_v: np.ndarray
    early_v: np.ndarray
    ready: int
    energy: np.ndarray
    energy_std: np.ndarray

    def nearest(self, length: np.ndarray | int) -> np.ndarray:
        """Return the index of the longest simulated length that is not longer than `length`, at least 0."""
        return np.maximum(np.searchsorted(self.lengths, length, side="right") - 1, 0)

    def expected_energy(self, length: int, trusted_outputs: np.ndarray) -> tuple[float, float]:
        """Return mean and standard deviation of the energy of trusted outputs (m,) over `length` decisions of noise."""
        k = int(self.nearest(length))
        share = float(np.mean(trusted_outputs)) * length / self.lengths[k]
        return float(self.energy[k]) * share, float(self.energy_std[k]) * share**0.5


@dataclass(frozen=True)
class ThetaBounds:
    """Lower and upper bounds of θ (p,) each, ±∞ where a θ has no bound, and the typical size of each fault (p,)."""

    low: np.ndarray
    high: np.ndarray
    typical: np.ndarray

    def relative_to(self, known: np.ndarray) -> "ThetaBounds":
        """Return the bounds of a change from θ₀ = `known` (p,); zero is always inside."""
        return ThetaBounds(np.minimum(self.low - known, 0.0), np.maximum(self.high - known, 0.0), self.typical)


def _sizes(D: np.ndarray, s: np.ndarray, bounds: ThetaBounds) -> np.ndarray:
    """Return the most likely θ_j of each channel alone (p, …): s_j/J_jj within bounds, 0 where J_jj vanishes
    against that of other channels in typical faults; `D`: the diagonal of J. The largest of few channels is found
    fast on the first axis."""
    low, high, typical = (each.reshape(-1, *[1] * (D.ndim - 1)) for each in (bounds.low, bounds.high, bounds.typical))
    scaled = D * typical**2
    visible = _VISIBLE * np.max(scaled, axis=0, initial=1e-300) < scaled
    size = np.divide(s, D, out=np.zeros_like(D), where=visible)
    return np.clip(size, low, high, out=size)


def explained(D: np.ndarray, s: np.ndarray, bounds: ThetaBounds) -> np.ndarray:
    """Return the energy that each channel alone explains (…, p): s_j²/J_jj, or less where bounds exclude s_j/J_jj."""
    return np.moveaxis(_explained(np.moveaxis(D, -1, 0), np.moveaxis(s, -1, 0), bounds), 0, -1)


def _explained(D: np.ndarray, s: np.ndarray, bounds: ThetaBounds) -> np.ndarray:
    """Return `explained` with channels on the first axis (p, …)."""
    size = _sizes(D, s, bounds)
    return np.maximum((2 * s - size * D) * size, 0.0)


def scan(
    sums: WindowSums, ends: np.ndarray, start: int, memory: float, noise: WindowNoise, bounds: ThetaBounds
) -> tuple[np.ndarray, np.ndarray]:
    """Return for each decision the largest GLR over windows and channels, and the largest residual over windows.

    Args:
        sums: the evidence.
        ends: (decisions,), the decisions at which windows end.
        start: the first decision at which a window may begin.
        memory: decisions that θ₀ was estimated from, ∞ if it is exact: an error of θ₀ resembles a change over windows
            as long.
        noise: the statistics without faults.
        bounds: bounds of the change.
    """
    D, s = (np.ascontiguousarray(each.T) for each in (np.einsum("dii->di", sums.J), sums.s))
    early, late = (each.T[:, None, :] for each in (noise.early_v, noise.largest_v))  # (p, 1, lengths)
    glr, residual = np.empty(len(ends)), np.empty(len(ends))
    for first in range(0, len(ends), _TOGETHER):
        part = slice(first, first + _TOGETHER)
        begins = ends[part, None] - noise.lengths
        whole = begins >= max(start, sums.first)
        a, b = np.where(whole, begins, ends[part, None]) - sums.first, ends[part] - sums.first
        largest = np.where(begins < noise.ready, early, late) if start < noise.ready else late
        energy = _explained(D[:, b, None] - D.take(a, axis=1), s[:, b, None] - s.take(a, axis=1), bounds)
        ratio = (energy / largest).max(axis=0, initial=0.0) / (1.0 + noise.lengths / memory)
        excess = (sums.e[b, None] - sums.e[a] - noise.energy) / noise.energy_std
        glr[part] = np.where(whole, ratio, 0.0).max(axis=1, initial=0.0)
        residual[part] = np.where(whole, excess, -np.inf).max(axis=1, initial=-np.inf)
    return glr, residual
