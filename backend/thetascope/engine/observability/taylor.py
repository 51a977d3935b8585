"""A program's graph in power series of time with many digits: derivatives of any order without significant rounding.

Every node becomes its Taylor coefficients, order by order, by the recurrences of automatic differentiation (Griewank &
Walther, Evaluating Derivatives, 2008, ch. 13). Branches are chosen by the value at the expansion point.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from decimal import Context, Decimal, DivisionByZero, InvalidOperation, Overflow, localcontext
from operator import mul

from thetascope.engine.compiler.graph import Equations, Graph, equations, topological
from thetascope.engine.language.lazy_sympy import sympy

DIGITS = 120
ARITHMETIC = Context(prec=DIGITS, traps=[InvalidOperation, DivisionByZero, Overflow])
NO_VALUE = (ArithmeticError, ValueError)  # raised where a function has no value
Coefficients = list[Decimal]

_REFINEMENTS = 5  # 16 digits, each doubles them
_ZERO, _ONE = Decimal(0), Decimal(1)
_FLAT = {"lt", "le", "and", "or", "sign", "floor", "locate"}  # constant wherever they have a derivative


def exact(value: float) -> Decimal:
    """Return the decimal number that a double was written as: 0.3 is three tenths."""
    return Decimal(repr(float(value)))


def precise() -> AbstractContextManager[Context]:
    """Return a context in which decimals have many digits and undefined operations raise."""
    return localcontext(ARITHMETIC)


def convolve(a: Sequence[Decimal], b: Sequence[Decimal], k: int, first: int = 0, last: int | None = None) -> Decimal:
    """Return Σ a_i b_{k−i} over i = first … last (k by default)."""
    last = k if last is None else last
    if last < first:
        return _ZERO
    return sum(map(mul, a[first : last + 1], reversed(b[k - last : k - first + 1])), _ZERO)


class Series:
    """Coefficients of the nodes that ``roots`` need. ``still``: variables that do not depend on time.

    ``at[i]`` holds the coefficients of node i computed so far.
    """

    def __init__(self, graph: Graph, roots: Sequence[int], still: set[str]):
        self.graph, self.order = graph, topological(graph, roots)
        self.at: dict[int, Coefficients] = {i: [] for i in self.order}
        self.beside: dict[
            int, list[Coefficients]
        ] = {}  # the cosine of a sine, the denominator of an arctangent's slope
        self.roots: dict[int, list[Coefficients]] = {}  # of each `solve` node
        self.still: set[int] = set()
        for i in self.order:
            op, *args = graph.nodes[i]
            known = op in ("const", "table", "problem") or (
                args[0] in still if op == "var" else self.still.issuperset(args)
            )
            if known:
                self.still.add(i)
        self.moving = len(self.order) - len(self.still)

    def extend(self, values: Callable[[str, int], Decimal]) -> None:
        """Add one coefficient to every node; ``values(name, k)`` is that of a variable. Raises one of ``NO_VALUE``."""
        for i in self.order:
            op, *args = self.graph.nodes[i]
            mine = self.at[i]
            k = len(mine)
            if op == "var":
                mine.append(values(args[0], k) if not k or i not in self.still else _ZERO)
            elif op == "const":
                mine.append(exact(args[0]) if not k else _ZERO)
            elif op in ("table", "problem", "solve"):
                mine.append(_ZERO)  # only the nodes that use them have values
            elif op == "root":
                mine.append(self._roots(args[0], k)[int(self.graph.nodes[args[1]][1])][k])
            elif op in ("locate", "piece") and not (k and op == "locate"):
                mine.append(self._of_table(op, k, args))
            elif k and (i in self.still or op in _FLAT):
                mine.append(_ZERO)
            else:
                mine.append(_coefficient(self, i, op, k, [self.at[a] for a in args]))

    def _roots(self, solve: int, k: int) -> list[Coefficients]:
        """Return the coefficients of the roots of equations up to order k."""
        problem, *given = self.graph.nodes[solve][1:]
        e = equations(self.graph.nodes[problem][1])
        z = self.roots.setdefault(solve, [[] for _ in e.g])
        if len(z[0]) == k:
            known = {f"a.{i}": self.at[a] for i, a in enumerate(given)} | {f"z.{j}": c for j, c in enumerate(z)}
            next_ = _roots_of_order_k(e, known, k) if k else _roots_at_point(e, known)
            for coefficients, value in zip(z, next_, strict=True):
                coefficients.append(value)
        return z

    def _of_table(self, op: str, k: int, args: Sequence[int]) -> Decimal:
        """Return a coefficient of the index of a piece, or of a piece."""
        x, rows = self.at[args[0]], self.graph.nodes[args[-1]][1]
        if op == "locate":
            return Decimal(sum(1 for point in rows if exact(point) <= x[0]))
        origin, *factors = (exact(v) for v in rows[int(self.at[args[1]][0])])
        s = [x[0] - origin, *x[1 : k + 1]]
        total = [_ZERO] * (k + 1)
        for c in reversed(factors):
            total = [convolve(total, s, j) for j in range(k + 1)]
            total[0] += c
        return total[k]

    def companions(self, i: int, count: int) -> list[Coefficients]:
        """Return the series that accompany a node, such as the cosine of a sine; empty at first."""
        return self.beside.setdefault(i, [[] for _ in range(count)])


def _roots_at_point(e: Equations, known: Mapping[str, Coefficients]) -> list[Decimal]:
    """Return the roots at a point: those in double precision, refined by Newton's method."""
    z = [Decimal(float(v)) for v in e.solved([float(known[f"a.{i}"][0]) for i in range(len(e.G[0]))])]
    for _ in range(_REFINEMENTS):
        point = dict(known) | {f"z.{j}": [v] for j, v in enumerate(z)}
        step = Series(e.graph, e.step, set())
        step.extend(lambda name, k, point=point: point[name][k])
        z = [v - step.at[i][0] for v, i in zip(z, e.step, strict=True)]
    if not all(v.is_finite() for v in z):
        raise ValueError("the equations have no solution that is found")
    return z


def _roots_of_order_k(e: Equations, known: Mapping[str, Coefficients], k: int) -> list[Decimal]:
    """Return the k-th coefficients of the roots: −J⁻¹ times that of g with zeros in their place."""
    padded = {name: [*c, _ZERO] if name.startswith("z.") else c for name, c in known.items()}
    series = Series(e.graph, [*e.g, *(i for row in e.J for i in row)], set())
    for _ in range(k + 1):
        series.extend(lambda name, order: padded[name][order])
    rows = [[*(series.at[i][0] for i in row), -series.at[g][k]] for row, g in zip(e.J, e.g, strict=True)]
    for j in range(len(rows)):
        pivot = max(range(j, len(rows)), key=lambda i: abs(rows[i][j]))
        rows[j], rows[pivot] = rows[pivot], rows[j]
        rows[j] = [v / rows[j][j] for v in rows[j]]
        rows = [
            row if i == j else [v - row[j] * w for v, w in zip(row, rows[j], strict=True)] for i, row in enumerate(rows)
        ]
    return [row[-1] for row in rows]


def _coefficient(s: Series, i: int, op: str, k: int, a: list[Coefficients]) -> Decimal:
    if op in _SIMPLE:
        return _SIMPLE[op](k, *a)
    if op in _CHOICES:
        return a[_CHOICES[op](*(arg[0] for arg in a))][k]
    if op in _RECURSIVE:
        return _RECURSIVE[op](s, i, k, s.at[i], *a)
    if k == 0:
        return _flat(op, *(arg[0] for arg in a))
    raise ValueError(f"no series for {op}")


def _flat(op: str, *a: Decimal) -> Decimal:
    match op:
        case "lt":
            return _ONE if a[0] < a[1] else _ZERO
        case "le":
            return _ONE if a[0] <= a[1] else _ZERO
        case "and":
            return _ONE if a[0] and a[1] else _ZERO
        case "or":
            return _ONE if a[0] or a[1] else _ZERO
        case "sign":
            return Decimal((a[0] > 0) - (a[0] < 0))
        case "floor":
            return a[0].to_integral_value(rounding="ROUND_FLOOR")
    raise ValueError(f"no series for {op}")


_SIMPLE: Mapping[str, Callable[..., Decimal]] = {
    "add": lambda k, a, b: a[k] + b[k],
    "sub": lambda k, a, b: a[k] - b[k],
    "neg": lambda k, a: -a[k],
    "mul": lambda k, a, b: convolve(a, b, k),
    "fma": lambda k, a, b, c: convolve(a, b, k) + c[k],
    "abs": lambda k, a: a[k] if a[0] >= 0 else -a[k],
}
_CHOICES: Mapping[str, Callable[..., int]] = {
    "min": lambda a, b: 1 if b < a else 0,
    "max": lambda a, b: 1 if b > a else 0,
    "where": lambda c, a, b: 1 if c != 0 else 2,
}


def _quotient(s: Series, i: int, k: int, c: Coefficients, a: Coefficients, b: Coefficients) -> Decimal:
    return (a[k] - convolve(c, b, k, 0, k - 1)) / b[0]


def _root(s: Series, i: int, k: int, c: Coefficients, a: Coefficients) -> Decimal:
    return a[0].sqrt() if not k else (a[k] - convolve(c, c, k, 1, k - 1)) / (2 * c[0])


def _exponential(s: Series, i: int, k: int, c: Coefficients, a: Coefficients) -> Decimal:
    return a[0].exp() if not k else convolve(_slopes(a, k), c, k, 1) / k


def _logarithm(s: Series, i: int, k: int, c: Coefficients, a: Coefficients) -> Decimal:
    if not k:
        if a[0] <= 0:
            raise ValueError("log of what is not positive")
        return a[0].ln()
    return (a[k] - convolve(_slopes(c, k - 1), a, k, 1, k - 1) / k) / a[0]


def _power(s: Series, i: int, k: int, c: Coefficients, a: Coefficients, b: Coefficients) -> Decimal:
    """Return exp(b log a), for positive a."""
    log, product = s.companions(i, 2)
    log.append(_logarithm(s, i, k, log, a))
    product.append(convolve(b, log, k))
    return _exponential(s, i, k, c, product)


def _signed_power(s: Series, i: int, k: int, c: Coefficients, a: Coefficients, b: Coefficients) -> Decimal:
    if a[0] > 0:
        return _power(s, i, k, c, a, b)
    return -_power(s, i, k, [-v for v in c], [-v for v in a], b)


def _slopes(a: Coefficients, k: int) -> Coefficients:
    """Return i·a_i for i up to k."""
    return [j * v for j, v in enumerate(a[: k + 1])]


def _circular(name: str, sign: int) -> Callable[..., Decimal]:
    """Return the recurrence of sine and cosine (sign −1) or of sinh and cosh (sign 1), each by the other."""
    sine = name in ("sin", "sinh")
    other = {"sin": "cos", "cos": "sin", "sinh": "cosh", "cosh": "sinh"}[name]

    def coefficient(s: Series, i: int, k: int, c: Coefficients, a: Coefficients) -> Decimal:
        (beside,) = s.companions(i, 1)
        if not k:
            beside.append(_known(other, a[0]))
            return _known(name, a[0])
        slopes = _slopes(a, k)
        mine, its = convolve(slopes, beside, k, 1) / k, convolve(slopes, c, k, 1) / k
        beside.append(sign * its if sine else its)
        return mine if sine else sign * mine

    return coefficient


def _tangent(name: str, sign: int) -> Callable[..., Decimal]:
    """Return the recurrence c' = (1 ± c²) a'."""

    def coefficient(s: Series, i: int, k: int, c: Coefficients, a: Coefficients) -> Decimal:
        (square,) = s.companions(i, 1)
        value = _known(name, a[0]) if not k else convolve(_slopes(a, k), square, k, 1) / k
        whole = [*c, value]
        square.append((not k) + sign * convolve(whole, whole, k))
        return value

    return coefficient


def _inverse(name: str) -> Callable[..., Decimal]:
    """Return the recurrence c' = a'/w: w = 1 + a² of the arctangent, ±√(1 − a²) of arcsine and arccosine."""

    def coefficient(s: Series, i: int, k: int, c: Coefficients, a: Coefficients) -> Decimal:
        inner, w = s.companions(i, 2)
        square = convolve(a, a, k)
        inner.append((not k) + square if name == "atan" else (not k) - square)
        root = inner[k] if name == "atan" else _root(s, i, k, [-v for v in w] if name == "acos" else w, inner)
        w.append(-root if name == "acos" else root)
        if not k:
            return _known(name, a[0])
        return (k * a[k] - convolve(_slopes(c, k - 1), w, k, 1, k - 1)) / (k * w[0])

    return coefficient


def _angle(s: Series, i: int, k: int, c: Coefficients, y: Coefficients, x: Coefficients) -> Decimal:
    """Return a coefficient of atan2(y, x): (x² + y²) c' = x y' − y x'."""
    (w,) = s.companions(i, 1)
    w.append(convolve(x, x, k) + convolve(y, y, k))
    if not k:
        return _known("atan2", y[0], x[0])
    turned = convolve(_slopes(y, k), x, k, 1) - convolve(_slopes(x, k), y, k, 1)
    return (turned - convolve(_slopes(c, k - 1), w, k, 1, k - 1)) / (k * w[0])


_RECURSIVE: Mapping[str, Callable[..., Decimal]] = {
    "div": _quotient,
    "sqrt": _root,
    "exp": _exponential,
    "log": _logarithm,
    "pow": _power,
    "spow": _signed_power,
    "atan2": _angle,
    **{name: _circular(name, -1) for name in ("sin", "cos")},
    **{name: _circular(name, 1) for name in ("sinh", "cosh")},
    "tan": _tangent("tan", 1),
    "tanh": _tangent("tanh", -1),
    **{name: _inverse(name) for name in ("asin", "acos", "atan")},
}


def _known(name: str, *a: Decimal) -> Decimal:
    """Return a function of a number, by SymPy's arithmetic of many digits."""
    value = getattr(sympy, name)(*(sympy.Float(str(v), DIGITS) for v in a))
    if not value.is_real:
        raise ValueError(f"{name} has no real value there")
    return Decimal(sympy.sstr(sympy.Float(value, DIGITS), full_prec=True))
