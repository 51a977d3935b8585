"""What the bodies of requests for sessions hold."""

from typing import Annotated

from pydantic import Field, JsonValue

from thetascope.runs.specs.refusals import invalid
from thetascope.runs.specs.resolve_spec import library_experiment, resolved, with_changes
from thetascope_schemas.experiment.base import Flag, Identifier, Instant, Strict, example
from thetascope_schemas.experiment.experiment import Experiment


class SessionRequest(Strict):
    """A session on an experiment of the library, or on a spec."""

    model_config = example(experiment="zhao-2012", play=True)

    experiment: Identifier | None = Field(None, description="Id of a library experiment …")
    set: dict[str, JsonValue] = Field(
        default_factory=dict, max_length=200, description="… and values changed by path, as for runs."
    )
    spec: Experiment | None = Field(None, description="Or a whole experiment, its timed commands included.")
    play: Flag = Field(True, description="Let time run at once.")
    speed: Annotated[float, Field(ge=0.1, le=1000, strict=True)] | None = Field(
        1.0, description="Simulated seconds per second; null: as fast as possible."
    )
    t: Instant = Field(0.0, description="Time in s at which the session stands when it opens.")

    def resolved(self) -> Experiment:
        """The experiment with its plant in full. Raises InvalidSpec, or Unknown for an id not in the library."""
        if (self.experiment is None) == (self.spec is None):
            raise invalid("experiment", self.experiment, "a session needs an experiment or a spec", "give one of them")
        if self.spec is not None and self.set:
            raise invalid("set", None, "changes by path are for library experiments", "change the spec itself")
        spec = self.spec if self.spec is not None else with_changes(library_experiment(self.experiment), self.set)
        return resolved(spec)


class ForkRequest(Strict):
    """From when on a second session goes its own way."""

    model_config = example(t=20)

    t: Instant | None = Field(None, description="Time in s, up to the present one; null: now.")
