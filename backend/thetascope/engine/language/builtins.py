"""The functions of the expression language: how many arguments each takes, and its value at numbers."""

import math
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LanguageFunction:
    """One function: least and most arguments (None: any number), and its value at floats.

    `compute` raises ValueError or ArithmeticError outside its domain.
    """

    least: int
    most: int | None
    compute: Callable[..., float]


def sign(x: float) -> int:
    """1, 0 or −1."""
    return (x > 0) - (x < 0)


def step(x: float) -> float:
    """1 from x = 0 on, 0 before."""
    return float(x >= 0)


def clip(x: float, low: float, high: float) -> float:
    """x, held within [low, high]."""
    if low > high:
        raise ValueError("the lower limit of clip is above the upper one")
    return min(max(x, low), high)


def signed_power(x: float, a: float) -> float:
    """|x|^a sign x."""
    return abs(x) ** a * sign(x)


def backlash(x: float, dx: float, z: float, m1: float, m2: float, D1: float, D2: float) -> float:
    """Play operator, Zhou & Tan 2012 (6)–(9): the next z from x, Δx = x(k) − x(k−1) and z(k−1)."""
    if x > z / m1 + D1 and dx > 0:
        return m1 * (x - D1)
    return m2 * (x + D2) if x < z / m2 - D2 and dx < 0 else z


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
}
