"""Writer of LLVM instructions, for scalars or SIMD lanes: one method for each instruction and graph operation."""

import struct
from collections.abc import Callable

from thetascope.engine.compiler.instructions.newton import Solver
from thetascope.engine.compiler.instructions.tables import Constants, locate, piece

LIBM = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "pow", "atan2")
_COMPARE = {"lt": "olt", "le": "ole"}


_POINTERS = (
    *("seg_steps", "seg_first", "seg_t", "seg_index", "seg_h", "held", "lane_held", "staged", "lane_staged"),
    *("params", "lane_params", "state", "out", "emitted"),
)
SIGNATURE = f"i64 %segments, {', '.join(f'ptr noalias %{p}' for p in _POINTERS)}, i64 %every"
"""Of a kernel's functions, as codegen.py describes it."""


class Writer:
    """Writer of the instructions of one function. A method that computes a value returns the value's name."""

    def __init__(self, lanes: int, tables: dict[str, str] | None = None):
        self.lanes = lanes
        self.type = "double" if lanes == 1 else f"<{lanes} x double>"
        self.bool = "i1" if lanes == 1 else f"<{lanes} x i1>"
        self.suffix = "f64" if lanes == 1 else f"v{lanes}f64"
        self.lines: list[str] = []
        self.count = 0
        self.tables = {} if tables is None else tables  # definition of each global constant by its name

    def put(self, text: str) -> None:
        """Append an instruction without a value."""
        self.lines.append("  " + text)

    def let(self, text: str) -> str:
        """Append an instruction and return the name of its value."""
        self.count += 1
        name = f"%v{self.count}"
        self.put(f"{name} = {text}")
        return name

    def const(self, value: float) -> str:
        """Return a literal, the same in all lanes."""
        text = "0x" + struct.pack(">d", value).hex().upper()
        return text if self.lanes == 1 else "<" + ", ".join([f"double {text}"] * self.lanes) + ">"

    def splat(self, scalar: str) -> str:
        """Copy a scalar to all lanes."""
        if self.lanes == 1:
            return scalar
        one = self.let(f"insertelement {self.type} poison, double {scalar}, i32 0")
        return self.let(f"shufflevector {self.type} {one}, {self.type} poison, <{self.lanes} x i32> zeroinitializer")

    def fma(self, a: str, b: str, c: str) -> str:
        """Return a · b + c, rounded once."""
        t = self.type
        return self.let(f"call {t} @llvm.fma.{self.suffix}({t} {a}, {t} {b}, {t} {c})")

    def add(self, a: str, b: str) -> str:
        """Return a + b."""
        return self.let(f"fadd {self.type} {a}, {b}")

    def address(self, base: str, index: str | int, kind: str = "double") -> str:
        """Return the address of element `index` of an array of `kind`."""
        return self.let(f"getelementptr {kind}, ptr {base}, i64 {index}")

    def load_shared(self, base: str, index: int) -> str:
        """Load one number for all lanes."""
        return self.splat(self.let(f"load double, ptr {self.address(base, index)}"))

    def load_lanes(self, base: str, index: int) -> str:
        """Load one number for each lane."""
        return self.let(f"load {self.type}, ptr {self.address(base, index * self.lanes)}, align 8")

    def store(self, value: str, base: str, index: int) -> None:
        """Store one number for each lane."""
        self.put(f"store {self.type} {value}, ptr {self.address(base, index * self.lanes)}, align 8")

    def libm(self, name: str, *args: str) -> str:
        """Call the C library lane by lane, so that every lane has the same bits as a scalar run."""
        if self.lanes == 1:
            return self.let(f"call double @{name}(" + ", ".join(f"double {a}" for a in args) + ") #1")
        result = "poison"
        for lane in range(self.lanes):
            picked = [self.let(f"extractelement {self.type} {a}, i32 {lane}") for a in args]
            value = self.let(f"call double @{name}(" + ", ".join(f"double {a}" for a in picked) + ") #1")
            result = self.let(f"insertelement {self.type} {result}, double {value}, i32 {lane}")
        return result

    def flag(self, comparison: str) -> str:
        """Convert a boolean to 1.0 or 0.0."""
        return self.let(
            f"select {self.bool} {comparison}, {self.type} {self.const(1.0)}, {self.type} {self.const(0.0)}"
        )

    def compare(self, kind: str, a: str, b: str) -> str:
        """Return a comparison of two doubles, lane by lane."""
        return self.let(f"fcmp {kind} {self.type} {a}, {b}")

    def select(self, condition: str, a: str, b: str) -> str:
        """Return a where the condition holds, else b."""
        return self.let(f"select {self.bool} {condition}, {self.type} {a}, {self.type} {b}")

    def intrinsic(self, name: str, *args: str) -> str:
        """Call an LLVM intrinsic such as sqrt, in all lanes."""
        t = self.type
        return self.let(f"call {t} @llvm.{name}.{self.suffix}(" + ", ".join(f"{t} {a}" for a in args) + ")")

    def operation(self, op: str, args: list[str]) -> str:
        """Append a graph operation, as in graph.NUMPY, and return its value. Raises ValueError if it is unknown."""
        t = self.type
        if op in ("add", "sub", "mul", "div"):
            return self.let(f"f{op} {t} {args[0]}, {args[1]}")
        if op == "neg":
            return self.let(f"fneg {t} {args[0]}")
        if op == "fma":
            return self.fma(*args)
        if op in ("sqrt", "floor", "abs"):
            return self.intrinsic("fabs" if op == "abs" else op, args[0])
        if op in LIBM:
            return self.libm(op, *args)
        if op in ("locate", "piece"):
            return self.lane_by_lane(locate if op == "locate" else piece, args)
        return self._logic(op, args)

    def lane_by_lane(self, write: Callable[..., str], args: list) -> str:
        """Append instructions for scalars once for each lane. Tables are the same for all lanes."""
        if self.lanes == 1:
            return write(self.let, *args)
        result = "poison"
        for lane in range(self.lanes):
            picked = [
                a if isinstance(a, Constants) else self.let(f"extractelement {self.type} {a}, i32 {lane}") for a in args
            ]
            value = write(self.let, *picked)
            result = self.let(f"insertelement {self.type} {result}, double {value}, i32 {lane}")
        return result

    def solve(self, solver: Solver, *given: str) -> tuple[Solver, list[str]]:
        """Append a call of a solver for each lane; return it and the roots of each lane."""
        if self.lanes == 1:
            return solver, [solver.call(self.let, *given)]
        lanes = range(self.lanes)
        picked = [[self.let(f"extractelement {self.type} {a}, i32 {lane}") for a in given] for lane in lanes]
        return solver, [solver.call(self.let, *scalars) for scalars in picked]

    def root(self, solver: Solver, roots: list[str], j: int) -> str:
        """Append the selection of a root, and return it."""
        if self.lanes == 1:
            return solver.root(self.let, roots[0], j)
        result = "poison"
        for lane, of_lane in enumerate(roots):
            value = solver.root(self.let, of_lane, j)
            result = self.let(f"insertelement {self.type} {result}, double {value}, i32 {lane}")
        return result

    def table(self, rows: tuple) -> Constants:
        """Declare a constant array, and return its address and shape."""
        constants = Constants.of(rows)
        self.tables[constants.name] = constants.definition
        return constants

    def _logic(self, op: str, args: list[str]) -> str:
        """Append a comparison, selection, sign or signed power, and return its value."""
        zero = self.const(0.0)
        if op in _COMPARE:
            return self.flag(self.compare(_COMPARE[op], args[0], args[1]))
        if op in ("min", "max"):
            a, b = args
            return self.select(self.compare("olt" if op == "min" else "ogt", b, a), b, a)
        if op in ("and", "or"):
            x, y = (self.compare("une", a, zero) for a in args)
            return self.flag(self.let(f"{op} {self.bool} {x}, {y}"))
        if op == "where":
            return self.select(self.compare("une", args[0], zero), args[1], args[2])
        if op == "sign":
            a = args[0]
            rest = self.select(
                self.compare("olt", a, zero), self.const(-1.0), self.let(f"fmul {self.type} {a}, {zero}")
            )
            return self.select(self.compare("ogt", a, zero), self.const(1.0), rest)
        if op == "spow":
            return self.intrinsic("copysign", self.libm("pow", self.intrinsic("fabs", args[0]), args[1]), args[0])
        raise ValueError(f"no instruction for {op!r}")


def declarations(w: Writer, scalar: bool) -> tuple[list[str], list[str]]:
    """Return the declared functions and the attributes of a module; ``scalar``: it has scalar functions."""
    declared = [f"declare double @{f}({', '.join(['double'] * (2 if f in ('pow', 'atan2') else 1))}) #0" for f in LIBM]
    for kind, suffix in dict.fromkeys([(w.type, w.suffix), *[("double", "f64")] * scalar]):
        declared += [f"declare {kind} @llvm.{f}.{suffix}({kind})" for f in ("sqrt", "floor", "fabs")]
        declared += [f"declare {kind} @llvm.copysign.{suffix}({kind}, {kind})"]
        declared += [f"declare {kind} @llvm.fma.{suffix}({kind}, {kind}, {kind})"]
    # alignstack: a vector that is spilled from the registers stays within one cache line
    wide = 'nounwind alignstack=64 "prefer-vector-width"="512" "min-legal-vector-width"="512"'
    return declared, [
        "attributes #0 = { nounwind willreturn memory(none) nobuiltin }",
        "attributes #1 = { nounwind willreturn memory(none) nobuiltin }",
        f"attributes #2 = {{ {wide} }}",
        f"attributes #3 = {{ noinline {wide} }}",
    ]


def run_each(widths: dict[str, int]) -> list[str]:
    """Return the lines of ``run_each``, which calls ``run`` for every segment with its part of each array.

    ``widths``: float64 values a segment (per step, for those with steps) in held, staged, state and emitted.
    """
    w = Writer(1)
    w.put("%any = icmp sgt i64 %segments, 0")
    w.put("br i1 %any, label %each, label %done")
    w.lines.append("each:")
    w.put("%s = phi i64 [0, %entry], [%s1, %each]")
    first = w.let("mul i64 %s, %every")
    place = {}
    for name in _POINTERS[:5]:
        place[name] = w.address(f"%{name}", "%s", "i64")
    for name, width in widths.items():
        row = first if name in ("staged", "emitted") else "%s"
        place[name] = w.address(f"%{name}", w.let(f"mul i64 {row}, {width}"))
    args = ", ".join(f"ptr {place.get(p, f'%{p}')}" for p in _POINTERS)
    w.put(f"call void @run(i64 1, {args}, i64 1) #3")
    w.put("%s1 = add i64 %s, 1")
    w.put("%more = icmp slt i64 %s1, %segments")
    w.put("br i1 %more, label %each, label %done")
    w.lines.append("done:")
    w.put("ret void")
    return [f"define void @run_each({SIGNATURE}) #2 {{", "entry:", *w.lines, "}"]
