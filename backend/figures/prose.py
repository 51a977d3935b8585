"""The parts of the report that are words, equations and tables. Every text from outside goes through `escape`."""

from collections.abc import Iterable, Mapping

import numpy as np

from .scene import Scene
from .symbols import escape, expression, symbol


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
    body = "".join(f"<tr><th scope=row>{row[0]}</th>" + "".join(cell("td", k, c) for k, c in enumerate(row[1:], 1)) + "</tr>"
                   for row in rows)
    return f"<div class=wide><table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table></div>"


def equations(plant) -> str:
    """The plant's equations, faults in amber where they enter, then the definitions and outputs."""
    discrete = plant.time.kind == "discrete"
    lines = []
    for state in plant.states:
        left = symbol(state.name) + ("<sup>+</sup>" if discrete else "′")
        lines.append((left, expression(plant.dynamics[state.name]) + _faults(plant, state.name, ("actuator", "process")), ""))
    for item in plant.definitions:
        lines.append((symbol(item.name), expression(item.expression), _range(item.domain)))
    for item in plant.outputs:
        lines.append((symbol(item.name), expression(item.expression) + _faults(plant, item.name, ("sensor",)), escape(item.unit)))
    rows = "".join(f"<dt>{left}</dt><dd>= {right}{f'<span class=note>{note}</span>' if note else ''}</dd>"
                   for left, right, note in lines)
    step = f"<p class=soft>Discrete time, period {number(plant.time.period)} s; ⁺ is the next sample.</p>" if discrete else ""
    return f"<dl class=eq>{rows}</dl>{step}"


def _range(domain: tuple) -> str:
    low, high = domain
    if low is None and high is None:
        return ""
    low, high = (open_ if limit is None else symbol(limit) if isinstance(limit, str) else number(limit)
                 for limit, open_ in ((low, "−∞"), (high, "∞")))
    return f"within [{low}, {high}] for observers"


def _faults(plant, equation: str, kinds: tuple[str, ...]) -> str:
    text = ""
    for channel in plant.channels:
        if channel.kind in kinds and equation in channel.enters:
            coefficient = channel.enters[equation].strip()
            factor = "" if coefficient == "1" else expression(coefficient if _simple(coefficient) else f"({coefficient})") + "\u2009"
            text += f"<span class=th> + {factor}{symbol(channel.name)}</span>"
    return text


def _simple(text: str) -> bool:
    return text.replace("_", "").isalnum()


def quantities(plant, spec) -> str:
    """Parameters in effect, initial state, and what each fault channel means."""
    parameters = [f"{symbol(p.name)} = {number(spec.parameters.get(p.name, p.value), 6)}{unit(p.unit)}" for p in plant.parameters]
    initial = [f"{symbol(s.name)}(0) = {number(spec.initial.get(s.name, s.initial), 6)}{unit(s.unit)}" for s in plant.states]
    rows = [f"<p><span class=soft>{word}:</span> {', '.join(items)}</p>"
            for word, items in (("Parameters", parameters), ("Start", initial)) if items]
    channels = [[symbol(c.name), escape(c.title or c.description), escape(c.kind), escape(c.unit)] for c in plant.channels]
    return "".join(rows) + (table(["fault", "meaning", "kind", "unit"], channels, 0) if channels else "")


def unit(text: str) -> str:
    return f"\u2009{escape(text)}" if text else ""


def timeline(scene: Scene) -> str:
    """Faults in the order of their onset, and the noise."""
    rows = []
    for fault in sorted(scene.spec.faults, key=lambda fault: fault.onset):
        name = getattr(fault, "channel", None) or fault.output
        kind = "theta" if getattr(fault, "channel", None) else "y"
        known = {"channel", "output", "shape", "onset", "end"}
        details = ", ".join(f"{escape(key.replace('_', ' '))} {_brief(getattr(fault, key))}"
                            for key in type(fault).model_fields if key not in known)
        end = "" if fault.end is None else number(fault.end, 6)
        rows.append([symbol(name), escape(fault.shape), details + unit(scene.unit(kind, name)) * ("size" in details),
                     number(fault.onset, 6), end or "stays"])
    noise = [f"{symbol(name)}: std {number(item.std)}, held for {number(item.sample_time)} s"
             for name, item in scene.spec.noise.items()]
    text = table(["fault on", "shape", "", "from (s)", "until (s)"], rows, 2) if rows else "<p>No faults.</p>"
    return text + f"<p class=soft>Measurement noise: {'; '.join(noise) if noise else 'none'}.</p>"


def _brief(value: object) -> str:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return f"{len(value)} points" if isinstance(value, tuple | list) else escape(value)
    return number(value, 6)


def comparison(scene: Scene, summary: Mapping[str, dict]) -> str:
    """The observers side by side: RMSE of each state, final θ̂ against θ, settling after each step, divergence."""
    states = [s.name for s in scene.plant.states]
    shown = [s for s in states if any(s in entry["rmse"] for entry in summary.values())]
    head = ["observer", *(f"RMSE {symbol(s)}{_in(scene.unit('x', s))}" for s in shown)]
    rows = [[_chip(scene, label), *(number(entry["rmse"].get(s)) for s in shown)] for label, entry in summary.items()]
    out = table(head, rows, len(shown)) + "<p class=soft>Root mean square error over the whole run, start included.</p>"
    final = [[_chip(scene, label), _hat(name) + _in(scene.unit("theta", name)), number(v["truth"]), number(v["estimate"]),
              number(v["error"]), number(v["mean_error"]), number(v["std"])]
             for label, entry in summary.items() for name, v in entry["theta"].items()]
    if final:
        out += table(["observer", "at the end", "true", "estimate", "error", "mean error", "scatter"], final, 5)
        out += "<p class=soft>Mean error and scatter (standard deviation) are over the last tenth of the run.</p>"
    steps = [[_chip(scene, label), symbol(s["channel"]), number(s["at"], 6), number(s["size"]),
              "never" if s["reached"] is None else f"{s['reached']:.3f}", _settled(s)]
             for label, entry in summary.items() for s in entry["settling"]]
    if steps:
        out += table(["observer", "step of", "at (s)", "size", "within 10 % after (s)", "stays so after (s)"], steps, 4)
    return out


def _settled(entry: dict) -> str:
    return f"{entry['time']:.3f}" if entry["time"] is not None else "does not"


def _hat(name: str) -> str:
    """θ̂: browsers place the hat by style sheet, better than fonts place the combining one."""
    return symbol(name).replace("<i>", "<i class=hat>", 1)


def _in(text: str) -> str:
    return f" <span class=soft>({escape(text)})</span>" if text else ""


def _chip(scene: Scene, label: str) -> str:
    return f"<span class=chip style='background:{scene.colour(label)}'></span><b>{escape(label)}</b>"


def observers(scene: Scene, summary: Mapping[str, dict]) -> str:
    """Each observer: kind, gains, what it reports, how its theorem's assumptions fare here."""
    configured = {config.label: config for config in scene.spec.observers}
    return "".join(_observer(scene, report, configured[report.label]) for report in scene.result.observers)


def _observer(scene: Scene, report, config) -> str:
    gains = [f"{symbol(name)} = {_value(value)}" for name, value in config.gains.items()]
    gains += [f"{escape(name)}: {escape(value)}" for name, value in config.options.items()]
    facts = [f"{escape(str(name).replace('_', ' '))}: {_value(value)}" for name, value in report.facts.items()]
    out = f"<h3>{_chip(scene, report.label)} <span class=soft>{escape(report.title or report.kind)}</span></h3>"
    out += f"<p><span class=soft>Gains:</span> {', '.join(gains) or 'the defaults'}</p>"
    if report.diverged:
        out += f"<p class=alarm>Diverged at {number(report.diverged.time)} s: {escape(report.diverged.cause)}</p>"
    if facts:
        out += f"<details><summary class=soft>What it computed from them</summary><p>{'<br>'.join(facts)}</p></details>"
    rows = [[f"<b>{escape(c.name.replace('-', ' '))}</b>", f"<span class='verdict {_verdict(c.verdict)}'>{escape(c.verdict)}</span>",
             escape(c.text) + (f" <span class=soft>{escape(c.source)}</span>" if c.source else ""),
             number(c.value), number(c.threshold)] for c in report.checks]
    return out + (table(["assumption", "here", "", "found", "against"], rows, 2) if rows else "")


def _verdict(verdict: str) -> str:
    return verdict if verdict in ("holds", "fails") else "unknown"


def _value(value: object) -> str:
    """A gain or fact: a number, a list or matrix of numbers, or a text."""
    if isinstance(value, bool | str) or value is None:
        return escape(value)
    if isinstance(value, int | float | np.number):
        return number(float(value), 6)
    if isinstance(value, np.ndarray | list | tuple) and all(isinstance(v, int | float | np.number) for v in value):
        return "(" + ", ".join(number(float(v), 5) for v in value) + ")"
    return escape(value if not isinstance(value, np.ndarray) else value.tolist())
