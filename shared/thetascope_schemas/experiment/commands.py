"""Timed commands: what is changed while an experiment runs, other than faults (which carry their own times).

A live session's log of such commands, put into its experiment, is a spec that gives the session's numbers again.
"""

from typing import Annotated, Literal

from pydantic import Field

from thetascope_schemas.experiment.base import Instant, NonNegative, Positive, Reference, Strict, example
from thetascope_schemas.experiment.observers import Gain, Label, ObserverConfig
from thetascope_schemas.experiment.signals import Signal


class Timed(Strict):
    """What all timed commands share: they act from `at` on."""

    at: Instant = Field(description="Time in s, a multiple of the step, from which it acts.")


class SetGain(Timed):
    """Give an observer's gain another value."""

    model_config = example(at=12.5, command="set-gain", observer="adaptive", gain="rho", value=8)

    command: Literal["set-gain"] = "set-gain"
    observer: Label = Field(description="Label of the observer.")
    gain: Reference = Field(description="Name of the gain.")
    value: Gain = Field(description="The new value: a number, a list for a column, or a list of rows for a matrix.")


class SetSignal(Timed):
    """Give an input or a known signal another course. Its time is that of the run, not counted from `at`."""

    model_config = example(at=12.5, command="set-signal", name="u", signal={"kind": "constant", "value": 0.05})

    command: Literal["set-signal"] = "set-signal"
    name: Reference = Field(description="Name of an input or a known signal of the plant.")
    signal: Signal


class SetNoise(Timed):
    """Change the measurement noise of one output."""

    model_config = example(at=12.5, command="set-noise", output="y", std=0.002, sample_time=0.01)

    command: Literal["set-noise"] = "set-noise"
    output: Reference = Field(description="Name of the output.")
    std: NonNegative = Field(description="Standard deviation, in the output's unit.")
    sample_time: Positive = Field(default=0.01, description="Time in s for which a drawn value holds.")


class AddObserver(Timed):
    """Let another observer watch from here on; its estimates start here."""

    model_config = example(at=12.5, command="add-observer", observer={"label": "ekf", "kind": "joint-ekf"})

    command: Literal["add-observer"] = "add-observer"
    observer: ObserverConfig


class RemoveObserver(Timed):
    """Let an observer watch no longer."""

    model_config = example(at=12.5, command="remove-observer", label="ekf")

    command: Literal["remove-observer"] = "remove-observer"
    label: Label


class SetSubsteps(Timed):
    """Take every step of the integration in so many substeps from here on (stiff gains)."""

    model_config = example(at=12.5, command="set-substeps", substeps=4)

    command: Literal["set-substeps"] = "set-substeps"
    substeps: Annotated[int, Field(ge=1, le=64)]


TimedCommand = Annotated[
    SetGain | SetSignal | SetNoise | AddObserver | RemoveObserver | SetSubsteps, Field(discriminator="command")
]

MAX_COMMANDS = 2000


__all__ = [
    "MAX_COMMANDS",
    "AddObserver",
    "RemoveObserver",
    "SetGain",
    "SetNoise",
    "SetSignal",
    "SetSubsteps",
    "TimedCommand",
]
