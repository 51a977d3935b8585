"""Diagnosis: what is asked of it, and what it says. Which fault, since when, how large, how sure; and what cannot be seen."""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from thetascope_schemas.experiment.base import Number, Positive, Reference, Strict, Text, Worded, example
from thetascope_schemas.experiment.signals import Signal

Test = Literal["glr", "cusum", "threshold"]


def _sentence(value: Any) -> Any:
    """Return a message in its form on the wire, no message as None, and a plain text as a sentence without a code."""
    if isinstance(value, Worded):
        return Text.of(value)
    if isinstance(value, str):
        return Text(code="", text=value) if value else None
    return value


Sentence = Annotated[Text, BeforeValidator(_sentence)]
MaybeSentence = Annotated[Text | None, BeforeValidator(_sentence)]

_ALARM = {
    "id": "adaptive-1",
    "observer": "adaptive",
    "t": 20.6,
    "kind": "fault",
    "channel": "theta3",
    "alternatives": [],
    "onset": 20.0,
    "onset_from": 19.9,
    "onset_to": 20.1,
    "size": 0.02,
    "size_from": 0.0197,
    "size_to": 0.0203,
    "test": "glr",
    "statistic": 41.0,
    "threshold": 29.5,
    "cleared": None,
    "text": {
        "code": "diagnosis.alarm.unexplained",
        "args": {"output": "y", "when": "since 20.0 s"},
        "text": "y: not explained by any fault of the model, since 20.0 s",
    },
}
_RESOLUTION = {
    "channel": "theta3",
    "sigma": 0.0003,
    "typical": 0.02,
    "smallest": 0.0011,
    "resolvable": True,
    "identifiable": True,
    "text": None,
}
_EXCITATION = {
    "window": 10.0,
    "level": 420.0,
    "needed": 100.0,
    "direction": {"theta1": 0.71, "theta2": -0.71},
    "text": {"code": "diagnosis.excitation.visible", "args": {"times": 20.5}, "text": "the fault can be seen"},
    "proposal": None,
}
_PROPOSAL = {
    "input": "voltage",
    "signal": {"kind": "pulse", "low": 0, "high": 24, "period": 0.8, "width": 0.4, "start": 12},
    "level": 420.0,
    "before": 0.3,
    "needed": 100.0,
    "text": {"code": "diagnosis.proposal.no-input", "args": {}, "text": "the plant has no input that could excite it"},
}
_CALIBRATION = {
    "false_alarms": 0.01,
    "thresholds": {"glr": 29.5, "residual": 33.0},
    "seeds": 32,
    "hours": 0.8,
    "from_time": 6.0,
    "note": None,
}


class DiagnosisSettings(Strict):
    """What is asked of the diagnosis. Thresholds follow from it by simulation; none is typed in."""

    model_config = example(enabled=True, false_alarms=0.01, test="glr", confidence=0.95, accuracy=0.1, doubt=0.01)

    enabled: bool = Field(default=True, description="Whether anything is diagnosed at all.")
    false_alarms: Annotated[Number, Field(ge=1e-4, le=100)] = Field(
        default=0.01, description="False alarms per hour that are put up with, of each observer."
    )
    test: Test = Field(default="glr", description="Test of the estimates that raises alarms.")
    confidence: Annotated[Number, Field(ge=0.5, le=0.9999)] = Field(default=0.95, description="Of bands and intervals.")
    doubt: Annotated[Number, Field(ge=1e-6, le=1.0)] = Field(
        default=0.01,
        description="Share of a state's size by which its equation may be off within the plant's time constant.",
    )
    span: Positive | None = Field(
        default=None,
        description="Time in s that thresholds are simulated over and decisions are spaced for; null: the horizon.",
    )
    accuracy: Annotated[Number, Field(ge=1e-3, le=1.0)] = Field(
        default=0.1, description="Standard deviation asked of an estimate, as a share of the channel's typical fault."
    )


class Alarm(Strict):
    """One fault that an observer's tests found."""

    model_config = example(**_ALARM)

    id: str = Field(
        default="",
        description="Id within the run or session: it stays while the alarm is revised. Empty in old results.",
    )
    observer: str = Field(description="Label of the observer; empty: the detector, which watches the plant itself.")
    t: Number = Field(description="Time in s at which the alarm was raised.")
    kind: Literal["fault", "unexplained"] = Field(description="In a channel of the model, or not explained by it.")
    channel: str = Field(default="", description="The channel that explains the data best; empty where none does.")
    output: str = Field(default="", description="Not explained by the model: the output whose residual says so.")
    alternatives: tuple[str, ...] = Field(default=(), description="Channels that explain the data as well.")
    onset: Number = Field(description="Estimated time in s at which the fault began.")
    onset_from: Number = Field(description="Earliest time in s at which it may have begun.")
    onset_to: Number = Field(description="Latest time in s at which it may have begun.")
    size: Number | None = Field(default=None, description="Estimated size in the channel's unit.")
    size_from: Number | None = Field(default=None, description="Lower end of the interval of the size.")
    size_to: Number | None = Field(default=None, description="Upper end of the interval of the size.")
    test: str = Field(description="The test that raised it.")
    statistic: Number = Field(description="What the test came to, without a unit.")
    threshold: Number = Field(description="What the statistic was held against.")
    cleared: Number | None = Field(
        default=None, description="Time in s at which the alarm was over; null: it is still on."
    )
    text: Sentence = Field(description="The finding in a sentence.")


class Resolution(Strict):
    """How small a fault in one channel can be and still be found, at this noise and with these gains."""

    model_config = example(**_RESOLUTION)

    channel: str = Field(description="The fault channel.")
    sigma: Number | None = Field(description="Standard deviation of the estimate in the fault's unit, at the end.")
    typical: Number = Field(description="Size of a typical fault in this channel.")
    smallest: Number | None = Field(description="Smallest step that is found within the longest window, null: none.")
    resolvable: bool = Field(description="Whether a typical fault can be found at all.")
    identifiable: bool = Field(description="Whether the input of the last window excites it enough.")
    text: MaybeSentence = Field(default=None, description="In words: from what size on, or why not.")


class Observability(Strict):
    """What the outputs show of the states and of all faults together: by the equations, and along a run."""

    model_config = example(
        rank=5,
        size=5,
        text="all faults and states can be told apart",
        window=10.0,
        t=[0.0, 90.0],
        ranks=[5, 5],
        conditions=[1200.0, 340.0],
        along="rank 5 of 5 over 10 s, condition 3.4e+02 to 1.2e+03",
    )

    rank: int | None = Field(
        description="Generic rank of the observability matrix of states and faults (Lie derivatives); null: not decided."
    )
    size: int = Field(description="States and faults.")
    text: Sentence = Field(description="What no input could tell apart, in words.")
    window: Number = Field(description="Length in s of the windows along the run.")
    t: list[Number] = Field(description="When they begin, in s.")
    ranks: list[int | None] = Field(
        description="Rank of the empirical Gramian over each; null: the plant does not stay finite."
    )
    conditions: list[Number | None] = Field(
        description="Its condition, in units of typical sizes; null below full rank."
    )
    along: Sentence = Field(description="The same in words, with the combination that is seen least.")


class Excitation(Strict):
    """What the input tells about the faults: the smallest eigenvalue of the windowed Gramian of Ω in typical faults."""

    model_config = example(**_EXCITATION)

    window: Number = Field(description="Length of the window in s.")
    level: Number | None = Field(description="Smallest eigenvalue, in (typical fault / its standard deviation)².")
    needed: Number = Field(description="Level that the accuracy asked for needs.")
    direction: dict[Reference, Number] = Field(description="The combination of faults that is seen least, per channel.")
    text: MaybeSentence = Field(default=None, description="In words: what cannot be told apart.")
    proposal: str | None = Field(default=None, description="An input that would help.")


class InputProposal(Strict):
    """An input that would restore excitation, or why there is none: `signal` can be sent as it is with set-signal."""

    model_config = example(**_PROPOSAL)

    input: Reference | None = Field(description="The input to be changed; null: nothing that was tried helps.")
    signal: Signal | None = Field(description="Its course from now on.")
    level: Number = Field(description="Smallest eigenvalue that it would reach, in (typical fault / its deviation)².")
    before: Number = Field(description="The same with the input as it is.")
    needed: Number = Field(description="Level that the accuracy asked for needs.")
    text: Sentence = Field(description="The proposal in a sentence, or why there is none.")


class Calibration(Strict):
    """Where the thresholds come from."""

    model_config = example(**_CALIBRATION)

    false_alarms: Number = Field(description="Rate per hour that was asked for.")
    thresholds: dict[str, Number] = Field(description="By test: the level that raises an alarm.")
    seeds: int = Field(description="Runs without faults that were simulated.")
    hours: Number = Field(description="Time simulated in all, in hours.")
    from_time: Number = Field(description="Time in s before which nothing is judged: the observer is still settling.")
    note: MaybeSentence = Field(default=None, description="What limits the calibration, where something does.")


class NoiseLevel(Strict):
    """Noise of one output: as declared, and as the residual shows it."""

    model_config = example(output="y", declared=0.001, estimated=0.00098)

    output: str = Field(description="The measured output.")
    declared: Number | None = Field(description="Standard deviation that the experiment declares; null: none.")
    estimated: Number | None = Field(description="Standard deviation as the residual shows it; null: not known.")


class ObserverDiagnosis(Strict):
    """What one observer says about the faults."""

    model_config = example(
        observer="adaptive",
        alarms=[_ALARM],
        resolution=[_RESOLUTION],
        excitation=_EXCITATION,
        calibration=_CALIBRATION,
        noise=[],
        sentence={"code": "diagnosis.summary.quiet", "args": {}, "text": "No fault."},
        note=None,
    )

    observer: str = Field(description="Label of the observer; empty: the detector, which watches the plant itself.")
    alarms: tuple[Alarm, ...] = Field(default=(), description="What was found, in order of time.")
    resolution: tuple[Resolution, ...] = Field(
        default=(), description="By channel: how small a fault can be and still be found."
    )
    excitation: Excitation | None = Field(
        default=None, description="What the input tells about the faults, at the end."
    )
    calibration: Calibration | None = Field(default=None, description="Where the thresholds come from.")
    noise: tuple[NoiseLevel, ...] = Field(default=(), description="Noise of each output.")
    sentence: MaybeSentence = Field(default=None, description="The diagnosis in a sentence.")
    note: MaybeSentence = Field(default=None, description="Why there is no diagnosis, where there is none.")


class Diagnosis(Strict):
    """The diagnosis of a run: by the detector, which looks at what was measured, and by each observer's own estimates."""

    model_config = example(detector={"observer": "", "alarms": [_ALARM]}, observers=[])

    detector: ObserverDiagnosis = Field(description="What the detector says: it watches the plant, not the observers.")
    observers: tuple[ObserverDiagnosis, ...] = Field(
        default=(), description="What tests on each observer's θ̂ say, for comparison."
    )
