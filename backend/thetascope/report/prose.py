"""The parts of the report that are words, equations and tables. Every text from outside goes through `escape`."""

from collections.abc import Iterable

import numpy as np

from thetascope.figures.figure_data import Scene
from thetascope.figures.html_symbols import escape, expression, symbol


def number(value: float | None, digits: int = 4) -> str:
    """A number for a table; a dash for what there is none of."""
    if value is None or not np.isfinite(value):
        return "–"
    if value == 0:
        return "0"
    text = f"{value:.{digits}g}"
    if "e" in text:
        mantissa, power = text.split("e")
        text = f"{mantissa}·10<sup>{int(power)}</sup>"
    return text.replace("-", "−")


def table(head: Iterable[str], rows: Iterable[Iterable[str]], numeric: int) -> str:
    """An HTML table; cells are HTML. The first cell of a row is its heading, the last `numeric` cells are numbers."""
    head, rows = list(head), [list(row) for row in rows]
    first = len(head) - numeric

    def cell(tag: str, place: int, text: str) -> str:
        return f"<{tag}{' class=n' if place >= first else ''}>{text}</{tag}>"

    top = "".join(cell("th", place, text) for place, text in enumerate(head))
    body = "".join(
        f"<tr><th scope=row>{row[0]}</th>" + "".join(cell("td", k, c) for k, c in enumerate(row[1:], 1)) + "</tr>"
        for row in rows
    )
    return f"<div class=wide><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>"


def equations(plant) -> str:
    """The plant's equations, faults in amber where they enter, then the definitions and outputs."""
    discrete = plant.time.kind == "discrete"
    lines = []
    for state in plant.states:
        left = symbol(state.name) + ("<sup>+</sup>" if discrete else "′")
        lines.append(
            (left, expression(plant.dynamics[state.name]) + _faults(plant, state.name, ("actuator", "process")), "")
        )
    lines += [(symbol(d.name), expression(d.expression), _range(d.domain)) for d in plant.definitions]
    lines += [
        (symbol(y.name), expression(y.expression) + _faults(plant, y.name, ("sensor",)), escape(y.unit))
        for y in plant.outputs
    ]
    rows = "".join(
        f"<dt>{left}</dt><dd>= {right}{f'<span class=note>{note}</span>' if note else ''}</dd>"
        for left, right, note in lines
    )
    step = (
        f"<p class=soft>Discrete time, period {number(plant.time.period)} s; ⁺ is the next sample.</p>"
        if discrete
        else ""
    )
    return f"<dl class=eq>{rows}</dl>{step}"


def _range(domain: tuple) -> str:
    low, high = domain
    if low is None and high is None:
        return ""
    low, high = (
        open_ if limit is None else symbol(limit) if isinstance(limit, str) else number(limit)
        for limit, open_ in ((low, "−∞"), (high, "∞"))
    )
    return f"within [{low}, {high}] for observers"


def _faults(plant, equation: str, kinds: tuple[str, ...]) -> str:
    text = ""
    for channel in plant.channels:
        if channel.kind in kinds and equation in channel.enters:
            coefficient = channel.enters[equation].strip()
            factor = (
                ""
                if coefficient == "1"
                else expression(coefficient if _simple(coefficient) else f"({coefficient})") + "\u2009"
            )
            text += f"<span class=th> + {factor}{symbol(channel.name)}</span>"
    return text


def _simple(text: str) -> bool:
    return text.replace("_", "").isalnum()


def quantities(plant, spec) -> str:
    """Parameters in effect, initial state, and what each fault channel means."""
    parameters = [
        f"{symbol(p.name)} = {number(spec.parameters.get(p.name, p.value), 6)}{unit(p.unit)}" for p in plant.parameters
    ]
    initial = [
        f"{symbol(s.name)}(0) = {number(spec.initial.get(s.name, s.initial), 6)}{unit(s.unit)}" for s in plant.states
    ]
    rows = [
        f"<p><span class=soft>{word}:</span> {', '.join(items)}</p>"
        for word, items in (("Parameters", parameters), ("Start", initial))
        if items
    ]
    channels = [
        [symbol(c.name), escape(c.title or c.description), escape(c.kind), escape(c.unit)] for c in plant.channels
    ]
    return "".join(rows) + (table(["fault", "meaning", "kind", "unit"], channels, 0) if channels else "")


def unit(text: str) -> str:
    """Return a unit as HTML after a thin space; nothing where there is none."""
    return f"\u2009{escape(text)}" if text else ""


def timeline(scene: Scene) -> str:
    """Faults in the order of their onset, and the noise."""
    rows = []
    for fault in sorted(scene.spec.faults, key=lambda fault: fault.onset):
        known = {"channel", "output", "shape", "onset", "end"}
        details = ", ".join(
            f"{escape(key.replace('_', ' '))} {_brief(getattr(fault, key))}"
            for key in type(fault).model_fields
            if key not in known
        )
        end = "" if fault.end is None else number(fault.end, 6)
        rows.append(
            [
                symbol(fault.site.name),
                escape(fault.shape),
                details + unit(scene.unit(fault.site.prefix, fault.site.name)) * ("size" in details),
                number(fault.onset, 6),
                end or "stays",
            ]
        )
    noise = [
        f"{symbol(name)}: std {number(item.std)}, held for {number(item.sample_time)} s"
        for name, item in scene.spec.noise.items()
    ]
    text = table(["fault on", "shape", "", "from (s)", "until (s)"], rows, 2) if rows else "<p>No faults.</p>"
    return text + f"<p class=soft>Measurement noise: {'; '.join(noise) if noise else 'none'}.</p>"


def _brief(value: object) -> str:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return f"{len(value)} points" if isinstance(value, tuple | list) else escape(value)
    return number(value, 6)


def hat(name: str) -> str:
    """θ̂: browsers place the hat by style sheet, better than fonts place the combining one."""
    return symbol(name).replace("<i>", "<i class=hat>", 1)


def bracketed(text: str) -> str:
    """A unit in the head of a column."""
    return f" <span class=soft>({escape(text)})</span>" if text else ""


def chip(scene: Scene, label: str) -> str:
    """An observer's name with its colour; the detector has none."""
    if label not in scene.labels:
        return f"<span class=who><b>{escape(label)}</b></span>"
    return f"<span class=who><span class=chip style='background:{scene.colour(label)}'></span><b>{escape(label)}</b></span>"


def span(low: float | None, high: float | None, digits: int = 4) -> str:
    """An interval in brackets, nothing where there is none."""
    if low is None or high is None:
        return ""
    return f" <span class=soft>({number(low, digits)} to {number(high, digits)})</span>"
