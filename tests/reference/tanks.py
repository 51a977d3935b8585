"""Three-tank system DTS200 and Johansson's quadruple tank as `kalman.Model`s, with any choice of fault channels.

Levels in cm, flows in cm^3/s, areas in cm^2, g = 981 cm/s^2. Below a level (difference) of FLAT the slope of the
square root is that at FLAT; the functions themselves are exact.
"""

from collections.abc import Sequence

import numpy as np

from .kalman import Model

__all__ = ["DTS200_CHANNELS", "QUADRUPLE_CHANNELS", "dts200", "quadruple", "quadruple_steady"]

G, FLAT = 981.0, 1e-6


def torricelli(d: float) -> float:
    """sgn(d) sqrt(2 g |d|)."""
    return float(np.sign(d) * np.sqrt(2 * G * abs(d)))


def torricelli_slope(d: float) -> float:
    """Its derivative."""
    return float(np.sqrt(G / (2 * max(abs(d), FLAT))))


def _assemble(channels: Sequence[str], terms: dict, n: int, m: int, f, h, A0, C, x0) -> Model:
    """A Model with the chosen columns of `terms`: name -> (state column, its x-derivative, output column).

    state column (x, u) -> (n,) and derivative (n, n), or None; output column (m,), or None.
    """
    chosen, p = [terms[name] for name in channels], len(channels)
    Psi = np.array([np.zeros(m) if column is None else column for _, _, column in chosen]).reshape(p, m).T

    def Phi(t: float, x: np.ndarray, u: np.ndarray, s: np.ndarray) -> np.ndarray:
        return np.array([np.zeros(n) if column is None else column(x, u) for column, _, _ in chosen]).reshape(p, n).T

    def A(t: float, x: np.ndarray, u: np.ndarray, s: np.ndarray, theta: np.ndarray) -> np.ndarray:
        slopes = (value * slope(x, u) for value, (_, slope, _) in zip(theta, chosen, strict=True) if slope is not None)
        return A0(x, u) + sum(slopes, np.zeros((n, n)))

    return Model(
        n,
        p,
        m,
        lambda t, x, u, s: f(x, u),
        Phi,
        lambda t, x, u, s: h(x),
        lambda t, x, u, s: Psi,
        A,
        lambda t, x, u, s, theta: C,
        tuple(x0),
    )


# --- DTS200 -----------------------------------------------------------------------------------------------------------

AREA, PIPE = 154.0, 0.5
A1, A2, A3 = 0.46, 0.60, 0.45  # outflow coefficients of the pipes 1-3, 2-out, 3-2

_PATHS = {"13": (0, 2, A1), "32": (2, 1, A3), "20": (1, None, A2)}  # from tank, to tank, coefficient


def _path(path: str, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What the flow through a pipe adds to (h1', h2', h3'), (3,), and its derivative by the levels, (3, 3)."""
    source, target, a = _PATHS[path]
    d = x[source] - (0.0 if target is None else x[target])
    direction, gradient = np.zeros(3), np.zeros(3)
    direction[source], gradient[source] = -1, 1
    if target is not None:
        direction[target], gradient[target] = 1, -1
    scale = a * PIPE / AREA
    return scale * torricelli(d) * direction, scale * torricelli_slope(d) * np.outer(direction, gradient)


def _dts200_terms() -> dict:
    """Channel -> columns. pumpN: relative gain error; flowN: cm^3/s; levelN: cm; leakN: cm^2; clogN: relative loss."""
    unit, terms = np.eye(3), {}
    for i in range(3):
        terms[f"level{i + 1}"] = (None, None, unit[i])
        terms[f"leak{i + 1}"] = (
            lambda x, u, e=unit[i], i=i: -torricelli(x[i]) / AREA * e,
            lambda x, u, e=unit[i], i=i: -torricelli_slope(x[i]) / AREA * np.outer(e, e),
            None,
        )
    for i in range(2):
        terms[f"pump{i + 1}"] = (lambda x, u, e=unit[i], i=i: u[i] / AREA * e, None, None)
        terms[f"flow{i + 1}"] = (lambda x, u, e=unit[i]: e / AREA, None, None)
    for path in _PATHS:
        terms[f"clog{path}"] = (
            lambda x, u, path=path: -_path(path, x)[0],
            lambda x, u, path=path: -_path(path, x)[1],
            None,
        )
    return terms


DTS200_CHANNELS = tuple(_dts200_terms())


def dts200(
    channels: Sequence[str], x0: Sequence[float] = (40.0, 20.0, 30.0), outputs: Sequence[int] = (0, 1, 2)
) -> Model:
    """A h1' = Q1 - Q13, A h2' = Q2 + Q32 - Q20, A h3' = Q13 - Q32; u = (Q1, Q2), y = the levels listed in `outputs`."""
    pick = list(outputs)
    terms = {name: (a, b, None if c is None else c[pick]) for name, (a, b, c) in _dts200_terms().items()}

    def f(x: np.ndarray, u: np.ndarray) -> np.ndarray:
        return np.array([u[0], u[1], 0.0]) / AREA + sum(_path(path, x)[0] for path in _PATHS)

    def A(x: np.ndarray, u: np.ndarray) -> np.ndarray:
        return sum(_path(path, x)[1] for path in _PATHS)

    return _assemble(channels, terms, 3, len(pick), f, lambda x: x[pick], A, np.eye(3)[pick], x0)


# --- Johansson's quadruple tank (IEEE Trans. Control Systems Technology 8(3), 2000), minimum-phase setting ------------

TANK = np.array([28.0, 32.0, 28.0, 32.0])
HOLE = np.array([0.071, 0.057, 0.071, 0.057])
KC = 0.5  # V/cm
PUMP = np.array([3.33, 3.35])  # cm^3/(V s)
GAMMA = np.array([0.70, 0.60])
DRAIN = np.array([[-1.0, 0, 1, 0], [0, -1, 0, 1], [0, 0, -1, 0], [0, 0, 0, -1]])  # outflow of tank j into tank i


def _pump(u: np.ndarray) -> np.ndarray:
    """Contribution of each pump to the level rates, (4, 2)."""
    g, (q1, q2) = GAMMA, PUMP * u
    return np.array([[g[0] * q1, 0], [0, g[1] * q2], [0, (1 - g[1]) * q2], [(1 - g[0]) * q1, 0]]) / TANK[:, None]


def _outflow(x: np.ndarray) -> np.ndarray:
    return HOLE * np.array([torricelli(level) for level in x])


def _quadruple_terms() -> dict:
    """pumpN: relative gain error; levelN: volts; leakN: area, cm^2."""
    terms, unit = {}, np.eye(4)
    for i in range(2):
        terms[f"pump{i + 1}"] = (lambda x, u, i=i: _pump(u)[:, i], None, None)
        terms[f"level{i + 1}"] = (None, None, np.eye(2)[i])
    for i in range(4):
        terms[f"leak{i + 1}"] = (
            lambda x, u, i=i: -torricelli(x[i]) / TANK[i] * unit[i],
            lambda x, u, i=i: -torricelli_slope(x[i]) / TANK[i] * np.outer(unit[i], unit[i]),
            None,
        )
    return terms


QUADRUPLE_CHANNELS = tuple(_quadruple_terms())


def quadruple(channels: Sequence[str], x0: Sequence[float] = (12.4, 12.7, 1.8, 1.4)) -> Model:
    """Johansson's four levels; u = pump voltages (v1, v2), y = kc (h1, h2)."""

    def f(x: np.ndarray, u: np.ndarray) -> np.ndarray:
        return DRAIN @ _outflow(x) / TANK + _pump(u).sum(axis=1)

    def A(x: np.ndarray, u: np.ndarray) -> np.ndarray:
        return DRAIN * HOLE * np.array([torricelli_slope(level) for level in x]) / TANK[:, None]

    return _assemble(channels, _quadruple_terms(), 4, 2, f, lambda x: KC * x[:2], A, KC * np.eye(4)[:2], x0)


def quadruple_steady(v: Sequence[float] = (3.0, 3.0)) -> np.ndarray:
    """Levels (4,) in equilibrium at the pump voltages v."""
    q1, q2 = PUMP * np.asarray(v)
    flows = np.array(
        [
            GAMMA[0] * q1 + (1 - GAMMA[1]) * q2,
            GAMMA[1] * q2 + (1 - GAMMA[0]) * q1,
            (1 - GAMMA[1]) * q2,
            (1 - GAMMA[0]) * q1,
        ]
    )
    return (flows / HOLE) ** 2 / (2 * G)
