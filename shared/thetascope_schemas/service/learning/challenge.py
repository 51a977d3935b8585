"""A hidden fault: the truth, what could be told of it and when, an answer, and the points that it earns."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from thetascope_schemas.experiment.base import Instant, Number, Positive, Reference, Strict, example
from thetascope_schemas.experiment.diagnosis import Sentence
from thetascope_schemas.texts.refusal import refuse

NO_FAULT = ""
"""In place of the name of a channel: nothing is wrong."""
MOST_ACCUSATIONS = 20
_RIVAL = {"channel": "pump1", "fair_until": 430.0, "until": 452.0}
_ACCUSED = {"channel": "pump1", "at": 433.0}
_POINTS = {
    "of": "size",
    "points": 12,
    "most": 20,
    "why": {"code": "challenge.size.off", "args": {"share": 15}, "text": "15 % off"},
}
_FAULT = {"channel": "leak1", "shape": "step", "onset": 400.0, "size": 0.08, "duration": None}
Verdict = Literal["channel", "none", "cannot-be-told"]
Size = Annotated[Number | None, Field(description="Size in the unit of the channel; of a ramp, its final one.")]


class HiddenFault(Strict):
    """The fault that is to be found: sudden, or a ramp."""

    model_config = example(**_FAULT)

    channel: Reference
    shape: Literal["step", "ramp"]
    onset: Instant = Field(description="Time in s at which it begins.")
    size: Number = Field(description="Size in the unit of the channel; of a ramp, its final one.")
    duration: Positive | None = Field(default=None, description="Time in s that a ramp takes; null: it is sudden.")


class Rival(Strict):
    """Another explanation of the record, and how long it fitted: by the best size and onset that it can have."""

    model_config = example(**_RIVAL)

    channel: str = Field(description="Name of the channel; empty: no fault.")
    fair_until: Instant | None = Field(description="Time in s from which three deviations separate it; null: never.")
    until: Instant | None = Field(description="Time in s from which five deviations separate it; null: never.")


class ChallengeTruth(Strict):
    """What was hidden, and what could be told of it and when."""

    model_config = example(fault=_FAULT, end=1200.0, rivals=[_RIVAL], seen=[[400.0, 0.0], [1200.0, 90.0]])

    fault: HiddenFault | None = Field(description="Null: there is no fault.")
    end: Instant = Field(description="Length of the record in s.")
    rivals: tuple[Rival, ...] = Field(default=(), description="All other explanations; none where there is no fault.")
    seen: tuple[tuple[Number, Number], ...] = Field(
        default=(), description="Times in s, and how many deviations of the noise separate the record from no fault."
    )

    def alike(self, t: float, fair: bool = False) -> frozenset[str]:
        """Return the explanations that fit until a time, with the true one; `fair`: to three deviations, not five."""
        limits = {rival.channel: rival.fair_until if fair else rival.until for rival in self.rivals}
        fit = {channel for channel, until in limits.items() if until is None or until > t}
        return frozenset(fit | {self.fault.channel if self.fault else NO_FAULT})

    def told_from(self, t: float | None = None, fair: bool = False) -> float:
        """Return the time from which only those fit that fit until `t` (the end) and no others."""
        if self.fault is None:
            return self.end
        last = self.end if t is None else t
        excluded = [rival for rival in self.rivals if rival.until is not None and rival.until <= last]
        limits = (rival.fair_until if fair else rival.until for rival in excluded)
        return max((limit for limit in limits if limit is not None), default=self.fault.onset)

    def deviations(self, t: float) -> float:
        """Return how many deviations of the noise separate the record from no fault until a time."""
        return max((value for at, value in self.seen if at <= t), default=0.0)


class Accusation(Strict):
    """A channel that was named before the answer, and taken back."""

    model_config = example(**_ACCUSED)

    channel: Reference
    at: Instant = Field(description="Time in s of the record at which it was named.")


class ChallengeAnswer(Strict):
    """An answer: one channel with onset and size, no fault, or some that look alike."""

    model_config = example(verdict="channel", channel="leak1", onset=401.0, size=0.09, at=460.0, accused=[_ACCUSED])

    verdict: Verdict
    channel: Reference | None = None
    alike: tuple[Reference, ...] = Field(
        default=(), max_length=40, description="The channels that look alike, where it cannot be told."
    )
    onset: Instant | None = Field(default=None, description="Time in s at which it is thought to have begun.")
    size: Size = None
    at: Instant = Field(description="Time in s of the record at which the answer was given.")
    accused: tuple[Accusation, ...] = Field(default=(), max_length=MOST_ACCUSATIONS)

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if (self.verdict == "channel") != (self.channel is not None):
            raise refuse("challenge.answer.channel", "channel", self.channel)
        if (self.verdict == "cannot-be-told") != (len(set(self.alike)) >= 2):
            raise refuse("challenge.answer.alike", "alike", list(self.alike))
        return self

    @property
    def named(self) -> frozenset[str]:
        """Return the explanations that it leaves."""
        if self.verdict == "none":
            return frozenset({NO_FAULT})
        return frozenset(self.alike) if self.channel is None else frozenset({self.channel})


class Points(Strict):
    """Points for one of the four things that count."""

    model_config = example(**_POINTS)

    of: Literal["name", "size", "soon", "accused"]
    points: int = Field(description="Points that were earned.")
    most: int = Field(description="Points that could be earned.")
    why: Sentence


class Score(Strict):
    """The points of an answer."""

    model_config = example(total=92, points=[_POINTS])

    total: int = Field(description="Points together, at most 100.")
    points: tuple[Points, ...]
