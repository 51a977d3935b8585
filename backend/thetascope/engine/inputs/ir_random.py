"""Random number generator as LLVM IR: Threefry-2x64 with 20 rounds, and normal numbers by the Box–Muller transform.

Salmon, Moraes, Dror & Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011. Word pair c of a stream is a
function of (key, c) alone. All operations are on integers, + − × ÷, √ or multiply-adds, on vectors of eight, so that
the numbers are the same on every processor; log, sin and cos are the polynomials of fdlibm (Sun Microsystems, 1993),
accurate to one or two units in the last place.

    uniform(i64 k0, i64 k1, i64 first, i64 blocks, out)            16 numbers per block, from pair `first` on
    normal(i64 k0, i64 k1, i64 first, i64 blocks, out)             the same, standard normal
    normal_lanes(k0*, k1*, i64 first, i64 pairs, out, i64 width)   eight streams: number j of each stream in row j
"""

import math
import struct
from collections.abc import Callable

ROTATIONS = (16, 42, 12, 31, 16, 32, 24, 21)
PARITY = 0x1BD11BDAA9FC1A22
ROUNDS = 20
BLOCK = 16  # numbers per block: eight pairs
_I, _D = "<8 x i64>", "<8 x double>"
_ONE = 0x3FF0000000000000  # bits of 1.0
_ROOT_HALF = 0x3FE6A09E667F3BCD  # bits of √½
_SHIFTER = 0x4338000000000000  # bits of 1.5·2⁵²: adding to them turns a small integer into a double
_LOG = (
    6.666666666666735130e-01,
    3.999999999940941908e-01,
    2.857142874366239149e-01,
    2.222219843214978396e-01,
    1.818357216161805012e-01,
    1.531383769920937332e-01,
    1.479819860511658591e-01,
)
_LN2_HIGH, _LN2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10
_SIN = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
_COS = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)


class _Text:
    """Writer of instructions on vectors of eight. A method that computes a value returns the value's name."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def let(self, text: str) -> str:
        name = f"%v{len(self.lines)}"
        self.lines.append(f"  {name} = {text}")
        return name

    def put(self, text: str) -> None:
        self.lines.append("  " + text)

    def op(self, op: str, a: str, b: str) -> str:
        return self.let(f"{op} {_D if op[0] == 'f' else _I} {a}, {b}")

    def call(self, name: str, *args: str) -> str:
        return self.let(f"call {_D} @llvm.{name}.v8f64(" + ", ".join(f"{_D} {a}" for a in args) + ")")

    def fma(self, a: str, b: str, c: str) -> str:
        return self.call("fma", a, b, c)

    def cast(self, value: str, to: str) -> str:
        return self.let(f"bitcast {_D if to == _I else _I} {value} to {to}")

    def splat(self, scalar: str) -> str:
        one = self.let(f"insertelement {_I} poison, i64 {scalar}, i32 0")
        return self.let(f"shufflevector {_I} {one}, {_I} poison, <8 x i32> zeroinitializer")

    def polynomial(self, x: str, coefficients: tuple[float, ...]) -> str:
        """Evaluate a polynomial by Horner's rule, coefficients from the constant one on."""
        result = _real(coefficients[-1])
        for c in reversed(coefficients[:-1]):
            result = self.fma(result, x, _real(c))
        return result


def _whole(value: int) -> str:
    """Return a vector of eight equal integers."""
    return "<" + ", ".join([f"i64 {value}"] * 8) + ">"


def _real(value: float) -> str:
    """Return a vector of eight equal doubles."""
    return "<" + ", ".join([f"double 0x{struct.pack('>d', value).hex().upper()}"] * 8) + ">"


def _words(w: _Text, k0: str, k1: str, counter: str) -> tuple[str, str]:
    """Return both words of Threefry-2x64 for the counter (counter, 0) and the key (k0, k1)."""
    keys = (k0, k1, w.op("xor", w.op("xor", k0, k1), _whole(PARITY)))
    x0, x1 = w.op("add", counter, k0), k1
    for i in range(ROUNDS):
        x0 = w.op("add", x0, x1)
        turned = w.let(f"call {_I} @llvm.fshl.v8i64({_I} {x1}, {_I} {x1}, {_I} {_whole(ROTATIONS[i % 8])})")
        x1 = w.op("xor", turned, x0)
        if i % 4 == 3:
            s = (i + 1) // 4
            x0 = w.op("add", x0, keys[s % 3])
            x1 = w.op("add", x1, w.op("add", keys[(s + 1) % 3], _whole(s)))
    return x0, x1


def _from_one(w: _Text, word: str) -> str:
    """Return the upper 52 bits of a word as a number in [1, 2)."""
    return w.cast(w.op("or", w.op("lshr", word, _whole(12)), _whole(_ONE)), _D)


def _uniforms(w: _Text, x0: str, x1: str) -> tuple[str, str]:
    """Return two numbers in [0, 1), multiples of 2⁻⁵², from two words."""
    return w.op("fsub", _from_one(w, x0), _real(1.0)), w.op("fsub", _from_one(w, x1), _real(1.0))


def _normals(w: _Text, x0: str, x1: str) -> tuple[str, str]:
    """Return √(−2 ln u)·(cos, sin) of a random angle (Box and Muller): one within ±45°, then a random quarter turn."""
    u = w.op("fsub", _from_one(w, x0), _real(1.0 - 2.0**-53))  # odd multiples of 2⁻⁵³: neither 0 nor 1
    radius = w.call("sqrt", w.op("fmul", _log(w, u), _real(-2.0)))
    angle = w.op("fmul", w.op("fsub", _from_one(w, x1), _real(1.5)), _real(math.pi / 2))
    square = w.op("fmul", angle, angle)
    sine = w.fma(w.op("fmul", angle, square), w.polynomial(square, _SIN), angle)
    half = w.fma(square, _real(-0.5), _real(1.0))
    cosine = w.fma(w.op("fmul", square, square), w.polynomial(square, _COS), half)
    aside = w.let(f"icmp ne {_I} {w.op('and', x1, _whole(1))}, zeroinitializer")
    sign = w.op("and", w.op("shl", x1, _whole(62)), _whole(-(1 << 63)))
    pair = []
    for straight, turned in ((cosine, sine), (sine, cosine)):
        part = w.let(f"select <8 x i1> {aside}, {_D} {turned}, {_D} {straight}")
        part = w.cast(w.op("xor", w.cast(part, _I), sign), _D)
        pair.append(w.op("fmul", radius, part))
    return pair[0], pair[1]


def _log(w: _Text, x: str) -> str:
    """Return ln x for normal x > 0, as in fdlibm's e_log.c: x = 2ᵏ(1 + f), s = f/(2 + f), a polynomial in s²."""
    bits = w.cast(x, _I)
    k = w.op("ashr", w.op("sub", bits, _whole(_ROOT_HALF)), _whole(52))
    f = w.op("fsub", w.cast(w.op("sub", bits, w.op("shl", k, _whole(52))), _D), _real(1.0))
    exponent = w.op("fsub", w.cast(w.op("add", k, _whole(_SHIFTER)), _D), _real(1.5 * 2.0**52))
    s = w.op("fdiv", f, w.op("fadd", f, _real(2.0)))
    z = w.op("fmul", s, s)
    rest = w.op("fmul", z, w.polynomial(z, _LOG))
    half_square = w.op("fmul", w.op("fmul", f, _real(0.5)), f)
    low = w.fma(s, w.op("fadd", half_square, rest), w.op("fmul", exponent, _real(_LN2_LOW)))
    return w.fma(exponent, _real(_LN2_HIGH), w.op("fsub", f, w.op("fsub", half_square, low)))


def _sequence(name: str, numbers: Callable[[_Text, str, str], tuple[str, str]]) -> list[str]:
    """Return a function that writes one stream in order: pairs first, first + 1, …, sixteen numbers per pass."""
    w = _Text()
    counter = w.op("add", w.splat("%at"), "<i64 0, i64 1, i64 2, i64 3, i64 4, i64 5, i64 6, i64 7>")
    a, b = numbers(w, *_words(w, w.splat("%k0"), w.splat("%k1"), counter))
    order = ", ".join(f"i32 {i}, i32 {i + 8}" for i in range(8))
    both = w.let(f"shufflevector {_D} {a}, {_D} {b}, <16 x i32> <{order}>")
    w.put(f"%place = getelementptr double, ptr %out, i64 {w.let('mul i64 %i, 16')}")
    w.put(f"store <16 x double> {both}, ptr %place, align 8")
    head = f"define void @{name}(i64 %k0, i64 %k1, i64 %first, i64 %count, ptr noalias %out) #0 {{"
    return _loop(head, ["  %done = mul i64 %i, 8", "  %at = add i64 %first, %done"], w)


def _lanes() -> list[str]:
    """Return the function of eight streams: rows 2i and 2i + 1 hold pair first + i; a row has ``width`` numbers."""
    w = _Text()
    k0, k1 = (w.let(f"load {_I}, ptr %{name}, align 8") for name in ("k0", "k1"))
    a, b = _normals(w, *_words(w, k0, k1, w.splat("%at")))
    w.put(f"%even = getelementptr double, ptr %out, i64 {w.let('mul i64 %double, %width')}")
    w.put("%odd = getelementptr double, ptr %even, i64 %width")
    w.put(f"store {_D} {a}, ptr %even, align 8")
    w.put(f"store {_D} {b}, ptr %odd, align 8")
    head = (
        "define void @normal_lanes(ptr noalias %k0, ptr noalias %k1, i64 %first, i64 %count, ptr noalias %out, "
        "i64 %width) #0 {"
    )
    return _loop(head, ["  %at = add i64 %first, %i", "  %double = shl i64 %i, 1"], w)


def _loop(head: str, start: list[str], w: _Text) -> list[str]:
    """Return the lines of a function that runs the body for i = 0 … count − 1."""
    return [
        head,
        "entry:\n  %any = icmp sgt i64 %count, 0\n  br i1 %any, label %body, label %end",
        "body:\n  %i = phi i64 [0, %entry], [%next, %body]",
        *start,
        *w.lines,
        "  %next = add i64 %i, 1\n  %more = icmp slt i64 %next, %count\n  br i1 %more, label %body, label %end",
        "end:\n  ret void\n}",
    ]


def emit() -> str:
    """Return the IR text of the module with the three functions."""
    declared = [
        f"declare {_I} @llvm.fshl.v8i64({_I}, {_I}, {_I})",
        f"declare {_D} @llvm.fma.v8f64({_D}, {_D}, {_D})",
        f"declare {_D} @llvm.sqrt.v8f64({_D})",
    ]
    wide = 'attributes #0 = { nounwind alignstack=64 "prefer-vector-width"="512" "min-legal-vector-width"="512" }'
    return "\n".join([*declared, *_sequence("uniform", _uniforms), *_sequence("normal", _normals), *_lanes(), wide])
