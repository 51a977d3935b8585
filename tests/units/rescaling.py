"""Rewrite an experiment in other units: every quantity of the plant, and time, by a factor of its own."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from random import Random

import numpy as np

from thetascope.assembly import prepare
from thetascope.assembly.build.gain_values import from_parameters
from thetascope.engine.observers.support.declaration import Context, Gain
from thetascope.engine.simulation.experiment import Estimator
from thetascope_schemas import ResolvedExperiment

_NAME = re.compile(r"(?<![\w.])[A-Za-z_]\w*")


@dataclass(frozen=True)
class Units:
    """Factors by name: a quantity in new units is its factor times the old one. ``offsets`` are added to outputs."""

    factors: Mapping[str, float] = field(default_factory=dict)
    time: float = 1.0
    offsets: Mapping[str, float] = field(default_factory=dict)

    def of(self, name: str) -> float:
        """Return the factor of a quantity."""
        return self.factors.get(name, 1.0)


def random_units(spec: ResolvedExperiment, seed: int, decades: float = 12.0, offsets: bool = True) -> Units:
    """Return random units: factors of up to 10^±decades for every quantity of the plant and for time."""
    draw, plant = Random(seed), spec.plant
    names = [*plant.names("states", "inputs", "outputs", "parameters", "signals", "channels", "definitions")]
    names += [item.name for item in plant.references]
    names += [item.name for one in plant.controllers for item in (*one.states, *one.definitions)]
    factors = {name: 10 ** draw.uniform(-decades, decades) for name in names}
    for definition in plant.definitions:  # a limit that is a parameter has the definition's unit
        for limit in definition.domain:
            if isinstance(limit, str):
                factors[definition.name] = factors[limit]
    for controller in plant.controllers:
        for output in controller.outputs:
            for limit in output.saturation:
                if isinstance(limit, str):
                    factors[output.input] = factors[limit]
    time = 10 ** draw.uniform(-decades, decades)
    shifts = {y.name: factors[y.name] * draw.uniform(-300, 300) for y in plant.outputs} if offsets else {}
    return Units(factors, time, shifts)


def rescaled(spec: ResolvedExperiment, units: Units) -> ResolvedExperiment:
    """Return the experiment in other units. It is the same experiment: its numbers differ by the factors only."""
    data = spec.model_dump(mode="json")
    data["plant"] = _plant(data["plant"], units)
    for group in ("parameters", "initial"):
        data[group] = {n: units.of(n) * v for n, v in data[group].items()}
    for group in ("inputs", "signals"):
        data[group] = {n: _signal(v, units.of(n), units) for n, v in data[group].items()}
    data["noise"] = {
        n: {"std": units.of(n) * v["std"], "sample_time": units.time * v["sample_time"]}
        for n, v in data["noise"].items()
    }
    data["faults"] = [_fault(fault, units) for fault in data["faults"]]
    for name in ("horizon", "step", "record", "evaluate"):
        data[name] = None if data[name] is None else units.time * data[name]
    if data["measurement"]["mode"] == "sampled":
        data["measurement"]["period"] *= units.time
    for observer, estimator in zip(data["observers"], prepare(spec).engine.estimators, strict=True):
        observer["gains"] = converted_gains(observer["gains"], estimator, units)
        observer["initial"] = {n: units.of(n) * v for n, v in observer["initial"].items()}
        if "period" in observer["options"]:
            observer["options"]["period"] *= units.time
    data["diagnosis"]["false_alarms"] /= units.time
    if data["diagnosis"]["span"] is not None:
        data["diagnosis"]["span"] *= units.time
    return ResolvedExperiment.model_validate(data)


def converted_gains(gains: Mapping, estimator: Estimator, units: Units) -> dict:
    """Return gains that an experiment gives to an observer, in other units."""
    context, converted = estimator.context, {}
    for gain in estimator.kind.gains:
        if gain.name in gains:
            values = from_parameters(gain.name, gain.shape(context), estimator.parameters)
            converted[gain.name] = (np.asarray(values) * gain_factors(gain, context, units)).tolist()
    return converted


def gain_factors(gain: Gain, context: Context, units: Units) -> np.ndarray | float:
    """Return the factor of a gain, of each of its rows, or of each entry, from the dimension that it declares."""
    outputs = [item["name"] for item in context.model["outputs"]]
    rows, columns = gain.row_labels(context), gain.column_labels(context)
    orders = gain.orders(context) if gain.orders else [1] * len(rows)

    def factor(row: str, column: str) -> float:
        of_output = row if row in outputs else column if column in outputs else outputs[0]
        # a level for all faults together belongs to the first: it enters no estimate
        of_fault, unit = row if row in context.channels else next(iter(context.channels), ""), gain.unit
        return (
            units.of(row) ** unit.state
            * units.of(of_output) ** unit.output
            * units.of(of_fault) ** unit.fault
            * units.time**unit.time
        )

    if not rows:
        return factor("", "")
    if not columns:
        return np.array([factor(row, "") ** order for row, order in zip(rows, orders, strict=True)])
    return np.array([[factor(row, column) for column in columns] for row in rows])


def _text(units: Units) -> Callable[[str, float], str]:
    """Return a function that writes an expression in new units; its value is a factor times the old one."""

    def text(expression: str, factor: float) -> str:
        def old(match: re.Match) -> str:
            name = match.group()
            factor = units.time if name == "t" else units.factors.get(name)
            if name in units.offsets:
                return f"(({name} - ({units.offsets[name]!r}))/{units.of(name)!r})"
            return name if factor is None else f"({name}/{factor!r})"

        return f"{factor!r}*({_NAME.sub(old, expression)})"

    return text


def _plant(plant: dict, units: Units) -> dict:
    text = _text(units)
    discrete = plant["time"]["kind"] == "discrete"
    rate = 1.0 if discrete else 1 / units.time
    if discrete:
        plant["time"]["period"] *= units.time
    for group in ("states", "inputs", "outputs", "parameters", "signals", "channels", "definitions", "references"):
        for item in plant[group]:
            factor = units.of(item["name"])
            for name in ("initial", "default", "value", "typical", "scale"):
                if isinstance(item.get(name), int | float):
                    item[name] *= factor
            for name in ("domain", "bounds"):
                if name in item:
                    item[name] = [factor * v if isinstance(v, int | float) else v for v in item[name]]
    for controller in plant["controllers"]:
        _controller(controller, units)
    for item in plant["definitions"]:
        item["expression"] = text(item["expression"], units.of(item["name"]))
    for item in plant["outputs"]:
        expression = text(item["expression"], units.of(item["name"]))
        offset = units.offsets.get(item["name"], 0.0)
        item["expression"] = f"{expression} + {offset!r}" if offset > 0 else f"{expression} - {-offset!r}"
    for item in plant["signals"]:
        item["default"] = _signal(item["default"], units.of(item["name"]), units)
    plant["dynamics"] = {n: text(e, units.of(n) * rate) for n, e in plant["dynamics"].items()}
    outputs = {y["name"] for y in plant["outputs"]}
    for channel in plant["channels"]:
        size = units.of(channel["name"])
        channel["enters"] = {
            n: text(e, units.of(n) * (1.0 if n in outputs else rate) / size) for n, e in channel["enters"].items()
        }
    return plant


def _controller(controller: dict, units: Units) -> None:
    text, rate = _text(units), 1.0
    if controller["period"] is None:
        rate = 1 / units.time
    else:
        controller["period"] *= units.time
    for item in controller["states"]:
        item["initial"] *= units.of(item["name"])
    for item in controller["definitions"]:
        item["expression"] = text(item["expression"], units.of(item["name"]))
    controller["dynamics"] = {n: text(e, units.of(n) * rate) for n, e in controller["dynamics"].items()}
    for item in controller["outputs"]:
        factor = units.of(item["input"])
        item["expression"] = text(item["expression"], factor)
        item["saturation"] = [factor * v if isinstance(v, int | float) else v for v in item["saturation"]]


_BY_SIZE = ("value", "low", "high", "amplitude", "offset", "initial")
_BY_TIME = ("start", "period", "width", "hold", "duration")
_PER_TIME = ("frequency", "f0", "f1")


def _signal(signal: dict, factor: float, units: Units) -> dict:
    signal = dict(signal)
    if signal["kind"] == "expression":
        inner = re.sub(r"(?<![\w.])t\b", f"(t/{units.time!r})", signal["text"])
        return signal | {"text": f"{factor!r}*({inner})"}
    for name in _BY_SIZE:
        if name in signal:
            signal[name] *= factor
    for name in _BY_TIME:
        if name in signal:
            signal[name] *= units.time
    for name in _PER_TIME:
        if name in signal:
            signal[name] /= units.time
    if "slope" in signal:
        signal["slope"] *= factor / units.time
    if "times" in signal:
        signal["times"] = [units.time * v for v in signal["times"]]
        signal["values"] = [factor * v for v in signal["values"]]
    return signal


def _fault(fault: dict, units: Units) -> dict:
    fault = dict(fault)
    site = fault.get("channel") or fault["output"]
    factor = units.of(site)
    for name in ("onset", "end", "duration", "time_constant", "period", "width", "sample_time", "delay"):
        if fault.get(name) is not None:
            fault[name] *= units.time
    for name in ("size", "std", "resolution"):
        if name in fault:
            fault[name] *= factor
    if "value" in fault:
        fault["value"] = factor * fault["value"] + units.offsets.get(site, 0.0)
    if "rate" in fault:
        fault["rate"] *= factor / units.time
    if "intensity" in fault:
        fault["intensity"] *= factor / units.time**0.5
    if "frequency" in fault:
        fault["frequency"] /= units.time
    if "times" in fault:
        fault["times"] = [units.time * v for v in fault["times"]]
        fault["values"] = [factor * v for v in fault["values"]]
    return fault
