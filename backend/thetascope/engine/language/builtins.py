"""The functions of the expression language: number of arguments and numerical value of each."""

import math
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LanguageFunction:
    """A function: minimum and maximum number of arguments (None: unlimited), and its evaluation with floats.

    `compute` raises ValueError or ArithmeticError outside the function's domain.
    """

    least: int
    most: int | None
    compute: Callable[..., float]


def sign(x: float) -> int:
    """Return the sign of x: 1, 0 or −1."""
    return (x > 0) - (x < 0)


def step(x: float) -> float:
    """Return 1 for x ≥ 0, otherwise 0."""
    return float(x >= 0)


def clip(x: float, low: float, high: float) -> float:
    """Return x limited to [low, high]. Raises ValueError if low > high."""
    if low > high:
        raise ValueError("the lower limit of clip is above the upper one")
    return min(max(x, low), high)


def signed_power(x: float, a: float) -> float:
    """Return |x|^a · sign(x)."""
    return abs(x) ** a * sign(x)


REST = 1e-12  # of x and the widths of a play operator: a Δx below it counts as zero


def backlash(x: float, dx: float, z: float, m1: float, m2: float, D1: float, D2: float) -> float:
    """Return z(k) of the play operator, Zhou & Tan 2012 (6)–(9), from x(k), Δx = x(k) − x(k−1) and z(k−1).

    A Δx within the rounding of x counts as zero: where z is an estimate far from x, the operator jumps there.
    """
    still = REST * (abs(x) + abs(D1) + abs(D2))
    if x > z / m1 + D1 and dx > still:
        return m1 * (x - D1)
    return m2 * (x + D2) if x < z / m2 - D2 and dx < -still else z


def dead_zone(x: float, d: float) -> float:
    """Return 0 within ±d, and the way beyond. Raises ValueError for d < 0."""
    return x - clip(x, -d, d)


def play(x: float, z: float, d: float) -> float:
    """Return the next z of a play of half width d, dragged by x. Raises ValueError for d < 0."""
    return clip(z, x - d, x + d)


def saturated_play(x: float, z: float, d: float, limit: float) -> float:
    """Return a play limited to ±limit; its z goes on inside. Raises ValueError for d < 0 or limit < 0."""
    return clip(play(x, z, d), -limit, limit)


def bouc_wen(v: float, z: float, A: float, beta: float, gamma: float, n: float) -> float:
    """Return the rate of the hysteretic state z of Bouc and Wen at the velocity v, Wen 1976, J. Eng. Mech. 102(2):

    A v − β |v| |z|^(n − 1) z − γ v |z|^n.
    """
    return A * v - beta * abs(v) * signed_power(z, n) - gamma * v * abs(z) ** n


def _one(compute: Callable[[float], float]) -> LanguageFunction:
    return LanguageFunction(1, 1, compute)


FUNCTIONS: dict[str, LanguageFunction] = {
    "sin": _one(math.sin),
    "cos": _one(math.cos),
    "tan": _one(math.tan),
    "asin": _one(math.asin),
    "acos": _one(math.acos),
    "atan": _one(math.atan),
    "atan2": LanguageFunction(2, 2, math.atan2),
    "sinh": _one(math.sinh),
    "cosh": _one(math.cosh),
    "tanh": _one(math.tanh),
    "exp": _one(math.exp),
    "log": _one(math.log),
    "sqrt": _one(math.sqrt),
    "abs": _one(abs),
    "sign": _one(sign),
    "min": LanguageFunction(2, None, min),
    "max": LanguageFunction(2, None, max),
    "clip": LanguageFunction(3, 3, clip),
    "heaviside": _one(step),
    "step": _one(step),
    "floor": _one(lambda x: float(math.floor(x))),
    "where": LanguageFunction(3, 3, lambda condition, a, b: a if condition else b),
    "spow": LanguageFunction(2, 2, signed_power),
    "backlash": LanguageFunction(7, 7, backlash),
    "deadzone": LanguageFunction(2, 2, dead_zone),
    "play": LanguageFunction(3, 3, play),
    "satplay": LanguageFunction(4, 4, saturated_play),
    "boucwen": LanguageFunction(6, 6, bouc_wen),
    "interp": LanguageFunction(2, 2, lambda x, table: table.value(x)),
}
