"""An independent simulation of a level under PI control: SciPy's solve_ivp from one discontinuity to the next.

h' = q − c √h,   y = h + bias + noise,   v = Kp (r − y) + Ki e + 0.5,   q = v limited to [0, 2]
e' = r − y (continuous), or e⁺ = e + T (r − y) at the instants j·T, between which q is held
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

KP, KI, OUTLET = 2.0, 0.5, 0.5


@dataclass
class Case:
    """One experiment; ``period`` of the controller and ``sampling`` of the measurement are in s, None: continuous."""

    period: float | None = None
    sampling: float | None = None
    fault: dict | None = None
    bias: tuple[float, float] = (np.inf, 0.0)  # onset, size
    leak: tuple[float, float] = (np.inf, 0.0)
    hold: float = 0.5  # of the noise and of lost samples
    draws: np.ndarray | None = None  # of the noise
    lost: np.ndarray | None = None  # of the dropout, by its draws


@dataclass
class Path:
    """The solution: true level, reading, applied input and integral at the given times (right limits)."""

    h: np.ndarray
    y: np.ndarray
    q: np.ndarray
    e: np.ndarray


def _limited(v: float) -> float:
    return min(max(v, 0.0), 2.0)


class _Reference:
    def __init__(self, case: Case, r: Callable[[float], float], end: float):
        self.case, self.r, self.end = case, r, end
        self.pieces: list[tuple[float, float, Callable]] = []  # begin, end, noisy output within
        self.frozen = self.sampled = np.nan

    def noise(self, middle: float) -> float:
        return 0.0 if self.case.draws is None else float(self.case.draws[int(middle / self.case.hold)])

    def noisy(self, middle: float) -> Callable[[float], float]:
        onset, size = self.case.bias
        shift = self.noise(middle) + (size if middle > onset else 0.0)
        return lambda h: h + shift

    def acts(self, middle: float) -> bool:
        fault = self.case.fault
        if fault is None or not fault["onset"] < middle < (fault.get("end") or np.inf):
            return False
        return fault["shape"] != "dropout" or bool(self.case.lost[int((middle - fault["onset"]) / self.case.hold)])

    def earlier(self, t: float) -> float:
        """Return the noisy output at a time in the past, and at the onset of the delay if it is before that."""
        onset = self.case.fault["onset"]
        t = max(t, onset + 1e-12)
        begin, end, of = next(p for p in reversed(self.pieces) if p[0] - 1e-9 <= t)
        return of(min(max(t, begin), end))

    def reading(self, middle: float) -> Callable[[float, float], float]:
        """Return the reading as a function of (t, h) in the piece with this middle."""
        noisy, fault = self.noisy(middle), self.case.fault
        if not self.acts(middle):
            return lambda t, h: noisy(h)
        match fault["shape"]:
            case "stuck":
                return lambda t, h: fault["value"]
            case "quantisation":
                return lambda t, h: fault["resolution"] * np.floor(noisy(h) / fault["resolution"] + 0.5)
            case "delay":
                first = not any(p[0] >= fault["onset"] - 1e-9 for p in self.pieces)
                return lambda t, h: noisy(self.first) if first else self.earlier(t - fault["delay"])
        if np.isnan(self.frozen):  # nothing was read before
            self.frozen = noisy(self.first)
        frozen = self.frozen
        return lambda t, h: frozen

    def edges(self) -> np.ndarray:
        case = self.case
        parts = [np.array([0.0, self.end, case.bias[0], case.leak[0], 10.0])]
        parts += [np.arange(0.0, self.end, p) for p in (case.period, case.sampling, case.hold) if p is not None]
        if case.fault is not None:
            onset, stop = case.fault["onset"], case.fault.get("end") or self.end
            parts.append(np.array([onset, stop]))
            if case.fault["shape"] == "dropout":
                parts.append(np.arange(onset, stop, case.hold))
            if case.fault["shape"] == "delay":
                parts.append(np.arange(onset, stop, case.fault["delay"]))  # so that a piece reads earlier ones only
                late = np.concatenate(parts) + case.fault["delay"]
                parts.append(late)
        edges = np.unique(np.concatenate(parts).round(9))
        return edges[edges <= self.end]

    def solve(self, times: np.ndarray) -> Path:
        case, rows = self.case, []
        h, e, q = 1.0, 0.0, 0.5
        edges = self.edges()
        for a, b in zip(edges[:-1], edges[1:], strict=True):
            middle = 0.5 * (a + b)
            self.first, r = h, self.r(middle)
            faulty = self.reading(middle)
            if case.sampling is not None:
                if _on(a, case.sampling):
                    self.sampled = faulty(a, h)
                held = self.sampled
                read = lambda t, h, held=held: held  # noqa: E731
            else:
                read = faulty
            if case.period is not None and _on(a, case.period):
                y = read(a, h)
                q = _limited(KP * (r - y) + KI * e + 0.5)
                e = e + case.period * (r - y)
            leak = case.leak[1] if middle > case.leak[0] else 0.0

            def law(t: float, h: float, e: float, read=read, q=q, r=r) -> float:
                return q if case.period is not None else _limited(KP * (r - read(t, h)) + KI * e + 0.5)

            def slope(t: float, z: np.ndarray, law=law, read=read, r=r, leak=leak) -> list[float]:
                still = case.period is not None
                return [law(t, z[0], z[1]) - (OUTLET + leak) * np.sqrt(z[0]), 0.0 if still else r - read(t, z[0])]

            solution = solve_ivp(slope, (a, b), [h, e], "DOP853", rtol=1e-9, atol=1e-11, dense_output=True)
            path, noisy = solution.sol, self.noisy(middle)
            for t in times[(times >= a - 1e-9) & (times < b - 1e-9)]:
                z = path(t)
                rows.append((z[0], read(t, z[0]), law(t, z[0], z[1]), z[1]))
            h, e = (float(v) for v in solution.y[:, -1])
            if not self.acts(middle):
                self.frozen = noisy(h)
            self.pieces.append((a, b, lambda t, path=path, noisy=noisy: noisy(path(t)[0])))
        return Path(*np.array(rows).T)


def _on(t: float, period: float) -> bool:
    return abs(t / period - round(t / period)) < 1e-6


def solve(case: Case, r: Callable[[float], float], times: np.ndarray, end: float) -> Path:
    """Return the solution at times, which are at least 0 and less than the end."""
    return _Reference(case, r, end).solve(times)
