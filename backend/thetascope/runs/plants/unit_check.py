"""Check the dimensions of a plant's equations; the unit of each term follows from those of its quantities.

Units that are not known are named. A quantity without `unit` is not known, and neither is what it is multiplied with;
`unit: ""` means dimensionless. Numbers fit every term of a sum; as factors, those up to ten and their halves are pure
numbers, others may have a unit, as 1000 in v/1000. Neither is the unit known in which a formula wants the time t. Only
dimensions are compared, not prefixes: cm and m may be added, cm and s may not.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from thetascope.engine.errors import SpecError
from thetascope.engine.language.parser import Parsed, parse, sides
from thetascope.engine.language.syntax_tree import Node
from thetascope.messages import Message
from thetascope.records.columns.units import nearest_unit, per_second, scale_of
from thetascope_schemas.experiment.plant import Plant

Dimension = dict[str, float]
_PURE = 10.0  # integers and halves up to this are pure numbers
_SAME = (
    "abs",
    "floor",
    "min",
    "max",
    "clip",
    "deadzone",
    "play",
    "satplay",
)  # the result has the dimension of the arguments
_PLAIN = ("sign", "heaviside", "step", "atan2")  # a pure number, whatever the argument
_SHORT = {
    "meter": "m",
    "second": "s",
    "kilogram": "kg",
    "gram": "kg",  # only dimensions are written, and kg is the SI unit of mass
    "ampere": "A",
    "kelvin": "K",
    "mole": "mol",
    "candela": "cd",
}
_USUAL = ["N", "N·m", "W", "Pa", "V", "Ω", "C", "F", "H", "Wb", "T", "V/s", "A/s", "N/m", "N·s/m", "N·m·s", "W/K"]
"""Units in which a dimension is written where no quantity of the plant has it."""
_RAISED = str.maketrans("0123456789-.", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻·")


@dataclass(frozen=True)
class Mismatch:
    """A term whose dimension does not fit: its field, the text of the field, the term's place in it, and why."""

    field: str
    text: str
    start: int
    end: int
    problem: Message


def mismatches(plant: Plant) -> list[Mismatch]:
    """Return the terms of a plant whose dimensions do not fit; equations with unknown units are left out."""
    return list(_Checker(plant).check())


class _Checker:
    def __init__(self, plant: Plant) -> None:
        self.plant = plant
        self.found: list[Mismatch] = []
        self.written = _names_of(plant)
        self.units: dict[str, Dimension | None] = {"t": None, "pi": {}}
        groups = ("states", "inputs", "parameters", "signals", "algebraic")
        for item in (item for group in groups for item in getattr(plant, group)):
            self.units[item.name] = _declared(item)
        self.tables = {table.name: _declared(table) for table in plant.tables}
        self.field = self.text = ""

    def check(self) -> Iterator[Mismatch]:
        """Check all units, then all equations, each definition before what uses it."""
        yield from _unknown(self.plant)
        for index, one in enumerate(self.plant.definitions):
            self.units[one.name] = None
            self.units[one.name] = self._of(f"definitions[{index}].expression", one.expression)
        rate = {} if self.plant.time.kind == "discrete" else {"second": -1.0}
        wanted: dict[str, Dimension | None] = {}
        for state in self.plant.states:
            own = self.units[state.name]
            wanted[state.name] = None if own is None else _times(own, rate)
            self._needs(f"dynamics.{state.name}", self.plant.dynamics[state.name], wanted[state.name])
        for index, output in enumerate(self.plant.outputs):
            wanted[output.name] = _declared(output)
            self._needs(f"outputs[{index}].expression", output.expression, wanted[output.name])
        for index, item in enumerate(self.plant.algebraic):
            left, right = sides(item.equation)
            if right:
                self._needs(f"algebraic[{index}].equation", right, self._of(f"algebraic[{index}].equation", left))
        for index, channel in enumerate(self.plant.channels):
            unit = _declared(channel)
            for where, text in channel.enters.items():
                target = wanted.get(where)
                goal = None if unit is None or target is None else _times(target, unit, -1)
                self._needs(f"channels[{index}].enters.{where}", text, goal)
        yield from self.found

    def _of(self, field: str, text: str) -> Dimension | None:
        """Return the dimension of an expression; None if it is not known."""
        parsed = self._parsed(field, text)
        return None if parsed is None else self._node(parsed.tree)

    def _needs(self, field: str, text: str, wanted: Dimension | None) -> None:
        """Check an expression whose dimension is prescribed."""
        before = len(self.found)
        own = self._of(field, text)
        if own is None or wanted is None or len(self.found) > before or _equal(own, wanted) or _is_number(text):
            return
        inner = text.strip()
        start = text.index(inner)
        self._mismatch(start, start + len(inner), "workshop.unit.whole", own, wanted)

    def _parsed(self, field: str, text: str) -> Parsed | None:
        self.field, self.text = field, text
        try:
            return parse(text, self.units.keys() - {"pi"}, field, tables=self.tables)
        except SpecError:
            return None

    def _node(self, node: Node) -> Dimension | None:
        if node.value is not None:
            return {} if 2 * node.value == round(2 * node.value) and abs(node.value) <= _PURE else None
        if node.kind == "name":
            return self.units.get(node.name)
        parts = [None if arg.kind == "table" else self._node(arg) for arg in node.args]
        if node.kind == "sum":
            return self._same(node.args, parts)
        if node.kind == "product":
            return self._product(node, parts)
        if node.kind == "power":
            return self._power(node, parts)
        if node.kind == "call":
            return self._call(node, parts)
        self._same(node.args, parts)  # a comparison, or conditions that are joined
        return {}

    def _product(self, node: Node, parts: list[Dimension | None]) -> Dimension | None:
        result: Dimension = {}
        for sign, part in zip(node.signs, parts, strict=True):
            if part is None:
                return None
            result = _times(result, part, sign)
        return result

    def _power(self, node: Node, parts: list[Dimension | None]) -> Dimension | None:
        base, exponent = parts[0], node.args[1].value
        if parts[1]:
            self._plain(node.args[1], parts[1])
        if base is None or exponent is None:
            return base if base == {} else None
        return {name: power * exponent for name, power in base.items()}

    def _call(self, node: Node, parts: list[Dimension | None]) -> Dimension | None:
        name = node.name
        if name == "interp":
            table = node.args[-1].name
            return self.tables.get(table)
        if name == "sqrt":
            return None if parts[0] is None else {base: power / 2 for base, power in parts[0].items()}
        if name == "spow":
            return self._power(node, parts)
        if name in _SAME:
            return self._same(node.args, parts)
        if name == "where":
            return self._same(node.args[1:], parts[1:])
        if name == "backlash":
            return parts[0]
        if name == "boucwen":  # A v; β and γ have the units that make the other terms equal
            v, _, A, *_ = parts
            return None if v is None or A is None else _times(A, v, 1)
        if name not in _PLAIN:
            for arg, part in zip(node.args, parts, strict=True):
                if part:
                    self._plain(arg, part)
        return {}

    def _same(self, args: tuple[Node, ...], parts: list[Dimension | None]) -> Dimension | None:
        """Return the common dimension of terms; a number fits all of them, and the first known term sets it."""
        known = [(a, p) for a, p in zip(args, parts, strict=True) if p is not None and a.value is None]
        if not known:
            return None
        first = known[0][1]
        for arg, part in known[1:]:
            if not _equal(part, first):
                self._mismatch(arg.start, arg.end, "workshop.unit.term", part, first)
        return first

    def _plain(self, node: Node, own: Dimension) -> None:
        if any(own.values()):
            self._mismatch(node.start, node.end, "workshop.unit.argument", own, {})

    def _mismatch(self, start: int, end: int, code: str, own: Dimension, wanted: Dimension) -> None:
        problem = Message(code, own=self._unit(own), wanted=self._unit(wanted))
        self.found.append(Mismatch(self.field, self.text, start, end, problem))

    def _unit(self, dimension: Dimension) -> str:
        """Return a unit of a dimension, where possible as the plant writes it."""
        return self.written.get(_key(dimension)) or _written(dimension)


_Key = tuple[tuple[str, float], ...]
_GROUPS = ("states", "inputs", "outputs", "parameters", "signals", "algebraic", "references", "channels", "tables")


def _key(dimension: Dimension) -> _Key:
    return tuple(sorted((base, round(power, 6)) for base, power in dimension.items()))


def _names_of(plant: Plant) -> dict[_Key, str]:
    """Return a unit for each dimension of a plant's quantities and of the rates of its states."""
    items = [item for group in _GROUPS for item in getattr(plant, group)]
    units = [item.unit for item in items if item.unit]
    rates = [per_second(state.unit) for state in plant.states if state.unit]
    found: dict[_Key, str] = {(): "1"}
    for unit in (*units, *rates, *_USUAL):
        scale = scale_of(unit)
        if scale is not None:
            found.setdefault(_key(_without_angle(scale.dimension)), unit)
    return found


def _unknown(plant: Plant) -> Iterator[Mismatch]:
    """Yield the units that are not known."""
    for group in _GROUPS:
        for index, item in enumerate(getattr(plant, group)):
            if item.unit and scale_of(item.unit) is None:
                near = nearest_unit(item.unit)
                code = "workshop.unit.unknown-near" if near else "workshop.unit.unknown"
                problem = Message(code, own=item.unit, **({"near": near} if near else {}))
                yield Mismatch(f"{group}[{index}].unit", item.unit, 0, len(item.unit), problem)


def _without_angle(dimension: tuple[tuple[str, float], ...]) -> Dimension:
    return {base: power for base, power in dimension if base != "radian"}


def _declared(item: object) -> Dimension | None:
    """Return the dimension of a quantity; None where its unit is left out or not known."""
    if "unit" not in getattr(item, "model_fields_set", ()):
        return None
    scale = scale_of(getattr(item, "unit", ""))
    return None if scale is None else _without_angle(scale.dimension)


def _times(one: Mapping[str, float], other: Mapping[str, float], sign: float = 1) -> Dimension:
    powers = {base: one.get(base, 0.0) + sign * other.get(base, 0.0) for base in {*one, *other}}
    return {base: power for base, power in powers.items() if abs(power) > 1e-9}


def _equal(one: Dimension, other: Dimension) -> bool:
    return not _times(one, other, -1)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _written(dimension: Dimension) -> str:
    """Return a dimension in SI units, as m²/s; 1 for a pure number."""

    def one(base: str, power: float) -> str:
        raised = "" if power == 1 else f"{power:g}".translate(_RAISED)
        return f"{_SHORT.get(base, base)}{raised}"

    above = "·".join(one(base, power) for base, power in sorted(dimension.items()) if power > 0)
    divisors = [one(base, -power) for base, power in sorted(dimension.items()) if power < 0]
    below = divisors[0] if len(divisors) == 1 else f"({'·'.join(divisors)})"
    return f"{above or '1'}/{below}" if divisors else above or "1"
