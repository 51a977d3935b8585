"""The equations of a plant as MathML, in the order in which its author wrote them.

The MathML is written from the parser's tree (parser.py), which is also the source of the running program. SymPy would
sort terms and split roots, but a reader wants to recognise the equation of the paper. Not importing SymPy also saves
time.
"""

from collections.abc import Iterable, Iterator, Mapping
from html import escape

from thetascope.engine.language.lexer import CONSTANTS
from thetascope.engine.language.parser import Node, Parsed, parse, sides
from thetascope.engine.language.render.mathml_symbols import DOT, is_word, symbol

NAMED = {
    "log": "ln",
    "asin": "arcsin",
    "acos": "arccos",
    "atan": "arctan",
    "sign": "sgn",
    "backlash": "play",
    "clip": "sat",
    "deadzone": "dz",
    "satplay": "satplay",
    "boucwen": "BW",
}
TIGHT, LOOSE = '<mspace width="0.14em"/>', '<mspace width="0.28em"/>'
MINUS, EQUALS = "<mo>−</mo>", "<mo>=</mo>"


def row(*inner: str, css: str = "") -> str:
    """Return parts side by side as one row; `css` is its class."""
    return f"<mrow{f' class={chr(34)}{css}{chr(34)}' if css else ''}>{''.join(inner)}</mrow>"


def fenced(inner: str, left: str = "(", right: str = ")") -> str:
    """Return MathML between brackets that stretch with it."""
    return row(f'<mo fence="true" form="prefix">{left}</mo>', inner, f'<mo fence="true" form="postfix">{right}</mo>')


def math(inner: str) -> str:
    """Return a complete display formula."""
    return f'<math xmlns="http://www.w3.org/1998/Math/MathML" display="block">{row(inner)}</math>'


class Writer:
    """Writer of one checked expression as MathML; each kind of node has a method of that name."""

    def __init__(self, parsed: Parsed) -> None:
        self.parsed = parsed

    def write(self) -> str:
        """Return the MathML of the whole expression."""
        return self.of(self.parsed.tree)

    def of(self, node: Node) -> str:
        """Return the MathML of a node."""
        return getattr(self, node.kind)(node)

    def number(self, node: Node) -> str:
        """Return a number as it was typed; 2e-3 becomes 2·10⁻³."""
        text = self.parsed.text[node.start : node.end]
        mantissa, e, power = text.lower().partition("e")
        if text in CONSTANTS:
            return "<mi>π</mi>"
        if not e:
            return f"<mn>{escape(text)}</mn>"
        sign = MINUS if power.startswith("-") else ""
        ten = f"<msup><mn>10</mn><mrow>{sign}<mn>{power.lstrip('+-')}</mn></mrow></msup>"
        return ten if mantissa in ("1", "1.0") else row(f"<mn>{mantissa}</mn><mo>·</mo>{ten}")

    def name(self, node: Node) -> str:
        """Return a name as its symbol."""
        return symbol(node.name)

    def sum(self, node: Node) -> str:
        """Return a sum, with minus signs in place of negative factors."""
        out = []
        for place, (sign, arg) in enumerate(zip(node.signs, node.args, strict=True)):
            sign, arg = signed(arg, sign)
            inner = self.of(arg)
            if arg.kind == "sum" and (place or sign < 0):
                inner = fenced(inner)
            out.append((MINUS if sign < 0 else "<mo>+</mo>" if place else "") + inner)
        return row(*out)

    def product(self, node: Node) -> str:
        """Return a product: all divisors in one denominator, and the minus sign of the first factor in front."""
        sign, node = signed(node, 1)
        above = [arg for s, arg in zip(node.signs, node.args, strict=True) if s > 0]
        below = [arg for s, arg in zip(node.signs, node.args, strict=True) if s < 0]
        top = self.factors(above)
        whole = f"<mfrac>{top}{self.factors(below)}</mfrac>" if below else top
        return row(MINUS, whole) if sign < 0 else whole

    def factors(self, args: list[Node]) -> str:
        """Return factors side by side, with a dot before digits and more space beside words."""
        if len(args) == 1:
            return row(self.of(args[0]))
        out = []
        for place, arg in enumerate(args):
            if place:
                loose = any(a.kind == "name" and is_word(a.name) for a in (arg, args[place - 1]))
                digits = first(arg).kind == "number" and first(arg).value is not None
                out.append("<mo>·</mo>" if digits else LOOSE if loose else TIGHT)
            out.append(fenced(self.of(arg)) if arg.kind == "sum" else self.of(arg))
        return row(*out)

    def power(self, node: Node) -> str:
        """Return a power; with the exponent ½ a square root."""
        base, exponent = node.args
        if exponent.value == 0.5:
            return f"<msqrt>{self.of(base)}</msqrt>"
        below = self.of(base)
        if base.kind not in ("name", "number") and not (base.kind == "call" and base.name == "abs"):
            below = fenced(below)
        return f"<msup>{row(below)}{row(self.of(exponent))}</msup>"

    def call(self, node: Node) -> str:
        """Return a function call, by the method `call_<function>` if there is one."""
        written = getattr(self, f"call_{node.name}", None)
        if written:
            return written(*node.args)
        inner = "<mo>,</mo>".join(self.of(arg) for arg in node.args)
        return row(f"<mi>{NAMED.get(node.name, node.name)}</mi><mo>&#x2061;</mo>", fenced(inner))

    def call_sqrt(self, arg: Node) -> str:
        """Return a square root."""
        return f"<msqrt>{self.of(arg)}</msqrt>"

    def call_abs(self, arg: Node) -> str:
        """Return an absolute value between bars."""
        return fenced(self.of(arg), "|", "|")

    def call_floor(self, arg: Node) -> str:
        """Return ⌊x⌋."""
        return fenced(self.of(arg), "⌊", "⌋")

    def call_exp(self, arg: Node) -> str:
        """Return a power of e."""
        return f"<msup><mi>e</mi>{row(self.of(arg))}</msup>"

    def call_spow(self, base: Node, exponent: Node) -> str:
        """Return ⌊x⌉ to a power."""
        return f"<msup>{fenced(self.of(base), '⌊', '⌉')}{row(self.of(exponent))}</msup>"

    def call_interp(self, arg: Node, table: Node) -> str:
        """Return a table as a function."""
        return row(symbol(table.name), "<mo>&#x2061;</mo>", fenced(self.of(arg)))

    def call_where(self, condition: Node, a: Node, b: Node) -> str:
        """Return two cases with a brace."""
        cells = (self.of(a), row("<mtext>if </mtext>", self.of(condition))), (self.of(b), "<mtext>otherwise</mtext>")
        lines = "".join(f"<mtr><mtd>{value}</mtd><mtd>{when}</mtd></mtr>" for value, when in cells)
        return row('<mo fence="true" form="prefix">{</mo>', f'<mtable class="cases">{lines}</mtable>')

    def less(self, node: Node) -> str:
        """Return a < b."""
        return row(self.of(node.args[0]), "<mo>&lt;</mo>", self.of(node.args[1]))

    def less_equal(self, node: Node) -> str:
        """Return a ≤ b."""
        return row(self.of(node.args[0]), "<mo>≤</mo>", self.of(node.args[1]))

    def joined(self, node: Node, sign: str) -> str:
        """Return conditions joined by ∧ or ∨, with brackets around nested ones."""
        return row(
            f"<mo>{sign}</mo>".join(fenced(self.of(a)) if a.kind in ("and", "or") else self.of(a) for a in node.args)
        )


setattr(Writer, "and", lambda self, node: self.joined(node, "∧"))
setattr(Writer, "or", lambda self, node: self.joined(node, "∨"))


def signed(node: Node, sign: int) -> tuple[int, Node]:
    """Return the sign of a term and the term without its leading minus: −a·b is parsed as (−a)·b."""
    from dataclasses import replace

    if node.kind == "sum" and len(node.args) == 1:
        return signed(node.args[0], sign * node.signs[0])
    if node.kind == "product":
        inner, head = signed(node.args[0], 1)
        if inner < 0:
            return -sign, replace(node, args=(head, *node.args[1:]))
    return sign, node


def first(node: Node) -> Node:
    """Return the first operand of a factor."""
    return first(node.args[0]) if node.kind in ("product", "power") and node.signs[:1] != (-1,) else node


# ---- a whole plant -------------------------------------------------------------------------------------------


def expression(text: str, names: Iterable[str], field: str = "expression", tables: Iterable[str] = ()) -> str:
    """Return the text of an expression as MathML. Raises ExpressionError with the position in the text."""
    return Writer(parse(text, names, field, tables=tables)).write()


def plant_equations(data: Mapping) -> dict[str, list[dict[str, str]]]:
    """Return the equations of a plant, with the terms of its faults.

    Args:
        data: the plant as plain data (the dump of thetascope_schemas' Plant).

    Returns:
        ``states``, ``definitions``, ``outputs``, ``controllers``: for each equation ``name``, ``unit``, ``description``
        and ``math``, MathML in which the term of a fault (a column of Φ or Ψ times θ) has the class ``fault``.

    Raises:
        ExpressionError: with the position in the text.
    """
    tables = [item["name"] for item in data.get("tables", ())]
    groups = ("states", "inputs", "signals", "parameters", "algebraic")
    names = ["t"] + [item["name"] for group in groups for item in data.get(group, ())]
    definitions = []
    for index, item in enumerate(data["definitions"]):
        text = expression(item["expression"], names, f"definitions.{index}.expression", tables)
        definitions.append(_line(item, symbol(item["name"]) + EQUALS + text))
        names.append(item["name"])
    definitions += [_implicit(i, item, names, tables) for i, item in enumerate(data.get("algebraic", ()))]
    definitions += [line for i, event in enumerate(data.get("events", ())) for line in _event(i, event, names, tables)]
    discrete = data["time"]["kind"] == "discrete"
    states, outputs = [], []
    for item in data["states"]:
        text = expression(data["dynamics"][item["name"]], names, f"dynamics.{item['name']}", tables)
        states.append(_line(item, _rate(item["name"], discrete) + EQUALS + text + _faults(data, item["name"], names)))
    for index, item in enumerate(data["outputs"]):
        text = expression(item["expression"], names, f"outputs.{index}.expression", tables)
        outputs.append(_line(item, symbol(item["name"]) + EQUALS + text + _faults(data, item["name"], names)))
    controllers = [line for i in range(len(data.get("controllers", ()))) for line in _controller(data, i, tables)]
    return {"states": states, "definitions": definitions, "outputs": outputs, "controllers": controllers}


def _controller(data: Mapping, index: int, tables: Iterable[str]) -> Iterator[dict[str, str]]:
    """Yield the definitions, laws and states of a controller; the first line has its title."""
    controller, field = data["controllers"][index], f"controllers.{index}"
    groups = ("outputs", "inputs", "signals", "parameters", "references")
    names = ["t"] + [item["name"] for group in groups for item in data.get(group, ())]
    names += [item["name"] for one in data["controllers"] for item in one["states"]]
    title = {"description": controller.get("title") or controller["name"]}
    for j, item in enumerate(controller["definitions"]):
        text = expression(item["expression"], names, f"{field}.definitions.{j}.expression", tables)
        yield _line({**item, **title}, symbol(item["name"]) + EQUALS + text)
        title = {}
        names.append(item["name"])
    units = {item["name"]: item.get("unit", "") for item in data["inputs"]}
    for j, item in enumerate(controller["outputs"]):
        text, (low, high) = item["expression"], item["saturation"]
        text = text if low is None else f"max({text}, {low})"
        text = text if high is None else f"min({text}, {high})"
        right = expression(text, names, f"{field}.outputs.{j}.expression", tables)
        line = {"name": item["input"], "unit": units[item["input"]], **title}
        yield _line(line, symbol(item["input"]) + EQUALS + right)
        title = {}
    steps = controller["period"] is not None or data["time"]["kind"] == "discrete"
    for item in controller["states"]:
        text = controller["dynamics"][item["name"]]
        right = expression(text, names, f"{field}.dynamics.{item['name']}", tables)
        yield _line(item, _rate(item["name"], steps) + EQUALS + right)


def _implicit(index: int, item: Mapping, names: Iterable[str], tables: Iterable[str]) -> dict[str, str]:
    """Return the equation that determines an algebraic variable."""
    field = f"algebraic.{index}.equation"
    left, right = (expression(s, names, field, tables) if s else "<mn>0</mn>" for s in sides(item["equation"]))
    return _line(item, left + EQUALS + right)


def _event(index: int, event: Mapping, names: Iterable[str], tables: Iterable[str]) -> list[dict[str, str]]:
    """Return the new value of each state that an event changes, with its condition: x⁺ = … if …."""
    parsed = parse(event["when"], names, f"events.{index}.when", tables=tables, condition=True)
    condition = row("<mspace width='1em'/>", "<mtext>if </mtext>", Writer(parsed).write())
    lines = []
    for name, text in event["set"].items():
        value = expression(str(text), names, f"events.{index}.set.{name}", tables)
        lines.append(_line({"name": name}, f"<msup>{symbol(name)}<mo>+</mo></msup>" + EQUALS + value + condition))
    return lines


def _line(item: Mapping, inner: str) -> dict[str, str]:
    return {
        "name": item["name"],
        "unit": item.get("unit", ""),
        "description": item.get("description", ""),
        "math": math(inner),
    }


def _rate(name: str, discrete: bool) -> str:
    """Return the left-hand side of a state equation: ẋ, dx/dt if the name is a word, x⁺ in discrete time."""
    if discrete:
        return f"<msup>{symbol(name)}<mo>+</mo></msup>"
    if is_word(name):
        d = "<mi mathvariant='normal'>d</mi>"
        return f"<mfrac><mrow>{d}{TIGHT}{symbol(name)}</mrow><mrow>{d}<mi>t</mi></mrow></mfrac>"
    return symbol(name, DOT)


def _faults(data: Mapping, where: str, names: Iterable[str]) -> str:
    """Return + coefficient·θ for every channel that enters the equation of `where`."""
    out = []
    for index, channel in enumerate(data["channels"]):
        if where not in channel["enters"]:
            continue
        tables = [table["name"] for table in data.get("tables", ())]
        parsed = parse(str(channel["enters"][where]), names, f"channels.{index}.enters.{where}", tables=tables)
        sign, node = signed(parsed.tree, 1)
        sign = -1 if node.value is not None and node.value < 0 else sign
        writer, theta = Writer(parsed), symbol(channel["name"])
        one = node.value is not None and abs(node.value) == 1
        coefficient = fenced(writer.of(node)) if node.kind == "sum" and len(node.args) > 1 else writer.of(node)
        inner = theta if one else row(coefficient, LOOSE if is_word(channel["name"]) else TIGHT, theta)
        out.append(row(f'<mo form="infix">{"−" if sign < 0 else "+"}</mo>', inner, css="fault"))
    return "".join(out)
