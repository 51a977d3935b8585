"""Code generator of implicit steps, for equations that are too stiff for the classical Runge–Kutta method.

The stages of implicit_method.py are solved by Newton's method with the Jacobian at the beginning of the step. It comes
from the graph by automatic differentiation; I − h·γ·J is factorised by Gaussian elimination with partial pivoting.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.codegen import TABLES, Layout, Module
from thetascope.engine.compiler.graph import Graph
from thetascope.engine.compiler.instructions.implicit_method import GAMMA, A, C
from thetascope.engine.compiler.ir_builder import Writer
from thetascope.engine.compiler.system import Program

MOST_STATES = 200  # the matrix of a step is on the stack
ITERATIONS = 10  # of Newton's method; fewer where the corrections reach rounding, or no longer halve
_ROUNDING = 1e-15  # a correction relative to its state that ends the iteration

_STEP = f"double %t, double %h, ptr %x, {', '.join(f'ptr %{k}' for k in TABLES)}, ptr %emitted"


class ImplicitModule(Module):
    """Generator of the module of one program and layout with implicit steps; lanes must be 1."""

    def __init__(self, program: Program, layout: Layout):
        super().__init__(program, layout)
        self.n, self.m = len(program.states), len(layout.emitted)

    def _step(self, w: Writer, state: list[str], segment: dict, scratch: dict) -> list[str]:
        """Append the call of one step, and return the new states."""
        count = w.let(f"fadd double %i0, {w.let('sitofp i64 %k to double')}")
        t = w.let(f"fadd double %t0, {w.let(f'fmul double {count}, %h')}")
        for i, value in enumerate(state):
            w.store(value, scratch["z"], i)
        row = w.let(f"mul i64 %at, {self.stages}")
        where = {
            "params": "%params",
            "lane_params": "%lane_params",
            "held": segment["held"],
            "lane_held": segment["lane_held"],
            "staged": w.address("%staged", w.let(f"mul i64 {row}, {len(self.layout.staged)}")),
            "lane_staged": "%lane_staged",
        }
        emitted = w.address("%emitted", w.let(f"mul i64 {row}, {self.m}"))
        args = ", ".join(f"ptr {where[k]}" for k in TABLES)
        w.put(f"call void @implicit_step(double {t}, double %h, ptr {scratch['z']}, {args}, ptr {emitted}) #3")
        new = [w.load_lanes(scratch["z"], i) for i in range(self.n)]
        end = w.let(f"fadd double {t}, %h")
        return self._after(w, state, new, end, segment) if self.program.after else new

    def _more_functions(self) -> list[str]:
        return [*self._jacobian(), *_factorise(), *_solve(), *self._implicit_step()]

    def _jacobian(self) -> list[str]:
        """Return the lines of ``jac``: it stores the elements of ∂f/∂x that are not always zero, row by row."""
        graph = Graph()
        moved = graph.absorb(self.program.graph, self.program.update)
        rows = derivatives(graph, [moved[u] for u in self.program.update], self.program.states)
        column = {name: j for j, name in enumerate(self.program.states)}
        elements = [(i * self.n + column[name], node) for i, row in enumerate(rows) for name, node in row.items()]
        places, nodes = [p for p, _ in elements], tuple(node for _, node in elements)
        inner = Module(replace(self.program, graph=graph, update=nodes, after=()), replace(self.layout, emitted=()))
        inner.tables, inner.solvers = self.tables, self.solvers
        w = Writer(1, self.tables)
        leaves = {s: w.load_lanes("%z", i) for i, s in enumerate(self.program.states)} | {"t": "%t"}
        for place, value in zip(places, inner._values(w, leaves, {k: f"%{k}" for k in TABLES}, {}), strict=True):
            w.store(value, "%d", place)
        args = ", ".join(f"ptr noalias %{k}" for k in TABLES)
        head = f"define internal void @jac(double %t, ptr noalias %z, ptr noalias %d, {args}) #3 {{"
        return [head, *w.lines, "  ret void", "}"]

    def _implicit_step(self) -> list[str]:
        """Return the lines of ``implicit_step``, which advances x in place."""
        n, b = self.n, _Blocks()
        for name, size in (
            ("k", 8 * n),
            ("base", n),
            ("X", n),
            ("d", n),
            ("last", n),
            ("M", n * n),
            ("e", max(1, self.m)),
        ):
            b.put(f"%{name} = alloca [{size} x double], align 64")
        b.put(f"%pivots = alloca [{n} x i64], align 8")
        self._rhs(b, 0, "%t", "%x", "%k")
        self._emit(b, 0)
        with b.loop("clear", "0", str(n * n)) as i:
            b.put(f"store double 0.0, ptr {b.address('%M', i)}")
        args = ", ".join(f"ptr %{k}" for k in TABLES)
        b.put(f"call void @jac(double %t, ptr %x, ptr %M, {args}) #3")
        minus = b.let(f"fmul double %h, {b.const(-GAMMA)}")
        plus = b.let(f"fneg double {minus}")
        with b.loop("scale", "0", str(n * n)) as i:
            place = b.address("%M", i)
            b.put(f"store double {b.let(f'fmul double {minus}, {b.load(place)}')}, ptr {place}")
        with b.loop("one", "0", str(n)) as i:
            place = b.address("%M", b.let(f"mul i64 {i}, {n + 1}"))
            b.put(f"store double {b.let(f'fadd double {b.load(place)}, {b.const(1.0)}')}, ptr {place}")
        b.put(f"call void @factorise(ptr %M, ptr %pivots, i64 {n}) #3")
        with b.loop("guess", "0", str(n)) as i:
            b.put(f"store double {b.load(b.address('%x', i))}, ptr {b.address('%X', i)}")
        for stage in range(1, len(C)):
            self._stage_of_step(b, stage, plus)
        with b.loop("take", "0", str(n)) as i:
            b.put(f"store double {b.load(b.address('%X', i))}, ptr {b.address('%x', i)}")
        return [f"define internal void @implicit_step({_STEP}) #3 {{", "entry:", *b.lines, "  ret void", "}"]

    def _stage_of_step(self, b: "_Blocks", stage: int, plus: str) -> None:
        """Append the solution of one stage, from the stage before as the first guess; ``plus`` is h·γ."""
        n = self.n
        time = b.let(f"fadd double %t, {b.let(f'fmul double %h, {b.const(C[stage])}')}")
        with b.loop(f"base{stage}", "0", str(n)) as i:
            total = b.load(b.address("%x", i))
            for j, a in enumerate(A[stage]):
                if a:
                    k = b.load(b.address("%k", b.let(f"add i64 {i}, {j * n}")))
                    total = b.fma(b.let(f"fmul double %h, {b.const(a)}"), k, total)
            b.put(f"store double {total}, ptr {b.address('%base', i)}")
        with b.loop(f"unknown{stage}", "0", str(n)) as i:
            b.put(f"store double {b.const(float('inf'))}, ptr {b.address('%last', i)}")
        with b.loop(f"newton{stage}", "0", str(ITERATIONS), until=True) as (_, stop):
            self._rhs(b, stage, time, "%X", "%d")
            with b.loop(f"residual{stage}", "0", str(n)) as i:
                place = b.address("%d", i)
                target = b.fma(plus, b.load(place), b.load(b.address("%base", i)))
                difference = b.let(f"fsub double {target}, {b.load(b.address('%X', i))}")
                b.put(f"store double {difference}, ptr {place}")
            b.put(f"call void @solve(ptr %M, ptr %pivots, ptr %d, i64 {n}) #3")
            b.put(f"store i1 true, ptr {stop}")
            with b.loop(f"correct{stage}", "0", str(n)) as i:
                change, place = b.load(b.address("%d", i)), b.address("%X", i)
                value = b.let(f"fadd double {b.load(place)}, {change}")
                b.put(f"store double {value}, ptr {place}")
                limit = b.let(
                    f"fmul double {b.let(f'call double @llvm.fabs.f64(double {value})')}, {b.const(_ROUNDING)}"
                )
                size = b.let(f"call double @llvm.fabs.f64(double {change})")
                last = b.address("%last", i)
                half = b.let(f"fmul double {b.load(last)}, {b.const(0.5)}")
                b.put(f"store double {size}, ptr {last}")
                small = b.let(f"fcmp ole double {size}, {limit}")
                done = b.let(f"or i1 {small}, {b.let(f'fcmp uge double {size}, {half}')}")
                both = b.let(f"and i1 {done}, {b.let(f'load i1, ptr {stop}')}")
                b.put(f"store i1 {both}, ptr {stop}")
        with b.loop(f"slope{stage}", "0", str(n)) as i:
            difference = b.let(f"fsub double {b.load(b.address('%X', i))}, {b.load(b.address('%base', i))}")
            place = b.address("%k", b.let(f"add i64 {i}, {stage * n}"))
            b.put(f"store double {b.let(f'fdiv double {difference}, {plus}')}, ptr {place}")
        if self.m:
            self._rhs(b, stage, time, "%X", "%d")
            self._emit(b, stage)

    def _rhs(self, b: "_Blocks", stage: int, t: str, z: str, d: str) -> None:
        """Append a call of the right-hand side at one stage's inputs."""
        staged = b.address("%staged", stage * len(self.layout.staged))
        args = ", ".join(f"ptr {staged if k == 'staged' else f'%{k}'}" for k in TABLES)
        b.put(f"call void @rhs(double {t}, ptr {z}, ptr {d}, ptr %e, {args}) #3")

    def _emit(self, b: "_Blocks", stage: int) -> None:
        """Append the copy of the emitted values of one stage."""
        for j in range(self.m):
            b.put(f"store double {b.load(b.address('%e', j))}, ptr {b.address('%emitted', stage * self.m + j)}")


class _Blocks(Writer):
    """Writer of scalar code with loops."""

    def __init__(self) -> None:
        super().__init__(1)
        self.block = "entry"

    def load(self, place: str) -> str:
        """Load a number."""
        return self.let(f"load double, ptr {place}")

    def label(self, name: str) -> None:
        """Begin a block."""
        self.lines.append(f"{name}:")
        self.block = name

    @contextmanager
    def loop(self, name: str, first: str, end: str, until: bool = False) -> Iterator:
        """Loop over first … end − 1 and give the counter; ``until``: also the place of a flag that ends the loop."""
        stop = self.let("alloca i1") if until else ""
        self.put(f"br label %{name}")
        before = self.block
        self.label(name)
        self.put(f"%{name}.i = phi i64 [{first}, %{before}], [%{name}.next, %{name}.last]")
        self.put(f"%{name}.more = icmp slt i64 %{name}.i, {end}")
        self.put(f"br i1 %{name}.more, label %{name}.body, label %{name}.end")
        self.label(f"{name}.body")
        yield (f"%{name}.i", stop) if until else f"%{name}.i"
        self.put(f"br label %{name}.last")
        self.label(f"{name}.last")
        self.put(f"%{name}.next = add i64 %{name}.i, 1")
        if until:
            self.put(f"br i1 {self.let(f'load i1, ptr {stop}')}, label %{name}.end, label %{name}")
        else:
            self.put(f"br label %{name}")
        self.label(f"{name}.end")


def _factorise() -> list[str]:
    """Return the lines of ``factorise``: LU of M (n × n) in place, with partial pivoting.

    Row pivots[c] is swapped with row c.
    """
    b = _Blocks()
    largest = b.let("alloca double")
    with b.loop("c", "0", "%n") as c:
        column = b.let(f"add i64 {b.let(f'mul i64 {c}, %n')}, {c}")
        place = b.address("%pivots", c, "i64")
        b.put(f"store i64 {c}, ptr {place}")
        b.put(f"store double -1.0, ptr {largest}")
        with b.loop("search", c, "%n") as i:
            element = b.load(b.address("%M", b.let(f"add i64 {b.let(f'mul i64 {i}, %n')}, {c}")))
            size = b.let(f"call double @llvm.fabs.f64(double {element})")
            known = b.load(largest)
            greater = b.let(f"fcmp ogt double {size}, {known}")
            b.put(f"store double {b.let(f'select i1 {greater}, double {size}, double {known}')}, ptr {largest}")
            old = b.let(f"load i64, ptr {place}")
            b.put(f"store i64 {b.let(f'select i1 {greater}, i64 {i}, i64 {old}')}, ptr {place}")
        row = b.let(f"mul i64 {b.let(f'load i64, ptr {place}')}, %n")
        mine = b.let(f"mul i64 {c}, %n")
        with b.loop("swap", "0", "%n") as j:
            one, other = (b.address("%M", b.let(f"add i64 {r}, {j}")) for r in (mine, row))
            first, second = b.load(one), b.load(other)
            b.put(f"store double {second}, ptr {one}")
            b.put(f"store double {first}, ptr {other}")
        pivot = b.load(b.address("%M", column))
        with b.loop("i", b.let(f"add i64 {c}, 1"), "%n") as i:
            start = b.let(f"mul i64 {i}, %n")
            place = b.address("%M", b.let(f"add i64 {start}, {c}"))
            factor = b.let(f"fdiv double {b.load(place)}, {pivot}")
            b.put(f"store double {factor}, ptr {place}")
            minus = b.let(f"fneg double {factor}")
            with b.loop("j", b.let(f"add i64 {c}, 1"), "%n") as j:
                target = b.address("%M", b.let(f"add i64 {start}, {j}"))
                source = b.load(b.address("%M", b.let(f"add i64 {mine}, {j}")))
                b.put(f"store double {b.fma(minus, source, b.load(target))}, ptr {target}")
    head = "define internal void @factorise(ptr noalias %M, ptr noalias %pivots, i64 %n) #3 {"
    return [head, "entry:", *b.lines, "  ret void", "}"]


def _solve() -> list[str]:
    """Return the lines of ``solve``: d becomes the solution of the factorised system with right-hand side d."""
    b = _Blocks()
    with b.loop("p", "0", "%n") as p:
        other = b.address("%d", b.let(f"load i64, ptr {b.address('%pivots', p, 'i64')}"))
        one = b.address("%d", p)
        first, second = b.load(one), b.load(other)
        b.put(f"store double {second}, ptr {one}")
        b.put(f"store double {first}, ptr {other}")
    with b.loop("f", "0", "%n") as i, b.loop("fj", "0", i) as j:
        _subtract(b, i, j)
    with b.loop("r", "0", "%n") as r:
        i = b.let(f"sub i64 {b.let('sub i64 %n, 1')}, {r}")
        with b.loop("rj", b.let(f"add i64 {i}, 1"), "%n") as j:
            _subtract(b, i, j)
        place = b.address("%d", i)
        pivot = b.load(b.address("%M", b.let(f"add i64 {b.let(f'mul i64 {i}, %n')}, {i}")))
        b.put(f"store double {b.let(f'fdiv double {b.load(place)}, {pivot}')}, ptr {place}")
    head = "define internal void @solve(ptr noalias %M, ptr noalias %pivots, ptr noalias %d, i64 %n) #3 {"
    return [head, "entry:", *b.lines, "  ret void", "}"]


def _subtract(b: _Blocks, i: str, j: str) -> None:
    """Append d[i] −= M[i, j]·d[j]."""
    place = b.address("%d", i)
    element = b.load(b.address("%M", b.let(f"add i64 {b.let(f'mul i64 {i}, %n')}, {j}")))
    minus = b.let(f"fneg double {element}")
    b.put(f"store double {b.fma(minus, b.load(b.address('%d', j)), b.load(place))}, ptr {place}")


def emit_implicit(program: Program, layout: Layout) -> str:
    """Return the IR text of a module with one function, ``run``, that takes implicit steps."""
    return ImplicitModule(program, layout).text()
