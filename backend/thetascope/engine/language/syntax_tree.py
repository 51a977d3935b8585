"""The tree of a checked expression, and the values of its constants."""

import math
from dataclasses import dataclass
from fractions import Fraction

from thetascope.engine.language.builtins import FUNCTIONS

EXACT = 2**53  # largest integer, numerator or denominator that is kept exactly


@dataclass(frozen=True, slots=True)
class Node:
    """One operation of a checked expression.

    `kind` is number, name, sum, product, power, call, less, less_equal, and, or. `start` and `end` are the half-open
    range of characters in the text. `signs` holds one entry for each argument: of a sum +1 or −1, of a product +1
    (factor) or −1 (divisor). A constant has a `value`, and also `exact` if it is a small integer or a fraction of small
    integers. `degree` bounds the powers that can accumulate in it.
    """

    kind: str
    args: tuple["Node", ...]
    start: int
    end: int
    name: str = ""
    signs: tuple[int, ...] = ()
    value: float | None = None
    exact: Fraction | None = None
    degree: int = 1


def value_of(node: Node) -> float:
    """Return the value of an operation on constants. Raises ValueError or ArithmeticError if it is undefined."""
    values = [arg.value for arg in node.args if arg.value is not None]
    match node.kind:
        case "sum":
            return sum(sign * value for sign, value in zip(node.signs, values, strict=True))
        case "product":
            result = values[0]
            for sign, value in zip(node.signs[1:], values[1:], strict=True):
                result = result * value if sign > 0 else result / value
            return result
        case "power":
            return math.pow(*values)
        case "call":
            return FUNCTIONS[node.name].compute(*values)
        case "less":
            return values[0] < values[1]
        case "less_equal":
            return values[0] <= values[1]
    return all(values) if node.kind == "and" else any(values)


def exact_of(node: Node) -> Fraction | None:
    """Return the value as a fraction if it results from + − · / and integer powers of small integers, else None."""
    parts = [arg.exact for arg in node.args if arg.exact is not None]
    if len(parts) < len(node.args):
        return None
    if node.kind == "sum":
        result = sum((sign * part for sign, part in zip(node.signs, parts, strict=True)), Fraction(0))
    elif node.kind == "product":
        result = Fraction(1)
        for sign, part in zip(node.signs, parts, strict=True):
            result = result * part if sign > 0 else result / part
            if max(abs(result.numerator), result.denominator) > EXACT:
                return None
    elif node.kind == "power" and parts[1].denominator == 1:
        result = parts[0] ** parts[1].numerator
    else:
        return None
    return result if max(abs(result.numerator), result.denominator) <= EXACT else None
