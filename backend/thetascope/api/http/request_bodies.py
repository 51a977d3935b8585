"""Bodies of requests that are not specs of the contract: sessions, forks, equations."""

from typing import Annotated

from pydantic import Field, JsonValue

from thetascope.messages import Message
from thetascope.runs.specs.refusals import invalid
from thetascope.runs.specs.resolve_spec import library_experiment, resolved, with_changes
from thetascope_schemas.experiment.base import Flag, Identifier, Instant, Strict, example
from thetascope_schemas.experiment.experiment import Experiment, PlantChoice, ResolvedExperiment
from thetascope_schemas.experiment.observers import Kind


class SessionRequest(Strict):
    """A session on an experiment of the library, or on a spec."""

    model_config = example(experiment="zhao-2012", play=True)

    experiment: Identifier | None = Field(
        default=None, description="Id of a library experiment; an alternative to `spec`."
    )
    set: dict[str, JsonValue] = Field(
        default_factory=dict, max_length=200, description="Values to change in the library experiment, by path."
    )
    spec: Experiment | None = Field(default=None, description="A full experiment with its timed commands.")
    play: Flag = Field(default=True, description="Start playing immediately.")
    speed: Annotated[float, Field(ge=0.1, le=1000, strict=True)] | None = Field(
        default=1.0, description="Simulated seconds per second; null: as fast as possible."
    )
    t: Instant = Field(default=0.0, description="Time in s at which the session opens.")

    @property
    def is_library(self) -> bool:
        """Whether it is an experiment of the library as it is."""
        return self.experiment is not None and self.spec is None and not self.set

    def resolved(self) -> ResolvedExperiment:
        """Return the experiment with its plant in full. Raises InvalidSpec, or Unknown for an id not in the library."""
        if self.spec is not None and self.experiment is None:
            if self.set:
                raise invalid("set", None, Message("session.body.set-with-spec"))
            return resolved(self.spec)
        if self.experiment is not None and self.spec is None:
            return resolved(with_changes(library_experiment(self.experiment), self.set))
        raise invalid("experiment", self.experiment, Message("session.body.no-experiment"))


class EquationsRequest(Strict):
    """The plant and the observers whose equations are requested."""

    model_config = example(plant="zhao-contois", observers=["zhao-adaptive"])

    plant: PlantChoice
    observers: tuple[Kind, ...] | None = Field(default=None, description="Kinds of observers; null: all.")


class ForkRequest(Strict):
    """The time at which the new session branches off."""

    model_config = example(t=20)

    t: Instant | None = Field(default=None, description="Time in s, at most that of the session; null: the present.")
