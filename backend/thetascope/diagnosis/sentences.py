"""Sentences of several messages."""

from collections.abc import Sequence

from thetascope.messages import Message


def joined(sentences: Sequence[Message]) -> Message:
    """Return messages as one, separated by semicolons. Raises ValueError for an empty list."""
    if not sentences:
        raise ValueError("no message to join")
    first, *rest = sentences
    return Message("diagnosis.joined", first=first, rest=joined(rest)) if rest else first
