"""Translation of expressions of declaration.py's subset to LLVM IR text."""

import ast
from collections.abc import Mapping
from dataclasses import dataclass, field

from thetascope.engine.compiler.ir_builder import LIBM, Writer
from thetascope.engine.loops.declaration import External, Loops, size_of

_FUNCTIONS = {"sqrt", "abs", "min", "max", "isnan", "float", "int", *LIBM}
BINARY = {ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.Div: "div", ast.FloorDiv: "idiv", ast.Mod: "rem"}
COMPARE = {ast.Lt: "lt", ast.LtE: "le", ast.Gt: "gt", ast.GtE: "ge", ast.Eq: "eq", ast.NotEq: "ne"}
_FAST = "contract"


@dataclass(frozen=True)
class Value:
    """A value in a function: its LLVM name, its kind (int, float, bool, array), and an array's remaining shape."""

    name: str
    kind: str
    shape: tuple[str, ...] = ()


TYPES = {"int": "i64", "float": "double", "bool": "i1", "array": "ptr", "none": "void"}


@dataclass
class Scope:
    """Names of one function: where each local number is stored, arrays, and functions."""

    places: dict[str, Value] = field(default_factory=dict)
    arrays: dict[str, Value] = field(default_factory=dict)
    functions: dict[str, "Loops | External"] = field(default_factory=dict)


class Expressions:
    """Translator of the expressions of one function.

    Args:
        source: the function.
        sizes: the values of `Sizes`.
        functions: what the names of functions in its text refer to.
    """

    def __init__(self, source: Loops, sizes: Mapping[str, int], functions: Mapping[str, "Loops | External"]):
        self.source, self.sizes, self.w = source, sizes, Writer(1)
        self.scope = Scope(functions=dict(functions))
        self.size_names = {p.name for p in source.parameters if p.kind == "sizes"}

    def number(self, node: ast.expr) -> int | None:
        """Return the value of a size or an integer, else None."""
        if isinstance(node, ast.Constant) and isinstance(node.value, int):
            return node.value
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in self.size_names:
            return self.sizes[node.attr]
        return None

    def expression(self, node: ast.expr) -> Value:
        """Append the instructions of an expression, and return its value."""
        if isinstance(node, ast.Constant):
            return self._constant(node.value)
        if isinstance(node, ast.Name):
            return self._name(node.id)
        if isinstance(node, ast.Attribute):
            return self._attribute(node)
        if isinstance(node, ast.BinOp):
            return self.arithmetic(BINARY[type(node.op)], self.expression(node.left), self.expression(node.right))
        if isinstance(node, ast.UnaryOp):
            return self._unary(node)
        if isinstance(node, ast.Compare):
            return self._comparison(node)
        if isinstance(node, ast.BoolOp):
            return self._both(node)
        if isinstance(node, ast.Subscript):
            place = self.element(node)
            if place.shape:
                return place
            return Value(self.w.let(f"load double, ptr {place.name}, align 8"), "float")
        if isinstance(node, ast.Call):
            return self._call(node)
        raise self.refused(node)

    def _constant(self, value: object) -> Value:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise TypeError(f"{self.source.name}: no constant {value!r}")
        return Value(str(value), "int") if isinstance(value, int) else Value(self.w.const(value), "float")

    def _name(self, name: str) -> Value:
        if name in self.scope.arrays:
            return self.scope.arrays[name]
        place = self.scope.places[name]
        return Value(self.w.let(f"load {TYPES[place.kind]}, ptr {place.name}, align 8"), place.kind)

    def _attribute(self, node: ast.Attribute) -> Value:
        """Return a size, or an array of a bundle."""
        number = self.number(node)
        return self.scope.arrays[ast.unparse(node)] if number is None else Value(str(number), "int")

    def arithmetic(self, op: str, a: Value, b: Value) -> Value:
        """Append an arithmetic operation; integers stay integers, and known ones are computed here."""
        if a.kind == b.kind == "int" and op != "div":
            text = {"idiv": "sdiv", "rem": "srem"}.get(op, f"{op} nsw")
            if a.name.lstrip("-").isdigit() and b.name.lstrip("-").isdigit():
                x, y = int(a.name), int(b.name)
                return Value(str({"add": x + y, "sub": x - y, "mul": x * y}.get(op, x // max(y, 1))), "int")
            return Value(self.w.let(f"{text} i64 {a.name}, {b.name}"), "int")
        x, y = self.converted(a, "float"), self.converted(b, "float")
        return Value(self.w.let(f"f{op} {_FAST} double {x.name}, {y.name}"), "float")

    def _unary(self, node: ast.UnaryOp) -> Value:
        value = self.expression(node.operand)
        if isinstance(node.op, ast.Not):
            return Value(self.w.let(f"xor i1 {self.converted(value, 'bool').name}, true"), "bool")
        if value.kind == "int":
            if value.name.isdigit():
                return Value(f"-{value.name}", "int")
            return Value(self.w.let(f"sub nsw i64 0, {value.name}"), "int")
        return Value(self.w.let(f"fneg {_FAST} double {value.name}"), "float")

    def _comparison(self, node: ast.Compare) -> Value:
        a, b = self.expression(node.left), self.expression(node.comparators[0])
        kind = COMPARE[type(node.ops[0])]
        if a.kind == b.kind == "int":
            signed = kind if kind in ("eq", "ne") else f"s{kind}"
            return Value(self.w.let(f"icmp {signed} i64 {a.name}, {b.name}"), "bool")
        x, y = self.converted(a, "float"), self.converted(b, "float")
        ordered = "une" if kind == "ne" else f"o{kind}"
        return Value(self.w.let(f"fcmp {ordered} double {x.name}, {y.name}"), "bool")

    def _both(self, node: ast.BoolOp) -> Value:
        op = "and" if isinstance(node.op, ast.And) else "or"
        values = [self.converted(self.expression(v), "bool") for v in node.values]
        total = values[0].name
        for value in values[1:]:
            total = self.w.let(f"{op} i1 {total}, {value.name}")
        return Value(total, "bool")

    def element(self, node: ast.Subscript) -> Value:
        """Return the place of an element, or of a row where fewer indices are given."""
        array = self.expression(node.value)
        index = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
        offset = Value("0", "int")
        for axis, part in enumerate(index):
            if axis:
                offset = self.arithmetic("mul", offset, Value(self._size(array.shape[axis]), "int"))
            offset = self.arithmetic("add", offset, self.converted(self.expression(part), "int"))
        left = array.shape[len(index) :]
        for size in left:
            offset = self.arithmetic("mul", offset, Value(self._size(size), "int"))
        place = self.w.let(f"getelementptr inbounds double, ptr {array.name}, i64 {offset.name}")
        return Value(place, "array", left)

    def _size(self, text: str) -> str:
        """Return a declared size as a number, or as a value where it is a parameter."""
        if text in self.scope.places:
            return self._name(text).name
        return str(size_of(text, self.sizes))

    def _call(self, node: ast.Call) -> Value:
        assert isinstance(node.func, ast.Name)
        name = node.func.id
        if name in self.scope.functions:
            return self._calls(self.scope.functions[name], node)
        if name not in _FUNCTIONS:
            raise self.refused(node)
        values = [self.expression(a) for a in node.args]
        if name in ("float", "int"):
            return self.converted(values[0], name)
        if name == "isnan":
            x = self.converted(values[0], "float").name
            return Value(self.w.let(f"fcmp uno double {x}, {x}"), "bool")
        if name in ("min", "max"):
            return self._extreme(name, *values)
        numbers = [self.converted(v, "float").name for v in values]
        if name in ("sqrt", "abs"):
            return Value(self.w.intrinsic("fabs" if name == "abs" else name, numbers[0]), "float")
        return Value(self.w.libm(name, *numbers), "float")

    def _extreme(self, name: str, a: Value, b: Value) -> Value:
        if a.kind == b.kind == "int":
            less = self.w.let(f"icmp {'slt' if name == 'min' else 'sgt'} i64 {a.name}, {b.name}")
            return Value(self.w.let(f"select i1 {less}, i64 {a.name}, i64 {b.name}"), "int")
        x, y = self.converted(a, "float").name, self.converted(b, "float").name
        first = self.w.let(f"fcmp {'olt' if name == 'min' else 'ogt'} double {y}, {x}")
        return Value(self.w.let(f"select i1 {first}, double {y}, double {x}"), "float")

    def _calls(self, function: "Loops | External", node: ast.Call) -> Value:
        values = list(node.args)
        if isinstance(function, External):
            kinds = ["float"] * function.numbers + ["array"] * function.pointers
            args = [self.converted(self.expression(a), kind) for a, kind in zip(values, kinds, strict=True)]
            result = "none"
        else:
            args, result = [], function.result
            for a, p in zip(values, function.parameters, strict=True):
                if p.kind == "bundle":
                    args += [self.scope.arrays[f"{ast.unparse(a)}.{f}"] for f in p.shapes]
                elif p.kind not in ("function", "sizes"):
                    args.append(self.converted(self.expression(a), p.kind))
        text = f"call {TYPES[result]} @{function.name}(" + ", ".join(f"{TYPES[a.kind]} {a.name}" for a in args) + ")"
        if result == "none":
            self.w.put(text)
            return Value("", "none")
        return Value(self.w.let(text), result)

    def converted(self, value: Value, kind: str) -> Value:
        """Return a value converted to a kind."""
        if value.kind == kind:
            return value
        if kind == "float" and value.kind == "int":
            if value.name.lstrip("-").isdigit():
                return Value(self.w.const(float(value.name)), "float")
            return Value(self.w.let(f"sitofp i64 {value.name} to double"), "float")
        if kind == "int" and value.kind == "float":
            return Value(self.w.let(f"fptosi double {value.name} to i64"), "int")
        if kind == "int" and value.kind == "bool":
            return Value(self.w.let(f"zext i1 {value.name} to i64"), "int")
        if kind == "bool" and value.kind == "int":
            return Value(self.w.let(f"icmp ne i64 {value.name}, 0"), "bool")
        raise TypeError(f"{self.source.name}: a value is {value.kind}, not {kind}")

    def refused(self, node: ast.AST) -> SyntaxError:
        """Return the error for text outside the subset."""
        return SyntaxError(f"{self.source.name}: cannot compile {ast.unparse(node)!r}")
