"""Build the signals, parameters and initial state of a plant from a resolved experiment."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from thetascope.assembly.build.recorded_truth import recorded_signals
from thetascope.engine.errors import SpecError
from thetascope.engine.inputs import curve, fault_signals, signals
from thetascope_schemas import Input, Plant, ResolvedExperiment
from thetascope_schemas.experiment.controllers import SetPoint
from thetascope_schemas.experiment.signals import ExpressionSignal
from thetascope_schemas.service.figures.signal_curve import SignalCurve, SignalCurveRequest


def plant_parameters(spec: ResolvedExperiment) -> dict[str, float]:
    """Return the plant's parameters, ``p.*``."""
    return {f"p.{p.name}": spec.parameters.get(p.name, p.value) for p in spec.plant.parameters}


def initial_state(spec: ResolvedExperiment) -> np.ndarray:
    """Return the plant's state at t = 0 (n,)."""
    return np.array([spec.initial.get(s.name, s.initial) for s in spec.plant.states], dtype=float)


def nominal_state(plant: Plant) -> np.ndarray:
    """Return the initial state that the plant declares (n,)."""
    return np.array([s.initial for s in plant.states], dtype=float)


def signals_of(
    spec: ResolvedExperiment, known: Mapping[str, signals.Signal] = MappingProxyType({})
) -> dict[str, signals.Signal]:
    """Return u.*, signal.*, theta.* and r.*, in this order; those in ``known`` are reused.

    Inputs that controllers set are left out.
    """
    built, plant = {}, spec.plant
    controlled = plant.controlled
    if spec.truth.record is not None and not known:
        known = recorded_signals(spec)

    def commanded(name: str, item: Input | SetPoint) -> signals.Signal:
        given = spec.inputs.get(item.name)
        return known.get(name) or (
            signals.constant(item.default) if given is None else _signal(given, f"inputs.{item.name}")
        )

    for u in plant.inputs:
        if u.name not in controlled:
            built[f"u.{u.name}"] = commanded(f"u.{u.name}", u)
    for s in plant.signals:
        name = f"signal.{s.name}"
        built[name] = known.get(name) or _signal(spec.signals.get(s.name, s.default), f"signals.{s.name}")
    for c in plant.channels:
        name = f"theta.{c.name}"
        built[name] = known.get(name) or fault_signals.theta(c.name, _plain(spec, c.name), spec.seed)
    return built | {f"r.{r.name}": commanded(f"r.{r.name}", r) for r in plant.references}


def takes_long(request: SignalCurveRequest) -> bool:
    """Return whether a curve takes tenths of a second: a text, or more jumps than are evaluated at a time."""
    given = request.signal
    interval = getattr(given, "hold", getattr(given, "period", None))
    many = interval is not None and (request.end - request.start) / interval > curve.MOST / 8
    return many or isinstance(given, ExpressionSignal)


def curve_of(request: SignalCurveRequest) -> SignalCurve:
    """Return the curve of a signal. Raises SpecError where its text is no function of the time."""
    given = request.signal
    interval = getattr(given, "hold", getattr(given, "period", None))
    jumps = 2.0 if hasattr(given, "period") else 1.0
    shortest = None if interval is None else interval / jumps
    built = _signal(given, "signal")
    with np.errstate(all="ignore"):  # values beyond double precision are left out
        points = curve.curve(built, request.start, request.end, request.places, shortest)
    finite = np.isfinite(points).all(axis=0)
    t, values = points[:, finite].tolist()
    return SignalCurve(t=tuple(t), values=tuple(values))


def _plain(spec: ResolvedExperiment, channel: str) -> list[dict]:
    return [f.model_dump(mode="json") for f in spec.faults if f.site == ("channel", channel)]


def _signal(given, field: str) -> signals.Signal:
    try:
        return signals.signal(given.model_dump(mode="json"))
    except SpecError as error:
        error.field = f"{field}.{error.field}"
        raise
