"""The experiments of a challenge: its plant with the suspects only, its input and its fault."""

from functools import cache

from thetascope import library
from thetascope_schemas import Experiment, ObserverConfig, Plant, ResolvedExperiment
from thetascope_schemas.experiment.diagnosis import DiagnosisSettings
from thetascope_schemas.experiment.faults import RampFault, StepFault
from thetascope_schemas.experiment.measurement import SampledMeasurement
from thetascope_schemas.service.learning.challenge import HiddenFault
from thetascope_schemas.service.learning.mystery import MysterySetup, Suspect
from thetascope_schemas.texts.local_text import LocalText

_WIDER = 1.5  # sizes that may be answered, in terms of the largest that is drawn


@cache
def setup_plant(id: str) -> Plant:
    """Return the plant of a set-up; its channels are the suspects, so that the detector knows no others either."""
    setup = library.mysteries()[id]
    plant = library.plant(setup.plant)
    channels = {c.name: c for c in plant.channels}
    return plant.model_copy(update={"channels": tuple(channels[s.channel] for s in setup.suspects)})


def sizes_of(plant: Plant, suspect: Suspect) -> tuple[float, float]:
    """Return the smallest and the largest size that may be answered."""
    low, high = next(c.bounds for c in plant.channels if c.name == suspect.channel)
    most = _WIDER * suspect.high
    return (-most if low is None else max(low, -most)), (most if high is None else min(high, most))


def fault_of(hidden: HiddenFault) -> StepFault | RampFault:
    """Return a hidden fault as one of an experiment."""
    common = {"channel": hidden.channel, "onset": hidden.onset, "size": hidden.size}
    return StepFault(**common) if hidden.duration is None else RampFault(**common, duration=hidden.duration)


def experiment_of(
    setup: MysterySetup,
    program: int,
    fault: HiddenFault | None,
    seed: int,
    observers: bool = False,
    diagnosis: bool = False,
    end: float | None = None,
) -> ResolvedExperiment:
    """Return the experiment of a challenge.

    `program`: place of the input among those of the set-up; `end`: its length in s where it is shorter, with the
    detector's thresholds of the whole.
    """
    plant = setup_plant(setup.id)
    base = Experiment(
        id="mystery",
        title=LocalText(setup.title.model_dump()),
        plant=plant,
        inputs=setup.inputs[program],
        faults=(fault_of(fault),) if fault else (),
        noise=setup.noise,
        seed=seed,
        horizon=setup.horizon if end is None else end,
        step=setup.step,
        record=setup.record,
        evaluate=setup.record,
        measurement=SampledMeasurement(period=setup.record),
        observers=tuple(_hunter(s.channel) for s in setup.suspects) if observers else (),
        diagnosis=DiagnosisSettings(enabled=diagnosis, span=setup.horizon),
    )
    return library.resolve(base)


def _hunter(channel: str) -> ObserverConfig:
    """Return an observer that suspects one channel and nothing else."""
    return ObserverConfig(label=f"only_{channel}"[:32], kind="adaptive-kalman-discrete", options={"channels": channel})


def hunter_label(channel: str) -> str:
    """Return the label of the observer that suspects a channel."""
    return _hunter(channel).label
