"""An experiment that suits a plant: length, step, inputs and noise from the plant's own time and scales."""

import math
from fractions import Fraction
from math import gcd, lcm
from typing import Any

import numpy as np

from thetascope.assembly.build.healthy import healthy_run_of
from thetascope.assembly.build.prepare import prepare
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.controllers import SetPoint
from thetascope_schemas.experiment.diagnosis import DiagnosisSettings
from thetascope_schemas.experiment.faults import StepFault
from thetascope_schemas.experiment.plant import Input, Plant
from thetascope_schemas.experiment.signals import PulseSignal, Signal

_STEPS = 2000
_TIME_CONSTANTS = 12.0  # of the slowest rate, that the experiment takes
_GUESSES = (10.0, 1000.0, 1e5)  # lengths in s of the simulations that look for the slowest rate
_NOISE = 0.005  # standard deviation of an output, as a share of its scale
_SHARE = 0.2  # amplitude of an input, as a share of its default or range
_EARLY, _BETWEEN = 0.3, 0.6  # share of the horizon before the first fault, and of all faults together


def trial_experiment(plant: Plant, changes: dict[str, Any] | None = None, faults: bool = False) -> ResolvedExperiment:
    """Return an experiment on a plant without observers.

    It lasts about twelve time constants of the slowest mode, its inputs are square waves around their defaults, and the
    noise is 0.5 % of what each output covers. `changes` are fields of the experiment to use as they are: parameters,
    initial, inputs. With `faults`, each channel has a fault of its typical size, one after the other. Raises SpecError.
    """
    given = {name: value for name, value in (changes or {}).items() if value}
    spec = _experiment(plant, given, _horizon(plant, given), faults)
    end = _finite_until(spec)
    if end < 0.9 * spec.horizon:  # an unstable plant
        spec = _experiment(plant, given, 0.5 * end, faults)
    scales = healthy_run_of(spec, plant.model_dump(mode="json")).scales.outputs
    stds = [nice(_NOISE * scale) for scale in scales]
    names = plant.names("outputs")
    noise = {name: {"std": std, "sample_time": spec.step} for name, std in zip(names, stds, strict=True)}
    return ResolvedExperiment.model_validate(dict(spec) | {"noise": noise})


def _experiment(plant: Plant, given: dict[str, Any], horizon: float, faults: bool) -> ResolvedExperiment:
    """Return an experiment of about a length in s, without noise."""
    step = plant.time.period if plant.time.kind == "discrete" else _step(plant, horizon / _STEPS)
    horizon = step * round(horizon / step)
    inputs = {item.name: square(item, horizon) for item in plant.commanded}
    data: dict[str, Any] = {
        "id": plant.id,
        "title": plant.title,
        "plant": plant,
        "horizon": horizon,
        "step": step,
        "inputs": inputs,
        "faults": _faults(plant, horizon, step) if faults else (),
    }
    return ResolvedExperiment.model_validate(data | given | {"inputs": inputs | given.get("inputs", {})})


def _finite_until(spec: ResolvedExperiment) -> float:
    """Return the time in s up to which all outputs of the plant without faults are finite."""
    quiet = {"faults": (), "diagnosis": DiagnosisSettings(enabled=False)}
    result = prepare(ResolvedExperiment.model_validate(dict(spec) | quiet)).run()
    outputs = np.stack([result.column(f"y.{name}") for name in spec.plant.names("outputs")])
    finite = np.isfinite(outputs).all(axis=0)
    t = result.column("t")
    return float(t[-1] if finite.all() else t[int(np.argmin(finite))])


def nice(value: float) -> float:
    """Return 1, 2 or 5 times a power of ten, the nearest to a positive value; 1 for other values."""
    if not (value > 0 and math.isfinite(value)):
        return 1.0
    power = math.floor(math.log10(value))
    best = min((1, 2, 5, 10), key=lambda digit: abs(math.log10(value) - power - math.log10(digit)))
    return float(f"{best}e{power}")


def square(item: Input | SetPoint, horizon: float) -> Signal:
    """Return a square wave that begins at the default of an input or reference and stays within its bounds."""
    low, high = item.bounds
    if item.default:
        size = _SHARE * abs(item.default)
    elif low is not None and high is not None:
        size = _SHARE * (high - low)
    else:
        size = 1.0
    top = item.default + size
    if high is not None and top > high:
        top = item.default - size if low is None or item.default - size >= low else high
    period = horizon / 4
    return PulseSignal(low=item.default, high=top, period=period, width=period / 2, start=period / 2)


def _horizon(plant: Plant, given: dict[str, Any]) -> float:
    """Return a length in s that shows the slowest mode, whatever the unit of time of the plant's own."""
    period = plant.time.period if plant.time.kind == "discrete" else None
    changes = {name: value for name, value in given.items() if name == "parameters"}
    for guess in _GUESSES:
        step = _step(plant, guess / 200) if period is None else period
        spec = ResolvedExperiment(
            plant=plant, horizon=step * round(guess / step) if period is None else 200 * step, step=step, **changes
        )
        rate = healthy_run_of(spec, plant.model_dump(mode="json")).scales.rate
        if rate > 0:
            horizon = nice(_TIME_CONSTANTS / rate)
            break
    else:
        horizon = _GUESSES[0]
    if period is None:
        return horizon
    return period * max(200, min(20 * _STEPS, round(horizon / period)))


def _step(plant: Plant, longest: float) -> float:
    """Return a step of at most a length in s, of which the periods of all controllers are multiples."""
    periods = [Fraction(c.period).limit_denominator(10**9) for c in plant.controllers if c.period is not None]
    if not periods:
        return longest
    denominator = lcm(*(period.denominator for period in periods))
    common = gcd(*(int(period * denominator) for period in periods)) / denominator
    return common / math.ceil(common / longest)


def _faults(plant: Plant, horizon: float, step: float) -> tuple[StepFault, ...]:
    """Return a fault of typical size in each channel, one after the other and apart."""
    slot = _BETWEEN * horizon / max(1, len(plant.channels))
    faults = []
    for index, channel in enumerate(plant.channels):
        onset = step * round((_EARLY * horizon + index * slot) / step)
        end = step * round((_EARLY * horizon + (index + 0.7) * slot) / step)
        faults.append(StepFault(channel=channel.name, onset=onset, end=end, size=size_of_fault(plant, index)))
    return tuple(faults)


def size_of_fault(plant: Plant, index: int) -> float:
    """Return the typical size of a channel's fault, within its bounds: some faults have one sign only."""
    channel = plant.channels[index]
    low, high = channel.bounds
    size = channel.typical
    if high is not None and size > high:
        size = -channel.typical if low is not None and low <= -channel.typical else high
    return size
