"""Timed commands: changes during an experiment other than faults, which have times already.

An experiment with the timed commands of a live session reproduces the numbers of that session.
"""

from collections.abc import Iterable
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from thetascope_schemas.experiment.base import MAX_POINTS, Instant, NonNegative, Positive, Reference, Strict, example
from thetascope_schemas.experiment.measurement import Truth
from thetascope_schemas.experiment.observers import Gain, Label, ObserverConfig
from thetascope_schemas.experiment.signals import Signal, points_of
from thetascope_schemas.texts.refusal import refuse


class Timed(Strict):
    """Base of all timed commands, which take effect at the time `at`."""

    at: Instant = Field(description="Time in s at which it takes effect, a multiple of the step.")


class GainChange(Strict):
    """A new value of a gain."""

    model_config = example(observer="adaptive", gain="rho", value=8)

    observer: Label = Field(description="Label of the observer.")
    gain: Reference = Field(description="Name of the gain.")
    value: Gain = Field(description="The new value: a number, a list for a column, or a list of rows for a matrix.")


class SignalChange(Strict):
    """A new input or known signal."""

    model_config = example(name="u", signal={"kind": "constant", "value": 0.05})

    name: Reference = Field(description="Name of an input or a known signal of the plant.")
    signal: Signal


class NoiseChange(Strict):
    """New noise of an output."""

    model_config = example(output="y", std=0.002, sample_time=0.01)

    output: Reference = Field(description="Name of the output.")
    std: NonNegative = Field(description="Standard deviation, in the output's unit.")
    sample_time: Positive = Field(default=0.01, description="Time in s for which each drawn value is held.")


class TruthChange(Strict):
    """A new truth."""

    model_config = example(truth={"deviation": 0.02})

    truth: Truth = Field(description="The truth in full; its `states` stay as they were when the run began.")


class SetGain(GainChange, Timed):
    """Change a gain of an observer."""

    model_config = example(at=12.5, command="set-gain", observer="adaptive", gain="rho", value=8)

    command: Literal["set-gain"] = "set-gain"


class SetSignal(SignalChange, Timed):
    """Replace an input or a known signal. The time of the new signal is that of the run, not counted from `at`."""

    model_config = example(at=12.5, command="set-signal", name="u", signal={"kind": "constant", "value": 0.05})

    command: Literal["set-signal"] = "set-signal"


class SetNoise(NoiseChange, Timed):
    """Change the measurement noise of one output."""

    model_config = example(at=12.5, command="set-noise", output="y", std=0.002, sample_time=0.01)

    command: Literal["set-noise"] = "set-noise"


class SetTruth(TruthChange, Timed):
    """Change the true plant and its sensors; observers and the detector keep their model."""

    model_config = example(at=12.5, command="set-truth", truth={"deviation": 0.02})

    command: Literal["set-truth"] = "set-truth"


class AddObserver(Timed):
    """Add an observer, whose estimates start at that time."""

    model_config = example(at=12.5, command="add-observer", observer={"label": "ekf", "kind": "joint-ekf"})

    command: Literal["add-observer"] = "add-observer"
    observer: ObserverConfig


class RemoveObserver(Timed):
    """Remove an observer."""

    model_config = example(at=12.5, command="remove-observer", label="ekf")

    command: Literal["remove-observer"] = "remove-observer"
    label: Label


class SetSubsteps(Timed):
    """Set the number of substeps of every integration step, for stiff gains."""

    model_config = example(at=12.5, command="set-substeps", substeps=4)

    command: Literal["set-substeps"] = "set-substeps"
    substeps: Annotated[int, Field(ge=1, le=64)]


OfTruth = SetSignal | SetNoise | SetTruth
"""Commands that change what is measured, not how it is observed."""
TimedCommand = Annotated[
    SetGain | SetSignal | SetNoise | SetTruth | AddObserver | RemoveObserver | SetSubsteps,
    Field(discriminator="command"),
]

MAX_COMMANDS = 2000


def points_in(commands: Iterable[TimedCommand]) -> int:
    """Return the number of points that the signals of commands list; together they may have MAX_POINTS."""
    return sum(points_of(command.signal) for command in commands if isinstance(command, SetSignal))


def _few_points(commands: tuple[TimedCommand, ...]) -> tuple[TimedCommand, ...]:
    """Return commands; refuse them if their signals list more than MAX_POINTS points together."""
    if (points := points_in(commands)) > MAX_POINTS:
        raise refuse("command.points.many", value=points, points=points, limit=MAX_POINTS)
    return commands


TimedCommands = Annotated[tuple[TimedCommand, ...], Field(max_length=MAX_COMMANDS), AfterValidator(_few_points)]
"""All timed commands of an experiment."""

__all__ = [
    "MAX_COMMANDS",
    "AddObserver",
    "GainChange",
    "NoiseChange",
    "RemoveObserver",
    "SetGain",
    "SetNoise",
    "SetSignal",
    "SetSubsteps",
    "SetTruth",
    "SignalChange",
    "TimedCommand",
    "TimedCommands",
    "TruthChange",
    "points_in",
]
