"""The diagnosis of a record: does the model fit the healthy stretch, and which faults does the rest show?"""

from typing import Any, Literal

from pydantic import Field

from thetascope_schemas.experiment.base import Flag, Number, Reference, Strict, example
from thetascope_schemas.experiment.diagnosis import MaybeSentence, Sentence
from thetascope_schemas.experiment.experiment import PlantChoice
from thetascope_schemas.experiment.measurement import RECORD_SETTINGS, ColumnMapping, Course, RecordSettings

Verdict = Literal["fits", "fits-after-fit", "does-not-fit"]
Shape = Literal["step", "ramp", "drift", "rise", "plateau"]
SuspectKind = Literal["time", "output", "offset", "fahrenheit", "input", "swap-inputs", "swap-outputs", "parameter"]


def _text(code: str, text: str, **args: Any) -> dict[str, Any]:
    return {"code": code, "args": args, "text": text}


_HEALTHY = {"begin": 0.0, "end": 290.0, "given": False, "rows": 290}
_INTERVAL = {"value": 1.001, "low": 0.983, "high": 1.02}
_CANDIDATE = {
    "channel": "offset",
    "title": {"code": "", "args": {}, "text": "sensor offset"},
    "unit": "cm",
    "shape": "step",
    "onset": {"value": 300.0, "low": 299.5, "high": 300.5},
    "size": _INTERVAL,
    "rate": 0.0,
    "bound": None,
    "behind": 0.0,
    "separable": True,
    "text": _text("record.fault.candidate", "sensor offset: 1.00 ± 0.02 cm since 300.0 s"),
}
_FAULT = {
    "id": "fault-1",
    "best": _CANDIDATE,
    "alternatives": [],
    "alarm": 300.0,
    "statistic": 428.0,
    "ended": None,
    "confirmed": True,
    "covered": True,
    "text": _text("record.fault.step", "sensor offset: 1.00 ± 0.02 cm since 300.0 s"),
    "note": None,
}
_OUTPUT = {
    "output": "y",
    "unit": "cm",
    "predicted": 0.977,
    "simulated": 0.976,
    "noise": 0.051,
    "memory": 0.0,
    "innovation": 0.051,
    "bias": -0.1,
    "whiteness": 0.42,
    "text": _text("record.fit.output", "y: one step ahead 98 %, simulated 98 %"),
}
_REASON = {
    "kind": "unit",
    "name": "y",
    "t": None,
    "text": _text("record.misfit.unit", "the readings of y seem to be in another unit"),
}
_SUSPECT = {
    "kind": "output",
    "name": "y",
    "factor": 100.0,
    "gain": 4430.0,
    "simulated": 0.977,
    "text": _text("record.suspect.output", "y × 100 would fit: −2 log L falls by 4430"),
}
_PARAMETER = {"name": "UA", "unit": "W/K", "before": 0.0105, "value": 0.01, "std": 6e-5, "held": False}
_FIT = {
    "verdict": "fits",
    "text": _text("record.verdict.fits", "The model fits the healthy stretch."),
    "outputs": [_OUTPUT],
    "reasons": [],
    "suspects": [],
    "parameters": [],
    "process_noise": {"h": 0.002},
    "advice": [],
}
_DECISION = {"t": 300.0, "statistic": 428.0, "judged": 310.0, "action": "added", "channel": "offset", "onset": 300.0}


class RecordDiagnosisRequest(Strict):
    """The plant of a stored record, the mapping of its columns, and how it is to be diagnosed."""

    model_config = example(plant="dts200", mapping={"time": None, "quantities": {}}, settings=RECORD_SETTINGS)

    plant: PlantChoice = Field(description="Id of a library plant, or a complete plant.")
    mapping: ColumnMapping = Field(default_factory=ColumnMapping, description="Changes of the guessed mapping.")
    settings: RecordSettings = Field(default_factory=RecordSettings, description="Settings of the diagnosis.")


class HealthyStretch(Strict):
    """The stretch on which the noise was estimated and the fit was checked."""

    model_config = example(**_HEALTHY)

    begin: Number = Field(description="Its beginning in s after the first row.")
    end: Number = Field(description="Its end in s after the first row.")
    given: Flag = Field(description="Whether it was declared; else it was found.")
    rows: int = Field(ge=0, description="Its rows.")


class Interval(Strict):
    """A number with its 95 % interval."""

    model_config = example(**_INTERVAL)

    value: Number = Field(description="The estimate.")
    low: Number = Field(description="Lower end of its interval.")
    high: Number = Field(description="Upper end of its interval.")


class OutputFitReport(Strict):
    """How well the model fits one output on the healthy stretch."""

    model_config = example(**_OUTPUT)

    output: str = Field(description="The output.")
    unit: str = Field(description="Its unit.")
    predicted: Number = Field(description="1 − ‖error‖/‖y − mean‖ of predictions from row to row; 1: perfect.")
    simulated: Number | None = Field(
        description="The same of the simulation from the first row on, without corrections; null: it diverges."
    )
    noise: Number = Field(description="Standard deviation of the measurement noise, in the output's unit.")
    memory: Number = Field(description="Correlation of the noise from one row to the next; 0: white.")
    innovation: Number = Field(description="Standard deviation of the innovations, in the output's unit.")
    bias: Number = Field(description="Mean of the innovations in standard errors; healthy: within ±4.")
    whiteness: Number = Field(description="Probability of the autocorrelation of the innovations if they were white.")
    text: Sentence = Field(description="The same in a sentence.")


class MisfitReason(Strict):
    """A test that the model failed."""

    model_config = example(**_REASON)

    kind: str = Field(
        description="bias, coloured, jump, driven, still, input-bounds, not-healthy, blind, unit, later or many."
    )
    name: str = Field(description="The output or input that it concerns; empty: the whole record.")
    t: Number | None = Field(description="Time in s after the first row at which it shows, or null.")
    text: Sentence = Field(description="The reason in a sentence.")


class MisfitSuspect(Strict):
    """Something that would explain a misfit."""

    model_config = example(**_SUSPECT)

    kind: SuspectKind = Field(description="What would have to be different.")
    name: str = Field(description="Of the output, input or parameter; `*`: all of them; two names for a swap.")
    factor: Number | None = Field(description="By which it would have to be multiplied; of an offset the addend.")
    gain: Number = Field(description="Fall of −2 log L with it.")
    simulated: Number | None = Field(description="Fit of the simulation with it; null: it was not simulated.")
    text: Sentence = Field(description="The suspicion in a sentence.")


class FittedParameterReport(Strict):
    """A parameter that was fitted on the healthy stretch."""

    model_config = example(**_PARAMETER)

    name: str
    unit: str
    before: Number = Field(description="Its value in the plant.")
    value: Number = Field(description="Its fitted value.")
    std: Number | None = Field(description="Standard deviation of the fitted value; null: unknown.")
    held: Flag = Field(description="Whether it was held, because the rows do not determine it.")


class FitReport(Strict):
    """Does the model fit the healthy stretch?"""

    model_config = example(**_FIT)

    verdict: Verdict = Field(description="Faults are only named if it fits, as it is or with fitted parameters.")
    text: Sentence = Field(description="The verdict in a sentence.")
    outputs: tuple[OutputFitReport, ...] = Field(description="How well each output fits.")
    before: tuple[OutputFitReport, ...] = Field(
        default=(), description="The same with the parameters as they were, if parameters were fitted."
    )
    reasons: tuple[MisfitReason, ...] = Field(description="Tests that the model failed.")
    suspects: tuple[MisfitSuspect, ...] = Field(description="What would explain a misfit, the likeliest first.")
    parameters: tuple[FittedParameterReport, ...] = Field(description="Fitted parameters.")
    process_noise: dict[Reference, Number] = Field(
        description="Standard deviation of the process noise of each state over one row, in its unit."
    )
    advice: tuple[Sentence, ...] = Field(description="What would help.")


class RecordFit(Strict):
    """The fit of a plant on the healthy stretch of a record, and the plant with the fitted parameters."""

    model_config = example(report=_FIT, plant="dts200")

    report: FitReport = Field(description="Does the model fit, as it is and with the fitted parameters?")
    plant: PlantChoice = Field(description="The complete plant with the fitted parameters.")


class FaultCandidate(Strict):
    """One explanation of a fault."""

    model_config = example(**_CANDIDATE)

    channel: str = Field(description="The fault channel.")
    title: Sentence = Field(description="Its title in the plant.")
    unit: str = Field(description="Its unit.")
    shape: Shape = Field(
        description="Its course; a drift is a step that goes on as a ramp, a plateau is a ramp that ends."
    )
    onset: Interval = Field(description="Time in s after the first row at which it began.")
    size: Interval = Field(description="Its size at its end, or at the end of the record.")
    rate: Number = Field(description="Its rate of change there, per second.")
    bound: Number | None = Field(description="The bound of the channel that the size has reached, or null.")
    behind: Number = Field(description="By how much −2 log L with penalties is worse than the best one's.")
    separable: Flag = Field(description="Whether the data exclude it, compared with the best; true for the best.")
    text: Sentence = Field(description="The explanation in a sentence.")


class RecordFault(Strict):
    """A fault that the record shows."""

    model_config = example(**_FAULT)

    id: str = Field(description="Id within the diagnosis.")
    best: FaultCandidate = Field(description="The best explanation.")
    alternatives: tuple[FaultCandidate, ...] = Field(description="Other channels, the better ones first.")
    alarm: Number = Field(description="Time in s after the first row at which it was noticed.")
    statistic: Number = Field(description="The statistic of that alarm.")
    ended: Number | None = Field(description="Time in s at which it ended; null: it lasts.")
    confirmed: Flag = Field(description="Whether the interval of its size excludes zero.")
    covered: Flag = Field(
        description="Whether the inputs at its onset are covered by the healthy stretch; else the model may err there."
    )
    text: Sentence = Field(description="The fault in a sentence.")
    note: MaybeSentence = Field(description="A reservation, or null.")


class MissingFault(Strict):
    """An additive fault that the plant lacks and that would explain the record better than its channels."""

    model_config = example(
        target="h1",
        fault="fault-1",
        gain=120.0,
        size=-12.0,
        unit="cm³/s",
        text=_text("record.missing.state", "an additive flow into h1 would explain it"),
    )

    target: str = Field(description="The state equation or output that it enters.")
    fault: str = Field(description="Id of the fault that it would explain.")
    gain: Number = Field(description="By how much it explains better.")
    size: Number = Field(description="Its size at the end.")
    unit: str = Field(description="Its unit.")
    text: Sentence = Field(description="The proposal in a sentence.")


class RecordDecision(Strict):
    """One alarm, and what became of it."""

    model_config = example(**_DECISION)

    t: Number = Field(description="Time in s after the first row of the alarm.")
    statistic: Number = Field(description="The statistic.")
    judged: Number = Field(description="Time in s up to which rows were used for the name.")
    action: Literal["added", "revised"] = Field(description="Whether a fault was added or the last one revised.")
    channel: str = Field(description="The channel that was named then.")
    onset: Number = Field(description="The onset that was estimated then.")


class VisibleFault(Strict):
    """The smallest fault of a channel that would have been found."""

    model_config = example(channel="pump", unit="", smallest=0.02, typical=0.1)

    channel: str
    unit: str
    smallest: Number | None = Field(description="Smallest step that would be found; null: none can be seen.")
    typical: Number = Field(description="Size of a typical fault.")


class StatisticCurve(Strict):
    """The statistic along the record, thinned for drawing: the largest value in each interval of time."""

    model_config = example(t=[0.0, 10.0], largest=[3.1, 428.0])

    t: tuple[Number, ...] = Field(description="Beginnings of the intervals in s after the first row.")
    largest: tuple[Number, ...]


class SimulatedOutputs(Strict):
    """The outputs of the plant, with fitted parameters if there are any, simulated without corrections, thinned."""

    model_config = example(t=[0.0, 10.0], outputs={"y": [20.0, 20.4]})

    t: tuple[Number, ...] = Field(description="Times of rows in s after the first row.")
    outputs: dict[Reference, tuple[Number | None, ...]] = Field(
        description="Values at these times, by output; null: the simulation has diverged."
    )


class Innovations(Strict):
    """The innovations of the filter without faults in their standard deviations, for drawing.

    The model may err where they leave ±2 for long.
    """

    model_config = example(t=[0.0, 10.0], low={"y": [-1.9, -2.1]}, high={"y": [2.2, 1.8]})

    t: tuple[Number, ...] = Field(description="Beginnings of intervals of time, in s after the first row.")
    low: dict[Reference, tuple[Number | None, ...]] = Field(
        description="Smallest in each interval, by output; null: it has no reading."
    )
    high: dict[Reference, tuple[Number | None, ...]] = Field(description="Largest in each interval, by output.")


class RecordDiagnosis(Strict):
    """The diagnosis of a record."""

    model_config = example(
        sentence=_text("record.summary.faults", "One fault: sensor offset since 300 s."),
        fit=_FIT,
        healthy=_HEALTHY,
        faults=[_FAULT],
        missing=[],
        visible=[{"channel": "pump", "unit": "", "smallest": 0.02, "typical": 0.1}],
        decisions=[_DECISION],
        threshold=26.7,
        false_alarms=0.01,
        promised_false_alarms=0.03,
        rows=600,
        duration=599.0,
        statistic={"t": [0.0], "largest": [3.1]},
        notes=[],
    )

    sentence: Sentence = Field(description="The result in a sentence.")
    fit: FitReport = Field(description="Does the model fit?")
    healthy: HealthyStretch = Field(description="The stretch on which this was checked.")
    faults: tuple[RecordFault, ...] = Field(
        description="The faults in the order of their onsets; empty if it does not fit."
    )
    missing: tuple[MissingFault, ...] = Field(description="Faults that the plant lacks and that would explain more.")
    visible: tuple[VisibleFault, ...] = Field(description="The smallest fault of each channel that would be found.")
    decisions: tuple[RecordDecision, ...] = Field(description="All alarms in the order of time.")
    threshold: Number | None = Field(description="Threshold of the statistic along this record; null: not needed.")
    false_alarms: Number = Field(description="Accepted false alarms per hour.")
    promised_false_alarms: Number | None = Field(
        default=None,
        description="False alarms per hour that can be promised with 95 % certainty: the noise was estimated from the "
        "rows of the healthy stretch; null: not needed.",
    )
    rows: int = Field(ge=0, description="Rows of the record.")
    duration: Number = Field(description="Length of the record in s.")
    statistic: StatisticCurve | None = Field(default=None, description="The statistic along the record, or null.")
    simulated: SimulatedOutputs | None = Field(
        default=None,
        description="The simulation from the healthy stretch's first row on, to compare with the readings.",
    )
    innovations: Innovations | None = Field(
        default=None, description="Innovations from the healthy stretch's first row on."
    )
    initial: dict[Reference, Number] = Field(
        default_factory=dict, description="The estimated state in the healthy stretch's first row."
    )
    between: Course = Field(default="held", description="Course of the inputs between two rows that fits best.")
    notes: tuple[Sentence, ...] = Field(default=(), description="Assumptions and limitations.")
