"""Turn an observer given as data into its program and parameters, with defaults filled in and names checked."""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace

import numpy as np

from thetascope.assembly.build.gain_values import gain_values, parameters, size_of
from thetascope.assembly.build.recorded_truth import on_record
from thetascope.engine.errors import SpecError
from thetascope.engine.inputs.time_grid import multiple
from thetascope.engine.observers.registry import observer
from thetascope.engine.observers.support.declaration import Context, Observer, Option
from thetascope.engine.observers.support.scales import HealthyRun
from thetascope.engine.programs.program_store import observer_program
from thetascope.engine.simulation.experiment import Estimator
from thetascope.messages import Message
from thetascope_schemas import ObserverConfig, Plant, ResolvedExperiment
from thetascope_schemas.texts.refusal import suggestion


def estimator(
    index: int, config: ObserverConfig, spec: ResolvedExperiment, data: dict, step: float, healthy: HealthyRun
) -> Estimator:
    """Return one observer of an experiment, ready to run. Raises SpecError for a field below ``observers.<index>``."""
    with _located(index):
        return _estimator(config, spec, data, step, healthy)


def with_gains(index: int, config: ObserverConfig, before: ObserverConfig, built: Estimator) -> Estimator | None:
    """Return the value of :func:`estimator` for a config that differs from that of ``built`` in its gains only.

    None where more than numbers would change. Raises SpecError as :func:`estimator` does.
    """
    known = {g.name: g for g in built.kind.gains}
    numbers = dict(built.parameters)
    with _located(index):
        refuse_unknown("gains", config.gains, known, Message("observer.gain.unknown", kind=built.kind.id))
        for name in {*config.gains, *before.gains}:
            if config.gains.get(name) != before.gains.get(name):
                numbers |= parameters(name, gain_values(known[name], config.gains.get(name), built.context))
    return replace(built, parameters=numbers) if numbers.keys() == built.parameters.keys() else None


@contextmanager
def _located(index: int) -> Iterator[None]:
    """Prefix the field of a SpecError with ``observers.<index>``."""
    try:
        yield
    except SpecError as error:
        tail = error.field.removeprefix("observers.")
        error.field = f"observers.{index}.{tail}"
        raise


def _estimator(
    config: ObserverConfig, spec: ResolvedExperiment, data: dict, step: float, healthy: HealthyRun
) -> Estimator:
    kind, plant = observer(config.kind), spec.plant
    _suits(kind, plant)
    every = _sample_every(kind, config, spec, step)
    channels = _channels(kind, config, plant)
    if channels is None:
        channels = plant.names("channels")
        if kind.chooses is not None:
            channels = kind.chooses(_context(spec, data, channels, step, every, healthy))
    context = _context(spec, data, channels, step, every, healthy)
    context = replace(context, poles=_wished(kind, config))
    gains = {g.name: gain_values(g, config.gains.get(g.name), context) for g in kind.gains}
    refuse_unknown("gains", config.gains, gains, Message("observer.gain.unknown", kind=kind.id))
    options = _options(kind, config, context)
    sizes = {name: size_of(values) for name, values in gains.items()}
    written = observer_program(data, kind, channels, sizes, options)
    numbers = _numbers(gains, config, spec, channels)
    numbers["g.period"] = context.period
    for name, matrix in (kind.constants(context) if kind.constants is not None else {}).items():
        numbers |= {f"k.{name}.{i}.{j}": float(v) for (i, j), v in np.ndenumerate(matrix)}
    built = Estimator(config.label, kind, written.program, channels, numbers, written.facts, context, every)
    return on_record(built, spec, "period" in config.options)


def refuse_unknown(field: str, given: Mapping[str, object], known: Iterable[str], problem: Message) -> None:
    """Raise SpecError for the first unknown name, with the nearest known names."""
    names = tuple(known)
    for name in given:
        if name not in names:
            raise SpecError(f"{field}.{name}", given[name], problem, Message.from_data(suggestion(name, names)))


def _suits(kind: Observer, plant: Plant) -> None:
    discrete = plant.time.kind == "discrete"
    if kind.time == "continuous" and discrete:
        raise SpecError("kind", kind.id, Message("observer.kind.continuous-only", plant=plant.id))


def _channels(kind: Observer, config: ObserverConfig, plant: Plant) -> tuple[str, ...] | None:
    """Return the channels that it estimates by the option ``channels`` (comma separated); None without it."""
    names = [c.name for c in plant.channels]
    if not kind.takes_channels:
        return ()
    requested = config.options.get("channels")
    if requested is None:
        return None
    picked = [part.strip() for part in str(requested).split(",") if part.strip()]
    for name in picked:
        if name not in names:
            hint = Message.from_data(suggestion(name, names))
            raise SpecError("options.channels", name, Message("plant.channel.unknown", name=name), hint)
    if len(set(picked)) < len(picked):
        raise SpecError("options.channels", requested, Message("observer.channels.repeated"))
    return tuple(picked)


def _sample_every(kind: Observer, config: ObserverConfig, spec: ResolvedExperiment, step: float) -> int | None:
    """Return the base steps in the observer's sample period; None if it runs in the plant's time."""
    if kind.time != "discrete":
        return None
    if spec.plant.time.kind == "discrete":
        return 1
    period = config.options.get("period")
    if period is not None:
        if isinstance(period, bool) or not isinstance(period, int | float) or period <= 0:
            raise SpecError("options.period", period, Message("observer.period.not-positive"))
        return multiple(float(period), step, "options.period")
    if spec.measurement.mode == "sampled":
        return multiple(spec.measurement.period, step, "options.period")
    if spec.truth.record is not None:
        return 1
    # continuous measurement: no finer than the noise, which is the same over its sample time
    return multiple(max([n.sample_time for n in spec.noise.values()] or [10 * step]), step, "options.period")


def _context(
    spec: ResolvedExperiment,
    data: dict,
    channels: tuple[str, ...],
    step: float,
    every: int | None,
    healthy: HealthyRun,
) -> Context:
    plant = spec.plant
    noise = [spec.noise.get(o.name) for o in plant.outputs]
    return Context(
        n=len(plant.states),
        m=len(plant.outputs),
        p=len(channels),
        noise_std=tuple(n.std if n else 0.0 for n in noise),
        step=step,
        period=step if every is None else every * step,
        model=data,
        channels=channels,
        noise_hold=tuple(n.sample_time if n else 0.0 for n in noise),
        healthy=healthy,
    )


def plant_context(spec: ResolvedExperiment, data: dict, step: float, healthy: HealthyRun) -> Context:
    """Return the facts about the plant for a filter of all its fault channels; ``data`` is the plant as JSON."""
    return _context(spec, data, spec.plant.names("channels"), step, None, healthy)


def _wished(kind: Observer, config: ObserverConfig) -> str:
    """Return the wished poles as text. Raises SpecError where the gain that they would design is given, too."""
    option = next((o for o in kind.options if o.kind == "poles"), None)
    text = "" if option is None else str(config.options.get(option.name) or "")
    designed = next((g.name for g in kind.gains if g.size is not None), None)
    if text.strip() and designed in config.gains:
        raise SpecError("options.poles", text[:80], Message("observer.poles.and-gain", gain=designed))
    return text


def _options(kind: Observer, config: ObserverConfig, context: Context) -> dict:
    known = {o.name: o for o in kind.options}
    general = {"channels"} if kind.takes_channels else set()
    general |= {"period"} if kind.time == "discrete" else set()
    rest = {k: v for k, v in config.options.items() if k not in general}
    refuse_unknown("options", rest, {*known, *general}, Message("observer.option.unknown", kind=kind.id))
    structural = {name: option for name, option in known.items() if option.kind != "poles"}
    return {name: _option(option, rest.get(name), context) for name, option in structural.items()}


def _option(option: Option, given, context: Context):
    field = f"options.{option.name}"
    if given is None:
        return option.default(context) if callable(option.default) else option.default
    if option.kind == "choice" and given not in option.choices:
        raise SpecError(field, given, Message("observer.option.no-choice", names=option.choices))
    if option.kind == "integer":
        whole = not isinstance(given, bool) and isinstance(given, int | float) and float(given).is_integer()
        if not whole or not option.low <= given <= option.high:
            limits = {"low": option.low, "high": option.high}
            raise SpecError(field, given, Message("observer.option.no-whole-number", meaning=option.meaning, **limits))
        return int(given)
    return given


def _numbers(
    gains: dict, config: ObserverConfig, spec: ResolvedExperiment, channels: tuple[str, ...]
) -> dict[str, float]:
    numbers: dict[str, float] = {}
    for name, value in gains.items():
        numbers |= parameters(name, value)
    plant = spec.plant
    numbers |= {f"m.{p.name}": spec.parameters.get(p.name, p.value) for p in plant.parameters}
    begin = {} if spec.truth.record is None else spec.initial  # a record has no true initial state
    start = {f"x0.{s.name}": begin.get(s.name, s.initial) for s in plant.states} | {
        f"theta0.{c}": 0.0 for c in channels
    }
    bare = {name.partition(".")[2]: name for name in start}
    refuse_unknown("initial", config.initial, bare, Message("observer.initial.unknown"))
    return numbers | start | {bare[name]: float(value) for name, value in config.initial.items()}
