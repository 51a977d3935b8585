"""Translation of the functions of declaration.py to LLVM IR text, in one pass over the syntax tree."""

import ast
from collections.abc import Mapping, Sequence

import numpy as np

from thetascope.engine.loops.declaration import External, Loops
from thetascope.engine.loops.expressions import COMPARE, TYPES, Expressions, Value


class Translator(Expressions):
    """Translator of one function to IR text.

    Args:
        source: the function.
        sizes: the values of `Sizes`.
        functions: what the names of functions in its text refer to.
    """

    def __init__(self, source: Loops, sizes: Mapping[str, int], functions: Mapping[str, "Loops | External"]):
        super().__init__(source, sizes, functions)
        self.labels = 0
        self.head: list[str] = []  # allocations
        self.exits: list[tuple[str, str]] = []  # labels of continue and break
        self.ended = False

    def lines(self, exported: bool) -> list[str]:
        """Return the lines of the function."""
        w, args = self.w, []
        for p in self.source.parameters:
            if p.kind in ("int", "float"):
                args.append(f"{TYPES[p.kind]} %p.{p.name}")
                self._assign(p.name, Value(f"%p.{p.name}", p.kind))
            for field_name, shape in p.shapes.items():
                name = f"{p.name}.{field_name}".rstrip(".")
                args.append(f"ptr noalias %p.{name}")
                self.scope.arrays[name] = Value(f"%p.{name}", "array", shape)
        self._block(self.source.tree.body)
        if not self.ended:
            w.put("ret void" if self.source.result == "none" else "unreachable")
        linkage = "" if exported else "internal "
        returned = TYPES[self.source.result]
        head = f"define {linkage}{returned} @{self.source.name}({', '.join(args)}) #2 {{"
        return [head, "entry:", *self.head, *w.lines, "}"]

    # ---- statements ---------------------------------------------------------------------------------------------

    def _block(self, body: Sequence[ast.stmt]) -> None:
        for statement in body:
            if self.ended:
                return
            self._statement(statement)

    def _statement(self, node: ast.stmt) -> None:
        if isinstance(node, ast.Assign):
            self._assignment(node)
        elif isinstance(node, ast.AugAssign):
            operation = ast.BinOp(left=_loaded(node.target), op=node.op, right=node.value)
            self._store(node.target, self.expression(ast.copy_location(operation, node)))
        elif isinstance(node, ast.For):
            self._for(node)
        elif isinstance(node, ast.While):
            self._while(node)
        elif isinstance(node, ast.If):
            self._if(node)
        elif isinstance(node, ast.Return):
            value = None if node.value is None else self.converted(self.expression(node.value), self.source.result)
            self._end("ret void" if value is None else f"ret {TYPES[value.kind]} {value.name}")
        elif isinstance(node, ast.Break):
            self._end(f"br label %{self.exits[-1][1]}")
        elif isinstance(node, ast.Continue):
            self._end(f"br label %{self.exits[-1][0]}")
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            return  # a docstring
        elif isinstance(node, ast.Expr):
            self.expression(node.value)
        elif not isinstance(node, ast.Pass):
            raise self.refused(node)

    def _assignment(self, node: ast.Assign) -> None:
        (target,) = node.targets
        call = node.value
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "empty":
            assert isinstance(target, ast.Name)
            total = int(np.prod([int(self.converted(self.expression(a), "int").name) for a in call.args]))
            self.head.append(f"  %l.{target.id} = alloca [{max(total, 1)} x double], align 64")
            self.scope.arrays[target.id] = Value(f"%l.{target.id}", "array", tuple(self._plain(a) for a in call.args))
            return
        values = self.expression(call)
        self._store(target, values)

    def _store(self, target: ast.expr, value: Value) -> None:
        if isinstance(target, ast.Name):
            self._assign(target.id, value)
        elif isinstance(target, ast.Subscript):
            place = self.element(target)
            assert not place.shape, f"{ast.unparse(target)} is a row, not a number"
            self.w.put(f"store double {self.converted(value, 'float').name}, ptr {place.name}, align 8")
        else:
            raise self.refused(target)

    def _assign(self, name: str, value: Value) -> None:
        place = self.scope.places.get(name)
        if place is None:
            kind = "int" if value.kind == "bool" else value.kind
            place = Value(f"%a.{name}", kind)
            self.head.append(f"  {place.name} = alloca {TYPES[kind]}, align 8")
            self.scope.places[name] = place
        value = self.converted(value, place.kind)
        self.w.put(f"store {TYPES[place.kind]} {value.name}, ptr {place.name}, align 8")

    def _for(self, node: ast.For) -> None:
        assert isinstance(node.target, ast.Name) and isinstance(node.iter, ast.Call)
        bounds = [self.converted(self.expression(a), "int") for a in node.iter.args]
        step = "1" if len(bounds) < 3 else bounds[2].name
        first = bounds[0].name if len(bounds) > 1 else "0"
        last = bounds[1 if len(bounds) > 1 else 0].name
        down = step.startswith("-")
        counter = f"%c{self.labels}"
        self.head.append(f"  {counter} = alloca i64, align 8")
        test, body, following, done = self._labels("test", "body", "next", "done")
        self.w.put(f"store i64 {first}, ptr {counter}, align 8")
        self._go(test)
        at = self.w.let(f"load i64, ptr {counter}, align 8")
        more = self.w.let(f"icmp {'sgt' if down else 'slt'} i64 {at}, {last}")
        self.w.put(f"br i1 {more}, label %{body}, label %{done}")
        self._label(body)
        self._assign(node.target.id, Value(at, "int"))
        self.exits.append((following, done))
        self._block(node.body)
        self.exits.pop()
        self._go(following)
        at = self.w.let(f"load i64, ptr {counter}, align 8")
        self.w.put(f"store i64 {self.w.let(f'add nsw i64 {at}, {step}')}, ptr {counter}, align 8")
        self.w.put(f"br label %{test}")
        self._label(done)

    def _while(self, node: ast.While) -> None:
        test, body, done = self._labels("test", "body", "done")
        self._go(test)
        holds = self.converted(self.expression(node.test), "bool")
        self.w.put(f"br i1 {holds.name}, label %{body}, label %{done}")
        self._label(body)
        self.exits.append((test, done))
        self._block(node.body)
        self.exits.pop()
        if not self.ended:
            self.w.put(f"br label %{test}")
        self._label(done)

    def _if(self, node: ast.If) -> None:
        fixed = self._fixed(node.test)
        if fixed is not None:
            self._block(node.body if fixed else node.orelse)
            return
        yes, no, done = self._labels("yes", "no", "done")
        holds = self.converted(self.expression(node.test), "bool")
        self.w.put(f"br i1 {holds.name}, label %{yes}, label %{no}")
        self._label(yes)
        self._block(node.body)
        if not self.ended:
            self.w.put(f"br label %{done}")
        self._label(no)
        self._block(node.orelse)
        self._go(done)

    def _fixed(self, node: ast.expr) -> bool | None:
        """Return whether a comparison of sizes holds, None for any other condition."""
        if not isinstance(node, ast.Compare):
            return None
        sides = [self.number(side) for side in (node.left, node.comparators[0])]
        if None in sides:
            return None
        a, b = (int(side) for side in sides if side is not None)
        kind = COMPARE[type(node.ops[0])]
        return {"lt": a < b, "le": a <= b, "gt": a > b, "ge": a >= b, "eq": a == b, "ne": a != b}[kind]

    def _plain(self, node: ast.expr) -> str:
        """Return a size of a local array in the form of declared shapes."""
        return ast.unparse(node).replace(" ", "").replace("size.", "")

    def _labels(self, *names: str) -> list[str]:
        self.labels += 1
        return [f"{name}{self.labels}" for name in names]

    def _label(self, name: str) -> None:
        self.w.lines.append(f"{name}:")
        self.ended = False

    def _go(self, label: str) -> None:
        """Continue at a label."""
        if not self.ended:
            self.w.put(f"br label %{label}")
        self._label(label)

    def _end(self, text: str) -> None:
        self.w.put(text)
        self.ended = True


def _loaded(target: ast.expr) -> ast.expr:
    """Return an assignment's target as an expression."""
    return ast.parse(ast.unparse(target), mode="eval").body
