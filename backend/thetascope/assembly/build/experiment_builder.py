"""Build the engine's experiment from a resolved experiment at one time."""

from dataclasses import replace

from thetascope.assembly.build.healthy import healthy_run_of
from thetascope.assembly.build.loop_builder import loop_of
from thetascope.assembly.build.observer_builder import estimator, plant_context
from thetascope.assembly.build.signal_builder import initial_state, plant_parameters, signals_of
from thetascope.assembly.build.truth_builder import with_truth
from thetascope.engine.errors import SpecError
from thetascope.engine.inputs.fault_signals import RANDOM
from thetascope.engine.inputs.sensors import Measurement
from thetascope.engine.inputs.time_grid import multiple
from thetascope.engine.observers.support.scales import HealthyRun
from thetascope.engine.programs.program_store import plant_program
from thetascope.engine.simulation.experiment import Experiment as Engine
from thetascope.messages import Message
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.faults import ChannelFault
from thetascope_schemas.experiment.measurement import Truth


def engine(spec: ResolvedExperiment, since: dict[str, int] | None = None, healthy: HealthyRun | None = None) -> Engine:
    """Build the engine's experiment for a spec without timed commands. Raises SpecError.

    ``since``: the base steps at which observers were added, by label; all others start with the run. ``healthy``: the
    healthy run of the experiment as it began, whose scales hold for the whole run; None where this is its beginning.
    """
    data = spec.plant.model_dump(mode="json")
    step, steps, every, record = _times(spec)
    program = plant_program(data).program  # before the observers: an error in the plant's equations is the plant's
    healthy = healthy or healthy_run_of(spec, data)
    estimators = [estimator(i, c, spec, data, step, healthy) for i, c in enumerate(spec.observers)]
    if since:
        estimators = [replace(e, since=since.get(e.label, 0)) for e in estimators]
    measured = measurement(spec, step)
    model = Engine(
        plant=program,
        parameters=plant_parameters(spec),
        x0=initial_state(spec),
        signals=signals_of(spec),
        measurement=measured,
        estimators=tuple(estimators),
        step=step,
        steps=steps,
        every=every,
        record=record,
        substeps=spec.substeps,
        context=plant_context(spec, data, step, healthy),
        loop=loop_of(spec, data, step, measured),
    )
    return with_truth(model, spec)


def reseeded(model: Engine, spec: ResolvedExperiment) -> Engine:
    """Return the engine's experiment of a spec that differs by its seed only from the one that `model` was built for.

    With a true plant of its own or with controllers, other parts depend on the seed, and all is built.
    """
    if spec.truth != Truth() or model.loop is not None:
        return engine(spec)
    random = {f"theta.{f.channel}" for f in spec.faults if isinstance(f, ChannelFault) and f.shape == RANDOM}
    kept = {name: signal for name, signal in model.signals.items() if name not in random}
    return replace(model, signals=signals_of(spec, kept), measurement=measurement(spec, model.step))


def _times(spec: ResolvedExperiment) -> tuple[float, int, int, int]:
    """Return the step in s, and in base steps the horizon and the intervals `evaluate` and `record`."""
    step, plant = spec.step, spec.plant
    if plant.time.kind == "discrete":
        if abs(step - plant.time.period) > 1e-9 * plant.time.period:
            raise SpecError("step", step, Message("experiment.step.not-period", period=plant.time.period, step=step))
        step = plant.time.period
    steps, every = multiple(spec.horizon, step, "horizon"), multiple(spec.evaluate_interval, step, "evaluate")
    return step, steps, every, multiple(spec.record_interval, step, "record")


def measurement(spec: ResolvedExperiment, step: float) -> Measurement:
    """Return the measurement: noise, faults of the sensors, sampling."""
    outputs = spec.plant.names("outputs")
    noise = [spec.noise.get(name) for name in outputs]
    plain = [f.model_dump(mode="json") for f in spec.faults if f.site.kind == "output"]
    for fault in plain:
        fault["output"] = f"y.{fault['output']}"
    every = None
    if spec.measurement.mode == "sampled":
        every = multiple(spec.measurement.period, step, "measurement.period")
    return Measurement(
        outputs=tuple(f"y.{name}" for name in outputs),
        std=tuple(n.std if n else 0.0 for n in noise),
        sample_time=tuple(n.sample_time if n else step for n in noise),
        seed=spec.seed,
        faults=tuple(plain),
        sample_every=every,
    )
