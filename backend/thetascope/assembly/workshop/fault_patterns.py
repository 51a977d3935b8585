"""Faults that may act in an equation of a plant: loss, leak, bias, gain, lag, each as a channel ready to be added."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from thetascope.assembly.workshop.trial_experiment import nice, trial_experiment
from thetascope.engine.errors import SpecError
from thetascope.engine.language.lazy_sympy import sympy
from thetascope.engine.language.parser import parse
from thetascope.engine.language.render.mathml import expression, math, row
from thetascope.engine.language.render.mathml_symbols import symbol
from thetascope.engine.model.plant_model import Model
from thetascope.messages import Message
from thetascope.records.columns.units import per_second
from thetascope_schemas.experiment.plant import Plant

_SHARE = 0.1  # usual size of a loss or of a wrong gain
_OFFSET = 0.05  # usual size of a bias, as a share of what the quantity covers
_MOST_SUMMANDS, _LONGEST_SUMMAND = 6, 40
_SLOW = 0.02  # time constant of a lag, as a share of the experiment
_PRINTED = {"Abs": "abs", "Max": "max", "Min": "min"}


@dataclass(frozen=True)
class Pattern:
    """A fault in an equation.

    Args:
        pattern: loss, leak, bias, gain or lag.
        term: the quantity that is disturbed; "" if it is the whole equation.
        about: what happens, in a sentence.
        math: the term with θ as MathML.
        channel: the channel as data of a plant.
        conserved: coefficients of θ in the other equations that contain the term, so that nothing vanishes; by state.
        states, parameters, equations: what a lag needs beside the channel.
    """

    pattern: str
    term: str
    about: Message
    math: str
    channel: dict[str, Any]
    conserved: dict[str, str] = field(default_factory=dict)
    states: list[dict[str, Any]] = field(default_factory=list)
    parameters: list[dict[str, Any]] = field(default_factory=list)
    equations: dict[str, str] = field(default_factory=dict)


def fault_patterns(plant: Plant, name: str) -> list[Pattern]:
    """Return the faults that may act in the equation of a state or output. Raises SpecError for another name."""
    states, outputs = plant.names("states"), plant.names("outputs")
    if name not in (*states, *outputs):
        raise SpecError("name", name, Message("workshop.pattern.no-equation", name=name[:40]))
    work = _Patterns(plant)
    patterns = work.of_state(name) if name in states else work.of_output(name)
    return [pattern for pattern in patterns if work.is_readable(pattern)]


class _Patterns:
    def __init__(self, plant: Plant) -> None:
        self.plant, self.data = plant, plant.model_dump(mode="json")
        self.model = Model(self.data)
        self.spec = trial_experiment(plant)
        self.declared = {name for _, name in plant.declared()}
        self.symbols = {s.name: s for s in (*self.model.u, *(d.symbol for d in self.model.definitions))}

    def of_state(self, name: str) -> Iterator[Pattern]:
        """Yield the faults in the equation of a state."""
        index = self.model.states.index(name)
        state, right = self.plant.states[index], self.model.f[index]
        terms = [s for s in self.symbols.values() if s in right.free_symbols]
        for term in terms:
            yield from self._loss(name, term)
        summands = self._summands(name, terms)
        for shown, value in summands:
            yield self._pattern("loss", shown, {name: _text(-value)}, "process", _SHARE, bounds=[0, 1])
        yield from self._leak(name, terms)
        rate = 1 / self.spec.horizon * 10
        size = nice(_OFFSET * self._cover(index) * (1 if self.model.period else rate))
        unit = state.unit if self.model.period else per_second(state.unit)
        yield self._pattern("bias", "", {name: "1"}, "process", size, unit=unit[:32])
        yield self._pattern("gain", "", {name: " ".join(self.data["dynamics"][name].split())}, "process", _SHARE)
        if self.model.period is None:
            for term in terms:
                yield from self._lag(name, term)
            for shown, value in summands:
                yield self._with_lag(
                    name, shown, _text(value), f"{{lag}} - {_bracketed(_text(value))}", "process", unit
                )

    def of_output(self, name: str) -> Iterator[Pattern]:
        """Yield the faults of a sensor."""
        output = self.plant.outputs[self.plant.names("outputs").index(name)]
        text = " ".join(output.expression.split())
        size = nice(10 * self.spec.noise[name].std)
        yield self._pattern("bias", name, {name: "1"}, "sensor", size, unit=output.unit)
        yield self._pattern("gain", name, {name: text}, "sensor", _SHARE)
        if self.model.period is None:
            yield self._with_lag(name, name, text, f"{{lag}} - {_bracketed(text)}", "process", output.unit)
        yield self._pattern("loss", name, {name: f"-{_bracketed(text)}"}, "sensor", 1.0, bounds=[0, 1])

    def _loss(self, name: str, term: Any) -> Iterator[Pattern]:
        """Yield a loss of a share of a term, with what keeps it in the other equations."""
        coefficient = self._coefficient(name, term)
        if coefficient is None:
            return
        others = {s: c for s in self.model.states if s != name and (c := self._coefficient(s, term)) is not None}
        conserved = {s: _text(-c * term) for s, c in others.items()}
        kind = "actuator" if term.name in self.model.inputs else "process"
        enters = {name: _text(-coefficient * term)}
        yield self._pattern("loss", term.name, enters, kind, _SHARE, bounds=[0, 1], conserved=conserved)

    def _summands(self, name: str, terms: list[Any]) -> list[tuple[str, Any]]:
        """Return the summands of the equation of a state that contain none of its inputs and definitions.

        Each is a text without a sign, as the viewer reads it, and the summand itself.
        """
        right = sympy.expand(self.model.f[self.model.states.index(name)])
        found = [one for one in right.as_ordered_terms() if one.free_symbols and not one.free_symbols & set(terms)]
        pairs = [(_text(-one if one.could_extract_minus_sign() else one), one) for one in found]
        short = all(len(text) <= _LONGEST_SUMMAND for text, _ in pairs)
        return pairs if short and len(pairs) <= _MOST_SUMMANDS else []

    def _leak(self, name: str, terms: list[Any]) -> Iterator[Pattern]:
        """Yield a hole of a store that cannot be negative: a flow by its level."""
        state = next(s for s in self.plant.states if s.name == name)
        if state.domain[0] != 0 or self.model.period is not None:
            return
        coefficient = next((c for t in terms if (c := self._coefficient(name, t)) is not None), None)
        flow = f"sqrt(2*g*max({name}, 0))" if "g" in self.model.parameter_names else f"sqrt(max({name}, 0))"
        if coefficient is not None and coefficient.free_symbols & set(self.model.x):
            coefficient = None  # no cross-section
        weight = coefficient if coefficient is None or not coefficient.could_extract_minus_sign() else -coefficient
        scale = "" if weight is None else f"*({_text(weight)})"
        cover = self._cover(self.model.states.index(name))
        depth = abs(state.initial) or cover
        size = nice(_SHARE * cover / depth**0.5 / self.spec.horizon * 10)
        values = {sympy.Symbol(p.name, real=True): p.value for p in self.plant.parameters}
        if weight is not None and not (at := weight.subs(values)).free_symbols and at != 0:
            size = nice(
                size / abs(float(at)) / ((2 * values[sympy.Symbol("g", real=True)]) ** 0.5 if "2*g" in flow else 1)
            )
        yield self._pattern("leak", "", {name: f"-{flow}{scale}"}, "process", size, bounds=[0, None])

    def _lag(self, name: str, term: Any) -> Iterator[Pattern]:
        """Yield a term that follows late: a further state, and a fault from 0 (no lag) to 1."""
        coefficient = self._coefficient(name, term)
        if coefficient is None:
            return
        difference = f"({_text(coefficient)})*({{lag}} - {term.name})"
        kind = "actuator" if term.name in self.model.inputs else "process"
        unit = next((u.unit for u in self.plant.inputs if u.name == term.name), "")
        yield self._with_lag(name, term.name, term.name, difference, kind, unit)

    def _with_lag(self, where: str, term: str, text: str, coefficient: str, kind: str, unit: str) -> Pattern:
        lag, time = self._free(f"{term}_late"), self._free(f"T_{term}")
        initial = next((u.default for u in self.plant.inputs if u.name == term), 0.0)
        initial = next((s.initial for s in self.plant.states if s.name == text), initial)
        return self._pattern(
            "lag",
            term,
            {where: coefficient.format(lag=lag)},
            kind,
            1.0,
            bounds=[0, 1],
            states=[{"name": lag, "initial": initial} | ({"unit": unit} if unit else {})],
            parameters=[{"name": time, "value": nice(_SLOW * self.spec.horizon), "unit": "s", "bounds": [1e-6, None]}],
            equations={lag: f"({text} - {lag})/{time}"},
        )

    def _pattern(
        self,
        pattern: str,
        term: str,
        enters: dict[str, str],
        kind: str,
        size: float,
        bounds: list[float | None] | None = None,
        unit: str = "",
        **more: Any,
    ) -> Pattern:
        (where,) = enters
        name = self._free(f"{pattern}_{term or where}")
        channel = {"name": name, "kind": kind, "enters": enters, "typical": size}
        channel |= {"bounds": bounds} if bounds else {}
        channel |= {"unit": unit} if unit else {}
        about = Message(f"workshop.pattern.{pattern}", name=term or where)
        names = {*self.declared, *(s["name"] for s in more.get("states", ())), "t", "theta"}
        sign = "" if enters[where].lstrip("(").startswith("-") else "<mo>+</mo>"
        product = "theta" if enters[where] == "1" else f"({enters[where]})*theta"
        try:
            shown = row(sign, expression(product, names, tables=self.model.tables))
        except SpecError:
            shown = symbol("theta")
        return Pattern(pattern, term, about, math(shown), channel, **more)

    def _coefficient(self, name: str, term: Any) -> Any:
        """Return the derivative of the equation of a state by a term, None where it is 0 or contains the term."""
        slope = sympy.diff(self.model.f[self.model.states.index(name)], term)
        return None if slope == 0 or term in slope.free_symbols else slope

    def _cover(self, index: int) -> float:
        state = self.plant.states[index]
        low, high = state.domain
        if state.scale is not None:
            return state.scale
        return abs(state.initial) or (high - low if low is not None and high is not None else 1.0)

    def _free(self, name: str) -> str:
        """Return a name that is not declared, of at most 32 characters."""
        base = re.sub(r"\W", "_", name)[:28]
        return next(n for k in range(100) if (n := base if k == 0 else f"{base}{k + 1}") not in self.declared)

    def is_readable(self, pattern: Pattern) -> bool:
        """Return whether all expressions can be read: SymPy prints functions that the language does not have."""
        names = {*self.declared, *(s["name"] for s in pattern.states), "t"} - set(self.plant.names("channels"))
        texts = [*pattern.channel["enters"].values(), *pattern.conserved.values(), *pattern.equations.values()]
        names |= {p["name"] for p in pattern.parameters}
        try:
            for text in texts:
                parse(text, names, tables=self.model.tables)
        except SpecError:
            return False
        return True


def _text(expr: Any) -> str:
    """Return a SymPy expression in the language of plants."""
    text = str(expr)
    for printed, name in _PRINTED.items():
        text = re.sub(rf"\b{printed}\(", f"{name}(", text)
    return text


def _bracketed(text: str) -> str:
    return text if text.isidentifier() else f"({text})"
