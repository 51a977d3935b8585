"""DC motor with load and friction as a `kalman.Model`: states current i (A) and speed w (rad/s), input voltage V.

    L i' = V - R i - ke w
    J w' = kt i - b w - Tc tanh(w / ws) - load        (load torque: the known signal s1)

Channels: 'gain' (relative error of the voltage: coefficient V / L in i'), 'friction' (extra viscous friction,
N m s: -w / J in w'), 'torque' (unknown load torque, N m: -1 / J in w'), 'speed', 'current' (sensor biases).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .kalman import Model

__all__ = ["CHANNELS", "Parameters", "dc_motor"]

CHANNELS = ("gain", "friction", "torque", "speed", "current")


@dataclass(frozen=True)
class Parameters:
    """SI units: resistance, inductance, back-EMF and torque constants, inertia, viscous, Coulomb friction, width."""

    R: float = 1.0
    L: float = 0.01
    ke: float = 0.05
    kt: float = 0.05
    J: float = 5e-4
    b: float = 1e-4
    Tc: float = 0.01
    ws: float = 1.0


def dc_motor(
    channels: Sequence[str],
    q: Parameters = Parameters(),
    outputs: Sequence[str] = ("current", "speed"),
    x0: Sequence[float] = (0.0, 0.0),
) -> Model:
    """The model with the chosen fault channels; y lists `outputs` in their order."""
    order = ("current", "speed")
    C = np.eye(2)[[order.index(name) for name in outputs]]
    Psi = np.array([[float(channel == name) for channel in channels] for name in outputs])

    def f(t: float, x: np.ndarray, u: np.ndarray, s: np.ndarray) -> np.ndarray:
        i, w = x
        friction = q.b * w + q.Tc * np.tanh(w / q.ws)
        return np.array([(u[0] - q.R * i - q.ke * w) / q.L, (q.kt * i - friction - s[0]) / q.J])

    def Phi(t: float, x: np.ndarray, u: np.ndarray, s: np.ndarray) -> np.ndarray:
        columns = {"gain": (u[0] / q.L, 0.0), "friction": (0.0, -x[1] / q.J), "torque": (0.0, -1 / q.J)}
        return np.array([columns.get(channel, (0.0, 0.0)) for channel in channels]).T

    def A(t: float, x: np.ndarray, u: np.ndarray, s: np.ndarray, theta: np.ndarray) -> np.ndarray:
        extra = sum(value for value, channel in zip(theta, channels, strict=True) if channel == "friction")
        slope = q.b + extra + q.Tc / q.ws / np.cosh(x[1] / q.ws) ** 2
        return np.array([[-q.R / q.L, -q.ke / q.L], [q.kt / q.J, -slope / q.J]])

    return Model(
        2,
        len(channels),
        len(outputs),
        f,
        Phi,
        lambda t, x, u, s: C @ x,
        lambda t, x, u, s: Psi,
        A,
        lambda t, x, u, s, theta: C,
        tuple(x0),
    )
