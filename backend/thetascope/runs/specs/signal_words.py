"""Input signals in lists and logs: their values in few fields, and in words."""

import math

from pydantic import JsonValue

from thetascope.messages import Message
from thetascope_schemas.experiment.signals import ConstantSignal, Signal, SineSignal, StepsSignal, TableSignal


def signal_values(signal: Signal) -> dict[str, JsonValue]:
    """Return the fields of a signal; a list of points is given by its length, least and greatest value."""
    if not isinstance(signal, StepsSignal | TableSignal):
        return signal.model_dump(mode="json")
    return {
        "kind": signal.kind,
        "points": len(signal.values),
        "low": min(signal.values),
        "high": max(signal.values),
    }


def signal_words(signal: Signal) -> Message:
    """Return a signal in words, as a message: its shape and sizes."""
    if isinstance(signal, SineSignal):
        if signal.frequency == 0:
            return signal_words(ConstantSignal(value=signal.offset + signal.amplitude * math.sin(signal.phase)))
        return Message(
            "signal.words.sine", offset=signal.offset, amplitude=signal.amplitude, period=1 / signal.frequency
        )
    values = signal_values(signal)
    named = {name: value for name, value in values.items() if isinstance(value, int | float | str) and name != "kind"}
    return Message(f"signal.words.{signal.kind}", **named)
