"""LLVM function that solves equations by the damped Newton method of numpy_operations.py, for scalars."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from thetascope.engine.compiler.instructions.numpy_operations import CLOSE, MOST_ITERATIONS, ROUNDING, SHORTEST


class Writer(Protocol):
    """Writer of the instructions of one function with scalar values."""

    lines: list[str]

    def put(self, text: str) -> None:
        """Append an instruction without a value."""
        ...

    def let(self, text: str) -> str:
        """Append an instruction and return the name of its value."""
        ...

    def const(self, value: float) -> str:
        """Return a literal."""
        ...

    def intrinsic(self, name: str, *args: str) -> str:
        """Call an LLVM intrinsic."""
        ...


Emit = Callable[[list[str] | None, list[str]], list[str]]
"""Appends the values of g, J⁻¹g and the sizes of the terms at z (3n in all), or the first guess where z is None, for
given numbers, and returns their names."""


@dataclass(frozen=True)
class Solver:
    """The function for equations with n unknowns: its name, and the type of its result."""

    name: str
    n: int

    @classmethod
    def of(cls, text: str, n: int) -> "Solver":
        """Return the solver of the equations with this text."""
        return cls("@solve." + hashlib.sha256(text.encode()).hexdigest()[:16], n)

    @property
    def type(self) -> str:
        """Return the LLVM type of the roots."""
        return f"{{ {', '.join(['double'] * self.n)} }}"

    def call(self, let: Callable[[str], str], *given: str) -> str:
        """Append a call, and return the name of the roots."""
        return let(f"call {self.type} {self.name}({', '.join(f'double {a}' for a in given)}) #3")

    def root(self, let: Callable[[str], str], roots: str, j: int) -> str:
        """Append the selection of a root, and return its name."""
        return let(f"extractvalue {self.type} {roots}, {j}")

    def definition(self, w: Writer, given: int, emit: Emit) -> list[str]:
        """Return the lines of the function with this number of given numbers; ``emit`` appends to ``w``."""
        names = [f"%a{k}" for k in range(given)]
        start = emit(None, names)
        w.put("br label %loop")
        w.lines.append("loop:")
        place = len(w.lines)
        w.lines.append("")
        n = self.n
        old = {part: [f"%{part}{i}" for i in range(n)] for part in ("z", "d", "w")}
        trial = [
            w.let(f"fsub double {z}, {w.let(f'fmul double %factor, {d}')}")
            for z, d in zip(old["z"], old["d"], strict=True)
        ]
        values = emit(trial, names)
        g, step, size = values[:n], values[n : 2 * n], values[2 * n :]
        w.put(f"br i1 {self._done(w, trial, g, step, size)}, label %finish, label %next")
        w.lines.append("next:")
        better = self._better(w, g, step, old["w"])
        weight = [
            self._select(
                w, w.let(f"fcmp ogt double {s}, {w.const(0)}"), w.let(f"fdiv double {w.const(1)}, {s}"), w.const(0)
            )
            for s in size
        ]
        new = {
            part: [self._select(w, better, b, a) for a, b in zip(old[part], fresh, strict=True)]
            for part, fresh in (("z", trial), ("d", step), ("w", weight))
        }
        level = self._select(w, better, self._residual(w, g, weight), "%level")
        grown, halved = (w.let(f"fmul double %factor, {w.const(c)}") for c in (2.0, 0.5))
        limited = self._select(w, w.let(f"fcmp ogt double {grown}, {w.const(1)}"), w.const(1), grown)
        factor = self._select(w, better, limited, halved)
        w.put("%count1 = add i64 %count, 1")
        few = w.let(f"icmp slt i64 %count1, {MOST_ITERATIONS}")
        begun = w.let(f"fcmp olt double {level}, {w.const(float('inf'))}")
        long = w.let(f"fcmp ogt double {factor}, {w.const(SHORTEST)}")
        w.put(f"%more = and i1 {few}, {w.let(f'and i1 {begun}, {long}')}")
        w.put("br i1 %more, label %loop, label %fail")
        first = {"z": start, "d": [w.const(0)] * n, "w": [w.const(1)] * n}
        w.lines[place] = "\n".join(
            [
                "  %count = phi i64 [0, %entry], [%count1, %next]",
                f"  %factor = phi double [{w.const(1)}, %entry], [{factor}, %next]",
                f"  %level = phi double [{w.const(float('inf'))}, %entry], [{level}, %next]",
                *(
                    f"  {old[part][i]} = phi double [{first[part][i]}, %entry], [{new[part][i]}, %next]"
                    for part in old
                    for i in range(n)
                ),
            ]
        )
        w.lines.append("finish:")
        self._return(w, [w.let(f"fsub double {t}, {s}") for t, s in zip(trial, step, strict=True)])
        w.lines.append("fail:")
        self._return(w, [w.const(float("nan"))] * n)
        head = f"define internal {self.type} {self.name}({', '.join(f'double {a}' for a in names)}) #3 {{"
        return [head, "entry:", *w.lines, "}"]

    def _done(self, w: Writer, trial: list[str], g: list[str], step: list[str], size: list[str]) -> str:
        """Append whether the next step is the last one. A comparison with NaN fails."""
        every = "true"
        for t, r, s, m in zip(trial, g, step, size, strict=True):
            length = w.intrinsic("fabs", s)
            finite = w.let(f"fcmp olt double {length}, {w.const(float('inf'))}")
            share = self._times(w, w.intrinsic("fabs", t), w.const(CLOSE))
            rounding = self._times(w, m, w.const(ROUNDING))
            short = w.let(f"fcmp ole double {length}, {share}")
            small = w.let(f"fcmp ole double {w.intrinsic('fabs', r)}, {rounding}")
            either = w.let(f"or i1 {short}, {small}")
            every = w.let(f"and i1 {every}, {w.let(f'and i1 {finite}, {either}')}")
        return every

    def _better(self, w: Writer, g: list[str], step: list[str], weight: list[str]) -> str:
        """Append whether the residuals are finite and smaller than before."""
        residual = self._residual(w, g, weight)
        part = w.let(f"fmul double %factor, {w.const(0.25)}")
        bound = w.let(f"fmul double %level, {w.let(f'fsub double {w.const(1)}, {part}')}")
        better = w.let(f"fcmp olt double {residual}, {w.const(float('inf'))}")
        better = w.let(f"and i1 {better}, {w.let(f'fcmp ole double {residual}, {bound}')}")
        for s in step:
            finite = w.let(f"fcmp olt double {w.intrinsic('fabs', s)}, {w.const(float('inf'))}")
            better = w.let(f"and i1 {better}, {finite}")
        return better

    def _residual(self, w: Writer, g: list[str], weight: list[str]) -> str:
        """Append the sum of the residuals' sizes by their weights."""
        total = w.const(0)
        for r, c in zip(g, weight, strict=True):
            total = w.let(f"fadd double {total}, {self._times(w, w.intrinsic('fabs', r), c)}")
        return total

    @staticmethod
    def _times(w: Writer, a: str, b: str) -> str:
        return w.let(f"fmul double {a}, {b}")

    @staticmethod
    def _select(w: Writer, condition: str, a: str, b: str) -> str:
        return w.let(f"select i1 {condition}, double {a}, double {b}")

    def _return(self, w: Writer, values: list[str]) -> None:
        roots = "poison"
        for j, value in enumerate(values):
            roots = w.let(f"insertvalue {self.type} {roots}, double {value}, {j}")
        w.put(f"ret {self.type} {roots}")
