"""Diagnosis: settings, and findings (fault, onset, size, confidence, and faults that cannot be observed)."""

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
    """Settings of the diagnosis. Thresholds are not set directly; they are calibrated by simulation."""

    model_config = example(enabled=True, false_alarms=0.01, test="glr", confidence=0.95, accuracy=0.1, doubt=0.01)

    enabled: bool = Field(default=True, description="Whether the run is diagnosed.")
    false_alarms: Positive = Field(default=0.01, description="Accepted false alarms per hour, for each observer.")
    test: Test = Field(default="glr", description="Test that raises alarms.")
    confidence: Annotated[Number, Field(ge=0.5, le=0.9999)] = Field(
        default=0.95, description="Confidence level of bands and intervals."
    )
    doubt: Annotated[Number, Field(ge=1e-6, le=1.0)] = Field(
        default=0.01,
        description="Accepted model error of a state within the plant's time constant, as a share of its size.",
    )
    span: Positive | None = Field(
        default=None,
        description="Time in s over which thresholds are simulated and decisions are spaced; null: the horizon.",
    )
    accuracy: Annotated[Number, Field(ge=1e-3, le=1.0)] = Field(
        default=0.1,
        description="Required standard deviation of an estimate, as a share of the channel's typical fault.",
    )


class Alarm(Strict):
    """One fault found by the tests of an observer or of the detector."""

    model_config = example(**_ALARM)

    id: str = Field(
        default="",
        description="Id within the run or session; it does not change when the alarm is revised. Empty in old results.",
    )
    observer: str = Field(description="Label of the observer; empty: the detector, which uses the measurements only.")
    t: Number = Field(description="Time in s at which the alarm was raised.")
    kind: Literal["fault", "unexplained"] = Field(
        description="A fault in a channel of the model, or one that the model does not explain."
    )
    channel: str = Field(default="", description="The channel that explains the data best; empty if none does.")
    output: str = Field(default="", description="Of an unexplained fault: the output whose residual shows it.")
    alternatives: tuple[str, ...] = Field(default=(), description="Other channels that explain the data equally well.")
    onset: Number = Field(description="Estimated time in s at which the fault began.")
    onset_from: Number = Field(description="Earliest time in s at which it may have begun.")
    onset_to: Number = Field(description="Latest time in s at which it may have begun.")
    size: Number | None = Field(default=None, description="Estimated size in the channel's unit.")
    size_from: Number | None = Field(default=None, description="Lower end of the interval of the size.")
    size_to: Number | None = Field(default=None, description="Upper end of the interval of the size.")
    test: str = Field(description="The test that raised the alarm.")
    statistic: Number = Field(description="Value of the test statistic, without a unit.")
    threshold: Number = Field(description="Threshold of the test statistic.")
    cleared: Number | None = Field(
        default=None, description="Time in s at which the alarm was cleared; null: it is still on."
    )
    text: Sentence = Field(description="The finding in a sentence.")


class Resolution(Strict):
    """The smallest fault in one channel that can be found, with the given noise and gains."""

    model_config = example(**_RESOLUTION)

    channel: str = Field(description="The fault channel.")
    sigma: Number | None = Field(description="Standard deviation of the estimate in the fault's unit, at the end.")
    typical: Number = Field(description="Size of a typical fault in this channel.")
    smallest: Number | None = Field(
        description="Smallest step that can be found within the longest window; null: none."
    )
    resolvable: bool = Field(description="Whether a typical fault can be found.")
    identifiable: bool = Field(description="Whether the input in the last window excites the fault enough.")
    text: MaybeSentence = Field(
        default=None, description="The same in a sentence: the smallest size, or the reason why it is missing."
    )


class Observability(Strict):
    """Joint observability of the states and all faults: from the equations, and along a run."""

    model_config = example(
        rank=5,
        size=5,
        text="all faults and states can be distinguished",
        window=10.0,
        t=[0.0, 90.0],
        ranks=[5, 5],
        conditions=[1200.0, 340.0],
        along="rank 5 of 5 over 10 s, condition 3.4e+02 to 1.2e+03",
    )

    rank: int | None = Field(
        description="Generic rank of the observability matrix of states and faults (Lie derivatives); null: undecided."
    )
    size: int = Field(description="Number of states and faults.")
    text: Sentence = Field(description="The states and faults that no input can distinguish, in a sentence.")
    window: Number = Field(description="Length in s of the windows along the run.")
    t: list[Number] = Field(description="Times in s at which the windows begin.")
    ranks: list[int | None] = Field(
        description="Rank of the empirical Gramian over each window; null: the plant diverges."
    )
    conditions: list[Number | None] = Field(
        description="Its condition number, in units of typical sizes; null below full rank."
    )
    along: Sentence = Field(description="The same in a sentence, with the least observable combination.")


class Excitation(Strict):
    """Excitation of the faults: the smallest eigenvalue of the windowed Gramian of Ω, in units of typical faults."""

    model_config = example(**_EXCITATION)

    window: Number = Field(description="Length of the window in s.")
    level: Number | None = Field(description="Smallest eigenvalue, in (typical fault / its standard deviation)².")
    needed: Number = Field(description="Level that the required accuracy needs.")
    direction: dict[Reference, Number] = Field(
        description="The least excited combination of faults: its component for each channel."
    )
    text: MaybeSentence = Field(
        default=None, description="The result in a sentence: the faults that cannot be distinguished."
    )
    proposal: str | None = Field(default=None, description="An input that would excite the faults more.")


class InputProposal(Strict):
    """An input that would restore excitation, or the reason why it is missing. Send `signal` with set-signal."""

    model_config = example(**_PROPOSAL)

    input: Reference | None = Field(description="The input to change; null: no signal that was tried helps.")
    signal: Signal | None = Field(description="The proposed signal, from now on.")
    level: Number = Field(
        description="Smallest eigenvalue with that signal, in (typical fault / its standard deviation)²."
    )
    before: Number = Field(description="Smallest eigenvalue with the present input.")
    needed: Number = Field(description="Level that the required accuracy needs.")
    text: Sentence = Field(description="The proposal in a sentence, or the reason why it is missing.")


class Calibration(Strict):
    """Calibration of the thresholds by simulation."""

    model_config = example(**_CALIBRATION)

    false_alarms: Number = Field(description="Accepted false alarms per hour.")
    thresholds: dict[str, Number] = Field(description="Threshold of each test.")
    seeds: int = Field(description="Number of simulated runs without faults.")
    hours: Number = Field(description="Total simulated time in hours.")
    from_time: Number = Field(description="Time in s from which the tests decide; before it the observer is settling.")
    note: MaybeSentence = Field(default=None, description="A limitation of the calibration, if there is one.")


class NoiseLevel(Strict):
    """Noise of one output: declared, and estimated from the residual."""

    model_config = example(output="y", declared=0.001, estimated=0.00098)

    output: str = Field(description="The measured output.")
    declared: Number | None = Field(description="Standard deviation declared in the experiment; null: none.")
    estimated: Number | None = Field(description="Standard deviation estimated from the residual; null: unknown.")


class ObserverDiagnosis(Strict):
    """The diagnosis by one observer or by the detector."""

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

    observer: str = Field(description="Label of the observer; empty: the detector, which uses the measurements only.")
    alarms: tuple[Alarm, ...] = Field(default=(), description="Alarms in order of time.")
    resolution: tuple[Resolution, ...] = Field(
        default=(), description="For each channel, the smallest fault that can be found."
    )
    excitation: Excitation | None = Field(
        default=None, description="Excitation of the faults by the input, at the end."
    )
    calibration: Calibration | None = Field(default=None, description="Calibration of the thresholds.")
    noise: tuple[NoiseLevel, ...] = Field(default=(), description="Noise of each output.")
    sentence: MaybeSentence = Field(default=None, description="The diagnosis in a sentence.")
    note: MaybeSentence = Field(default=None, description="The reason if there is no diagnosis.")


class Diagnosis(Strict):
    """The diagnosis of a run: by the detector, from the measurements, and by each observer, from its estimates."""

    model_config = example(detector={"observer": "", "alarms": [_ALARM]}, observers=[])

    detector: ObserverDiagnosis = Field(
        description="Diagnosis by the detector, which does not depend on the observers."
    )
    observers: tuple[ObserverDiagnosis, ...] = Field(
        default=(), description="Diagnosis by tests on each observer's θ̂, for comparison."
    )
