"""Code generator: the LLVM IR of a Program's whole time loop, scalar or with SIMD lanes over runs.

The generated function has this signature (pointers are to float64 unless stated otherwise):

    run(i64 segments, i64* seg_steps, i64* seg_first, seg_t, seg_index, seg_h,
        held, lane_held, staged, lane_staged, params, lane_params, state, out, emitted, i64 every)

Time is divided into segments of equal steps on which held inputs are constant. Step k of a segment begins at seg_t +
(seg_index + k)·seg_h, rounded once, so that a segment may be split anywhere. Staged inputs have one value for each of
the four Runge–Kutta stages of each step (one for discrete time). ``seg_first`` is the number of steps until the first
recorded one in that segment; then every ``every``-th step is recorded in ``out``, as one row of all states. ``emitted``
receives the values of selected nodes at every stage. Arrays named lane_* hold one value per lane, lanes innermost. The
results depend neither on how the steps are distributed over calls and segments nor on the number of lanes: no fast-math
flag is set, and the fused multiply-adds are those of the graph.

``run_each`` has the same signature and is for one lane: it takes each segment from a state of its own, so ``state`` has
a row for each; all segments have ``every`` steps.

Where a layout has ``jump`` nodes, one for each state, the states take their values at the head of every segment, before
its first step. Whether a jump changes anything must then depend on held inputs.
"""

from dataclasses import dataclass

from thetascope.engine.compiler.graph import Graph, equations, topological
from thetascope.engine.compiler.instructions import implicit_method
from thetascope.engine.compiler.instructions.newton import Solver
from thetascope.engine.compiler.ir_builder import SIGNATURE, Writer, declarations, run_each
from thetascope.engine.compiler.system import BEGIN, DISCRETE, WIDTH, Program

TABLES = ("params", "lane_params", "held", "lane_held", "staged", "lane_staged")
"""Arguments of a function that evaluates equations: the places of the values of parameters and inputs."""

# Nodes times stages. Above it the right-hand side becomes a separate function, called once per stage: compiling takes a
# third of the time, and runs are equally fast, because most values are in memory either way.
INLINE_LIMIT = 2500


@dataclass(frozen=True)
class Layout:
    """The order of a kernel's inputs, and the nodes that it emits. With its Program, it identifies a kernel."""

    held: tuple[str, ...] = ()
    staged: tuple[str, ...] = ()
    lane_held: tuple[str, ...] = ()
    lane_staged: tuple[str, ...] = ()
    lane_params: tuple[str, ...] = ()
    emitted: tuple[int, ...] = ()  # node indices
    lanes: int = 1
    jump: tuple[int, ...] = ()  # node indices, one for each state, or none
    implicit: bool = False  # the method of implicit_method.py in place of the classical Runge–Kutta method

    def shared_params(self, program: Program) -> tuple[str, ...]:
        """Return the parameters that have one value for all lanes, in the program's order."""
        return tuple(p for p in program.parameters if p not in self.lane_params)


def stages_of(program: Program, layout: Layout) -> int:
    """Return the number of stages of a step: 1 in discrete time."""
    if program.time == DISCRETE:
        return 1
    return len(implicit_method.C) if layout.implicit else 4


def fits_inline(program: Program, layout: Layout) -> bool:
    """Return whether a program is small enough to inline its right-hand side in the loop at every stage."""
    if layout.implicit:  # they run rarely: a short compilation matters more
        return False
    return (
        stages_of(program, layout) * len(topological(program.graph, [*program.update, *layout.emitted])) <= INLINE_LIMIT
    )


def emit(program: Program, layout: Layout) -> str:
    """Return the IR text of a module with the functions ``run`` and ``run_each``."""
    return Module(program, layout).text()


class Module:
    """Generator of the module of one program and layout. A method named after a part of the loop appends its IR."""

    def __init__(self, program: Program, layout: Layout):
        self.program, self.layout = program, layout
        self.roots = [*program.update, *layout.emitted]
        self.order = topological(program.graph, self.roots)
        self.stages = stages_of(program, layout)
        self.inline = fits_inline(program, layout)
        self.params = layout.shared_params(program)
        self.tables: dict[str, str] = {}  # definitions of global constants
        self.solvers: dict[str, list[str]] = {}  # functions that solve equations, by name

    def text(self) -> str:
        """Return the IR text of the module."""
        w = Writer(self.layout.lanes, self.tables)
        body = self._main(w)
        functions = [] if self.inline else self._right_hand_side()
        functions += self._more_functions()
        body += run_each(
            {
                "held": len(self.layout.held),
                "staged": self.stages * len(self.layout.staged),
                "state": len(self.program.states),
                "emitted": self.stages * len(self.layout.emitted),
            }
        )
        solvers = [line for lines in self.solvers.values() for line in lines]
        declared, attributes = declarations(w, scalar=bool(solvers))
        return "\n".join([*declared, *self.tables.values(), *solvers, *functions, *body, *attributes])

    def _more_functions(self) -> list[str]:
        """Return the lines of further functions that the loop calls."""
        return []

    # ---- the values of one stage -------------------------------------------------------------------------------

    def _leaf(self, w: Writer, name: str, where: dict) -> str:
        """Load a variable and return its value. ``where`` maps params, held, staged and lane_* to base pointers."""
        lay = self.layout
        for group, base, load in (
            (self.params, "params", w.load_shared),
            (lay.lane_params, "lane_params", w.load_lanes),
            (lay.held, "held", w.load_shared),
            (lay.lane_held, "lane_held", w.load_lanes),
            (lay.staged, "staged", w.load_shared),
            (lay.lane_staged, "lane_staged", w.load_lanes),
        ):
            if name in group:
                return load(where[base], group.index(name))
        raise ValueError(f"kernel of {self.program.name}: nothing supplies {name!r}")

    def _values(self, w: Writer, leaves: dict[str, str], where: dict, memo: dict[int, str]) -> list[str]:
        """Emit all roots and return their values.

        ``leaves`` maps states and t to values; ``memo`` holds the values of nodes that are already emitted.
        """
        return self.nodes(w, leaves, where, memo, self.order, self.roots)

    def nodes(
        self,
        w: Writer,
        leaves: dict,
        where: dict,
        memo: dict,
        order: list[int],
        roots: list[int],
        graph: Graph | None = None,
    ) -> list[str]:
        """Emit nodes of the program's or another graph, and return the values of ``roots``; else as `_values`."""
        graph = graph or self.program.graph
        for i in order:
            if i in memo:
                continue
            op, *args = graph.nodes[i]
            if op == "const":
                memo[i] = w.const(args[0])
            elif op == "table":
                memo[i] = w.table(args[0])
            elif op == "problem":
                memo[i] = self._solver(args[0])
            elif op == "root":
                solver, of_lanes = memo[args[0]]
                memo[i] = w.root(solver, of_lanes, int(graph.nodes[args[1]][1]))
            elif op == "solve":
                memo[i] = w.solve(memo[args[0]], *(memo[a] for a in args[1:]))
            elif op == "var":
                memo[i] = leaves[args[0]] if args[0] in leaves else self._leaf(w, args[0], where)
            else:
                memo[i] = w.operation(op, [memo[a] for a in args])
        return [memo[r] for r in roots]

    def _solver(self, text: str) -> Solver:
        """Return the solver of equations, a function of the module that is written once."""
        e, apart = equations(text), Writer(1, self.tables)
        solver = Solver.of(text, len(e.g))

        def emit(z: list[str] | None, given: list[str]) -> list[str]:
            roots = e.start if z is None else [*e.g, *e.step, *e.size]
            leaves = {f"a.{k}": a for k, a in enumerate(given)} | {f"z.{j}": b for j, b in enumerate(z or ())}
            return self.nodes(apart, leaves, {}, {}, topological(e.graph, roots), roots, e.graph)

        if solver.name not in self.solvers:
            self.solvers[solver.name] = solver.definition(apart, len(e.G[0]), emit)
        return solver

    def _split(self, values: list[str]) -> tuple[list[str], list[str]]:
        """Return the values of the update and those of the emitted nodes."""
        return values[: len(self.program.states)], values[len(self.program.states) :]

    # ---- the loop ----------------------------------------------------------------------------------------------

    def _main(self, w: Writer) -> list[str]:
        """Return the lines of ``run``: a loop over segments around a loop over steps, with the states in phi nodes."""
        n, t = len(self.program.states), w.type
        start = [w.load_lanes("%state", i) for i in range(n)]
        constants: dict[int, str] = {}
        if self.inline:
            self._preload(w, constants, self.params, "%params", w.load_shared)
            self._preload(w, constants, self.layout.lane_params, "%lane_params", w.load_lanes)
        scratch = self._scratch(w)
        w.put("%any = icmp sgt i64 %segments, 0")
        w.put("br i1 %any, label %segment, label %done")
        w.lines.append("segment:")
        w.put("%s = phi i64 [0, %entry], [%s1, %next]")
        w.put("%row0 = phi i64 [0, %entry], [%row2, %next]")
        w.put("%at0 = phi i64 [0, %entry], [%at1, %next]")
        place0 = self._mark(w)
        per_segment = self._segment_head(w, constants)
        w.put("%none = icmp sle i64 %steps, 0")
        before, begin = "segment", [f"%a{i}" for i in range(n)]
        if self.layout.jump:
            w.put("br i1 %none, label %next, label %jump")
            before, begin = "jump", self._jump(w, begin, per_segment)
        w.put("br label %step" if self.layout.jump else "br i1 %none, label %next, label %step")
        w.lines.append("step:")
        w.put(f"%k = phi i64 [0, %{before}], [%k1, %cont]")
        w.put(f"%at = phi i64 [%at0, %{before}], [%atn, %cont]")
        w.put(f"%row = phi i64 [%row0, %{before}], [%row1, %cont]")
        w.put(f"%left = phi i64 [%first, %{before}], [%left2, %cont]")
        place1 = self._mark(w)
        new = self._step(w, [f"%b{i}" for i in range(n)], per_segment, scratch)
        self._record(w, new)
        w.lines[place1] = "\n".join(
            f"  %b{i} = phi {t} [{a}, %{before}], [{v}, %cont]" for i, (a, v) in enumerate(zip(begin, new, strict=True))
        )
        self._next_segment(w, new)
        w.lines[place0] = "\n".join(f"  %a{i} = phi {t} [{v}, %entry], [%c{i}, %next]" for i, v in enumerate(start))
        return [f"define void @run({SIGNATURE}) #2 {{", "entry:", *w.lines, "}"]

    def _jump(self, w: Writer, states: list[str], segment: dict) -> list[str]:
        """Append the jump at the head of a segment, and return the states after it."""
        w.lines.append("jump:")
        t = w.let(f"fadd double %t0, {w.let('fmul double %i0, %h')}")
        roots = list(self.layout.jump)
        leaves = dict(zip(self.program.states, states, strict=True)) | {"t": w.splat(t)}
        where = self._where(w, 0, segment, "%at0")
        return self.nodes(w, leaves, where, dict(segment["memo"]), topological(self.program.graph, roots), roots)

    def _next_segment(self, w: Writer, new: list[str]) -> None:
        """Append the end of a segment: continue with the next one, or store the states and return."""
        w.lines.append("next:")
        w.put("%row2 = phi i64 [%row0, %segment], [%row1, %cont]")
        w.put("%at1 = phi i64 [%at0, %segment], [%atn, %cont]")
        for i, value in enumerate(new):
            w.put(f"%c{i} = phi {w.type} [%a{i}, %segment], [{value}, %cont]")
        w.put("%s1 = add i64 %s, 1")
        w.put("%more = icmp slt i64 %s1, %segments")
        w.put("br i1 %more, label %segment, label %save")
        w.lines.append("save:")
        for i in range(len(new)):
            w.store(f"%c{i}", "%state", i)
        w.put("br label %done")
        w.lines.append("done:")
        w.put("ret void")

    def _mark(self, w: Writer) -> int:
        """Reserve a line for phi nodes, which are known later, and return its index."""
        w.lines.append("")
        return len(w.lines) - 1

    def _preload(self, w: Writer, memo: dict[int, str], names: tuple[str, ...], base: str, load) -> None:
        """Load the variables that the program uses before the loop, into ``memo``."""
        graph = self.program.graph
        for j, name in enumerate(names):
            i = graph.index.get(("var", name))
            if i is not None:
                memo[i] = load(base, j)

    def _segment_head(self, w: Writer, constants: dict[int, str]) -> dict:
        """Append the loads at the head of a segment, and return its values: memo, held rows, h, h/2 and h/6."""
        lay, lanes = self.layout, self.layout.lanes
        w.put(f"%steps = load i64, ptr {w.address('%seg_steps', '%s', 'i64')}")
        w.put(f"%first = load i64, ptr {w.address('%seg_first', '%s', 'i64')}")
        w.put(f"%t0 = load double, ptr {w.address('%seg_t', '%s')}")
        w.put(f"%i0 = load double, ptr {w.address('%seg_index', '%s')}")
        w.put(f"%h = load double, ptr {w.address('%seg_h', '%s')}")
        row = w.let(f"mul i64 %s, {len(lay.held)}")
        held = w.address("%held", row)
        row = w.let(f"mul i64 %s, {len(lay.lane_held) * lanes}")
        lane_held = w.address("%lane_held", row)
        memo = dict(constants)
        if self.inline:
            self._preload(w, memo, lay.held, held, w.load_shared)
            self._preload(w, memo, lay.lane_held, lane_held, w.load_lanes)
        h = w.splat("%h")
        sizes = {"h": h} | {
            name: w.let(f"fmul {w.type} {h}, {w.const(c)}") for name, c in (("half", 0.5), ("sixth", 1 / 6))
        }
        return {"memo": memo, "held": held, "lane_held": lane_held, **sizes}

    def _scratch(self, w: Writer) -> dict:
        """Allocate the arguments of a separate right-hand side: z (states), d (their update), e (emitted nodes)."""
        if self.inline:
            return {}
        n, m = len(self.program.states), max(1, len(self.layout.emitted))
        return {k: w.let(f"alloca [{size} x {w.type}], align 64") for k, size in (("z", n), ("d", n), ("e", m))}

    def _record(self, w: Writer, new: list[str]) -> None:
        """Append the end of a step: store a row of ``out`` if it is due, and continue with the next step."""
        n = len(new)
        w.put("%left1 = sub i64 %left, 1")
        w.put("%due = icmp eq i64 %left1, 0")
        w.put("br i1 %due, label %write, label %cont")
        w.lines.append("write:")
        place = w.address("%out", w.let(f"mul i64 %row, {n * self.layout.lanes}"))
        for i, value in enumerate(new):
            w.store(value, place, i)
        w.put("%rown = add i64 %row, 1")
        w.put("br label %cont")
        w.lines.append("cont:")
        w.put("%left2 = phi i64 [%left1, %step], [%every, %write]")
        w.put("%row1 = phi i64 [%row, %step], [%rown, %write]")
        w.put("%k1 = add i64 %k, 1")
        w.put("%atn = add i64 %at, 1")
        w.put("%again = icmp slt i64 %k1, %steps")
        w.put("br i1 %again, label %step, label %next")

    # ---- one step ----------------------------------------------------------------------------------------------

    def _step(self, w: Writer, state: list[str], segment: dict, scratch: dict) -> list[str]:
        """Append one Runge–Kutta step (or one step of discrete time), and return the new states."""
        kd = w.let("sitofp i64 %k to double")
        count = w.let(f"fadd double %i0, {kd}")
        t = w.let(f"fadd double %t0, {w.let(f'fmul double {count}, %h')}")
        if self.stages == 1:
            return self._stage(w, 0, state, t, segment, scratch)
        half, sixth, h = (segment[k] for k in ("half", "sixth", "h"))
        middle = w.let(f"fadd double {t}, {w.let(f'fmul double %h, {Writer(1).const(0.5)}')}")
        end = w.let(f"fadd double {t}, %h")
        k1 = self._stage(w, 0, state, t, segment, scratch)
        k2 = self._stage(w, 1, [w.fma(half, k, s) for k, s in zip(k1, state, strict=True)], middle, segment, scratch)
        k3 = self._stage(w, 2, [w.fma(half, k, s) for k, s in zip(k2, state, strict=True)], middle, segment, scratch)
        z = [w.fma(h, k, s) for k, s in zip(k3, state, strict=True)]
        # k2 + k3 before the last stage, so that fewer values stay live; sums are faster than multiply-adds
        inner = [w.add(a, b) for a, b in zip(k2, k3, strict=True)]
        k4 = self._stage(w, 3, z, end, segment, scratch)
        total = [w.fma(w.const(2.0), a, w.add(b, c)) for a, b, c in zip(inner, k1, k4, strict=True)]
        new = [w.fma(sixth, k, s) for k, s in zip(total, state, strict=True)]
        return self._after(w, state, new, end, segment) if self.program.after else new

    def _after(self, w: Writer, begin: list[str], end: list[str], t: str, segment: dict) -> list[str]:
        """Append the events of a step, and return the states at its end with them."""
        roots, leaves = list(self.program.after), {"t": w.splat(t), WIDTH: segment["h"]}
        leaves |= {f"{BEGIN}{name}": a for name, a in zip(self.program.states, begin, strict=True)}
        leaves |= dict(zip(self.program.states, end, strict=True))
        where = self._where(w, self.stages - 1, segment, "%at")
        return self.nodes(w, leaves, where, dict(segment["memo"]), topological(self.program.graph, roots), roots)

    def _stage(self, w: Writer, stage: int, z: list[str], t: str, segment: dict, scratch: dict) -> list[str]:
        """Append one stage at the states z and time t, store its emitted nodes, and return the update."""
        lay, lanes = self.layout, self.layout.lanes
        where = self._where(w, stage, segment, "%at")
        if self.inline:
            leaves = dict(zip(self.program.states, z, strict=True)) | {"t": w.splat(t)}
            values, emitted = self._split(self._values(w, leaves, where, dict(segment["memo"])))
        else:
            values, emitted = self._called(w, z, t, where, scratch)
        if lay.emitted:
            place = self._row(w, stage, "%emitted", len(lay.emitted) * lanes, "%at")
            for j, value in enumerate(emitted):
                w.store(value, place, j)
        return values

    def _where(self, w: Writer, stage: int, segment: dict, at: str) -> dict:
        """Append the addresses of a stage's inputs in the step ``at``, and return them by group."""
        lay = self.layout
        where = {k: segment.get(k, f"%{k}") for k in TABLES}
        for name, width in (("staged", len(lay.staged)), ("lane_staged", len(lay.lane_staged) * lay.lanes)):
            if width:
                where[name] = self._row(w, stage, f"%{name}", width, at)
        return where

    def _row(self, w: Writer, stage: int, base: str, width: int, at: str) -> str:
        """Append and return the address of a stage's row of a table in the step ``at``."""
        place = w.let(f"add i64 {w.let(f'mul i64 {at}, {self.stages}')}, {stage}")
        return w.address(base, w.let(f"mul i64 {place}, {width}"))

    # ---- large programs ----------------------------------------------------------------------------------------

    def _called(self, w: Writer, z: list[str], t: str, where: dict, scratch: dict) -> tuple[list[str], list[str]]:
        """Append a call of the separate right-hand side; return the update and the emitted nodes."""
        for i, value in enumerate(z):
            w.store(value, scratch["z"], i)
        args = ", ".join(f"ptr {where[k]}" for k in TABLES)
        w.put(f"call void @rhs(double {t}, ptr {scratch['z']}, ptr {scratch['d']}, ptr {scratch['e']}, {args}) #3")
        values = [w.load_lanes(scratch["d"], i) for i in range(len(z))]
        return values, [w.load_lanes(scratch["e"], j) for j in range(len(self.layout.emitted))]

    def _right_hand_side(self) -> list[str]:
        """Return the lines of the separate right-hand side, ``rhs``."""
        w = Writer(self.layout.lanes, self.tables)
        where = {k: f"%{k}" for k in TABLES}
        leaves = {s: w.load_lanes("%z", i) for i, s in enumerate(self.program.states)} | {"t": w.splat("%t")}
        values, emitted = self._split(self._values(w, leaves, where, {}))
        for i, value in enumerate(values):
            w.store(value, "%d", i)
        for j, value in enumerate(emitted):
            w.store(value, "%e", j)
        args = ", ".join(f"ptr noalias %{k}" for k in TABLES)
        head = f"define internal void @rhs(double %t, ptr noalias %z, ptr noalias %d, ptr noalias %e, {args}) #3 {{"
        return [head, *w.lines, "  ret void", "}"]
