"""An experiment that suits a plant, a preview of it, and observers ranked for it."""

from typing import Literal

from pydantic import Field

from thetascope_schemas.experiment.base import ExpressionText, Number, Reference, Strict, Text, example
from thetascope_schemas.experiment.experiment import Experiment, PlantChoice
from thetascope_schemas.experiment.plant import Channel, Parameter, State
from thetascope_schemas.experiment.signals import Signal

Series = dict[str, tuple[Number, ...]]


class PlantTrialRequest(Strict):
    """A plant, and values that differ from its own."""

    model_config = example(plant="dc-motor", parameters={"R": 1.2}, initial={}, inputs={})

    plant: PlantChoice
    parameters: dict[Reference, Number] = Field(default_factory=dict, description="Parameters that differ.")
    initial: dict[Reference, Number] = Field(default_factory=dict, description="Initial states that differ.")
    inputs: dict[Reference, Signal] = Field(default_factory=dict, description="Inputs; default: square waves.")


class PlantPreview(Strict):
    """Simulations of a plant without noise: healthy, and with a fault of usual size in each channel from `onset` on."""

    model_config = example(
        t=[0, 1],
        onset=0.5,
        inputs={"u": [1, 1]},
        outputs={"y": [0, 0.1]},
        faulty={"leak": {"y": [0, 0.05]}},
        sizes={"leak": 0.1},
        seconds=[[0.2]],
    )

    t: tuple[Number, ...] = Field(description="Times in s.")
    onset: Number = Field(description="Time in s at which the faults begin.")
    inputs: Series = Field(description="Inputs without faults, by name.")
    outputs: Series = Field(description="Outputs without faults, by name.")
    faulty: dict[str, Series] = Field(
        description="Outputs with the fault of a channel, by channel and output; a list ends where the plant diverges."
    )
    sizes: dict[str, Number] = Field(description="Size of the fault, by channel.")
    seconds: tuple[tuple[Number | None, ...], ...] = Field(
        description="Row i, column j: seconds until fault i is distinguished from j, on the diagonal until it is "
        "found, for the best test that knows the onset; null: not within the experiment."
    )


class PlantTrial(Strict):
    """An experiment that suits a plant, without observers, and its preview."""

    model_config = example(
        experiment={"plant": "dc-motor", "horizon": 2, "step": 0.001},
        preview={"t": [0], "onset": 1, "inputs": {}, "outputs": {}, "faulty": {}, "sizes": {}, "seconds": []},
    )

    experiment: Experiment
    preview: PlantPreview


class RankedObserver(Strict):
    """A kind of observer for a plant, and how well it estimates the plant's faults."""

    model_config = example(
        kind="joint-ekf",
        possible=True,
        error=0.08,
        holds=True,
        why={"code": "workshop.observer.diverged", "args": {}, "text": "its estimates diverge"},
    )

    kind: str
    possible: bool = Field(description="Whether it can be built for the plant.")
    error: Number | None = Field(description="Root mean square error in faults of usual size; null: it was not run.")
    holds: bool = Field(description="Whether none of its assumptions failed in the run.")
    why: Text = Field(description="The reason for its rank.")


class ObserverRanking(Strict):
    """All kinds of observers, the best for a plant first."""

    model_config = example(observers=[])

    observers: tuple[RankedObserver, ...]


class FaultPatternRequest(Strict):
    """The equation of a plant in which a fault is to be added."""

    model_config = example(plant="dc-motor", name="current")

    plant: PlantChoice
    name: Reference = Field(description="The state or output whose equation it is.")


class FaultPattern(Strict):
    """A fault that may act in an equation, ready to be added to the plant's text."""

    model_config = example(
        pattern="loss",
        term="q",
        about={"code": "workshop.pattern.loss", "args": {"name": "q"}, "text": "a share of q is lost"},
        math="<math/>",
        channel={"name": "loss_q", "kind": "actuator", "enters": {"h": "-q/A"}, "typical": 0.1, "bounds": [0, 1]},
        conserved={},
        states=[],
        parameters=[],
        equations={},
    )

    pattern: Literal["loss", "leak", "bias", "gain", "lag"]
    term: str = Field(description="The quantity that is disturbed; empty: the whole equation.")
    about: Text = Field(description="What happens, in a sentence.")
    math: str = Field(description="The term with θ as MathML.")
    channel: Channel
    conserved: dict[Reference, ExpressionText] = Field(
        description="Coefficients of θ in the other equations with the term, so that nothing vanishes, by state."
    )
    states: tuple[State, ...] = Field(description="States to add.")
    parameters: tuple[Parameter, ...] = Field(description="Parameters to add.")
    equations: dict[Reference, ExpressionText] = Field(description="Equations of the states to add.")


class FaultPatterns(Strict):
    """The faults that may act in an equation."""

    model_config = example(patterns=[])

    patterns: tuple[FaultPattern, ...]
