"""Sums of evidence, and what they say over windows that end now: the part that batch and live share, row for row.

Evidence is a regression x(k) = Ω(k) (θ − θ₀) + noise of variance one, θ₀ being what is known so far (zero: no fault). Its
sums J = Σ ΩᵀΩ, s = Σ Ωᵀx, q = Σ xᵀx are kept at *decisions*, every so many rows. Over a window of decisions the generalised
likelihood ratio of "θ_j has changed by something" against "nothing has" is, for each channel j,

    GLR_j = max over δ within bounds of (2 s_j δ − J_jj δ²) / v_j,    s_j²/(J_jj v_j) where no bound forbids it,

v_j being the variance of s_j/√J_jj that simulation shows without faults: one, were the noise white and the filter exact. It may
be several times larger where inputs have just switched than on the average, and tests go by the largest.

Willsky & Jones, IEEE TAC 21(1), 1976; Basseville & Nikiforov, Detection of Abrupt Changes, 1993, §2.4.3 and ch. 7.
Windows have a few lengths, each a third longer than the one before: Lai, JRSS B 57(4), 1995, shows that this loses little.
"""

from dataclasses import dataclass, replace

import numpy as np

LONGEST = 600  # decisions
GROWTH = 1.35  # of the lengths of windows


@dataclass(frozen=True)
class WindowSums:
    """Sums at decisions ``first``, ``first`` + 1, …: J (decisions, p, p), s (decisions, p), q (decisions, m) by output.

    J, s and ``e`` (decisions), the sum of q, are of the outputs that were heeded; q is of all. ``repeats`` (decisions, m), not
    a sum: rows for which each output has been showing the very same number.
    """

    first: int
    J: np.ndarray
    s: np.ndarray
    q: np.ndarray
    e: np.ndarray
    repeats: np.ndarray

    @classmethod
    def empty(cls, p: int, m: int) -> "WindowSums":
        """Before anything was seen: decision 0 stands for sums of nothing."""
        return cls(0, np.zeros((1, p, p)), np.zeros((1, p)), np.zeros((1, m)), np.zeros(1), np.zeros((1, m)))

    @property
    def last(self) -> int:
        """The number of the latest decision."""
        return self.first + len(self.q) - 1

    def extended(
        self, omega: np.ndarray, x: np.ndarray, trusted_outputs: np.ndarray | None = None, y: np.ndarray | None = None
    ) -> "WindowSums":
        """With more decisions: ``omega`` (decisions, rows in each, m, p) and ``x`` (decisions, rows in each, m).

        ``y``: what was measured (rows, m), the row before them first; without it nothing stands still.
        """
        q = np.einsum("drm,drm->dm", x, x)
        repeats = np.zeros_like(q) if y is None else _repeats(self.repeats[-1], y)[x.shape[1] - 1 :: x.shape[1]]
        if trusted_outputs is not None and not trusted_outputs.all():
            omega, x = omega * trusted_outputs[:, None], x * trusted_outputs
        J, s, e = (
            np.einsum("drmi,drmj->dij", omega, omega),
            np.einsum("drmi,drm->di", omega, x),
            np.einsum("drm,drm->d", x, x),
        )
        # added one after the other, so that cutting a run into pieces changes no bit
        new = {n: _added(getattr(self, n)[-1:], v) for n, v in {"J": J, "s": s, "q": q, "e": e}.items()} | {
            "repeats": repeats
        }
        return replace(self, **{n: np.concatenate([getattr(self, n), v]) for n, v in new.items()})

    def until(self, decision: int) -> "WindowSums":
        """As they were at a decision."""
        return self._cut(slice(None, decision - self.first + 1))

    def recent(self, keep: int) -> "WindowSums":
        """Without decisions that no window needs."""
        cut = max(0, len(self.q) - keep)
        return self if cut == 0 else replace(self._cut(slice(cut, None)), first=self.first + cut)

    def _cut(self, part: slice) -> "WindowSums":
        return replace(self, **{n: getattr(self, n)[part] for n in ("J", "s", "q", "e", "repeats")})

    def over(self, begin: np.ndarray | int, end: np.ndarray | int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """J, s, e of what came after decision ``begin``, up to ``end``."""
        a, b = np.asarray(begin) - self.first, np.asarray(end) - self.first
        return self.J[b] - self.J[a], self.s[b] - self.s[a], self.e[b] - self.e[a]


def _added(last: np.ndarray, new: np.ndarray) -> np.ndarray:
    return np.cumsum(np.concatenate([last, new]), axis=0)[1:]


def _repeats(before: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Rows for which y has not changed, counted on from ``before``: rows − 1, m."""
    same = y[1:] == y[:-1]
    count = np.cumsum(same, axis=0)
    since = np.maximum.accumulate(np.where(same, 0, count), axis=0)
    carried = np.where(np.logical_and.accumulate(same, axis=0), before, 0.0)
    return count - since + carried


def lengths(most: int) -> np.ndarray:
    """Lengths of windows, in decisions: 1, 2, 3, 4, 5, 7, … up to ``most``."""
    found, length = [], 1.0
    while length <= min(most, LONGEST):
        found.append(int(length))
        length = max(length + 1, length * GROWTH)
    return np.array(found)


@dataclass(frozen=True)
class WindowNoise:
    """What windows look like without a fault, simulated: for each length the variance v of s_j/√J_jj (lengths × p), and
    mean and standard deviation of the residual energy q. ``largest_v``: v where in the run it is largest, which tests go by;
    ``early_v``: the same of windows that begin before decision ``ready``, when the filter is not yet sure of its state."""

    lengths: np.ndarray
    v: np.ndarray
    largest_v: np.ndarray
    early_v: np.ndarray
    ready: int
    energy: np.ndarray
    energy_std: np.ndarray

    def nearest(self, length: np.ndarray | int) -> np.ndarray:
        """Index of the longest simulated length that is not longer (at least the first)."""
        return np.maximum(np.searchsorted(self.lengths, length, side="right") - 1, 0)

    def expected_energy(self, length: int, trusted_outputs: np.ndarray) -> tuple[float, float]:
        """Energy that noise has over so many decisions in the outputs heeded, and its standard deviation."""
        k = int(self.nearest(length))
        share = float(np.mean(trusted_outputs)) * length / self.lengths[k]
        return float(self.energy[k]) * share, float(self.energy_std[k]) * share**0.5


@dataclass(frozen=True)
class ThetaBounds:
    """Bounds (p) within which θ makes sense, ±∞ where there are none."""

    low: np.ndarray
    high: np.ndarray

    def relative_to(self, known: np.ndarray) -> "ThetaBounds":
        """Bounds of what θ may be besides what is known."""
        return ThetaBounds(np.minimum(self.low - known, 0.0), np.maximum(self.high - known, 0.0))


def sizes(D: np.ndarray, s: np.ndarray, bounds: ThetaBounds) -> np.ndarray:
    """The most likely θ_j of each channel alone, s_j/J_jj, within bounds; ``D``: the diagonal of J (zero: not seen)."""
    seen = D > 1e-12 * np.max(D, axis=-1, keepdims=True, initial=1e-300)
    return np.clip(np.where(seen, s / np.where(seen, D, 1.0), 0.0), bounds.low, bounds.high)


def explained(D: np.ndarray, s: np.ndarray, bounds: ThetaBounds) -> np.ndarray:
    """The energy that each channel alone explains: s_j²/J_jj, less where bounds forbid the best θ_j."""
    size = sizes(D, s, bounds)
    return np.maximum((2 * s - size * D) * size, 0.0)


def scan(
    sums: WindowSums, ends: np.ndarray, start: int, memory: float, noise: WindowNoise, bounds: ThetaBounds
) -> tuple[np.ndarray, np.ndarray]:
    """At each decision of ``ends`` the largest GLR over windows and channels, and the largest residual, over its windows.

    Windows begin at ``start`` or later. ``memory``: decisions from which θ₀ was estimated (inf: it is exact), since an
    error of θ₀ looks like a change over windows as long.
    """
    begins = ends[:, None] - noise.lengths[None, :]
    whole = begins >= max(start, sums.first)
    a, b = np.where(whole, begins, ends[:, None]) - sums.first, ends[:, None] - sums.first
    D = np.einsum("dii->di", sums.J)
    q = sums.e[b] - sums.e[a]
    loud = (
        np.where((begins < noise.ready)[:, :, None], noise.early_v, noise.largest_v)
        if start < noise.ready
        else noise.largest_v
    )
    glr = (explained(D[b] - D[a], sums.s[b] - sums.s[a], bounds) / loud).max(axis=-1, initial=0.0) / (
        1.0 + noise.lengths / memory
    )
    excess = (q - noise.energy) / noise.energy_std
    return np.where(whole, glr, 0.0).max(axis=1, initial=0.0), np.where(whole, excess, -np.inf).max(
        axis=1, initial=-np.inf
    )
