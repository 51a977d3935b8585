"""Answers about runs: a run, its progress and summary; and problems (RFC 9457)."""

from datetime import datetime
from typing import Literal

from pydantic import Field, JsonValue

from thetascope_schemas.experiment.base import Number, Strict, Text, example
from thetascope_schemas.experiment.diagnosis import Diagnosis, MaybeSentence
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.service.comparison import Comparison
from thetascope_schemas.service.facts import Facts
from thetascope_schemas.service.field_error import FieldError
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis

Status = Literal["queued", "running", "done", "failed", "cancelled"]

_PROBLEM = {
    "type": "about:blank",
    "title": "The request was refused",
    "status": 422,
    "code": "refusal.spec",
    "args": {},
    "detail": "faults[0].end: the end 5 s is not after the onset 20 s; give an end above 20, or null",
    "instance": None,
    "errors": [
        {
            "field": "faults[0].end",
            "value": 5,
            "code": "fault.end.before-onset",
            "args": {"end": 5, "onset": 20},
            "problem": "the end 5 s is not after the onset 20 s",
            "remedy": "give an end above 20, or null",
        }
    ],
}
_CHECK = {
    "name": {"code": "check.excitation", "args": {}, "text": "persistent excitation"},
    "verdict": "holds",
    "text": {"code": "check.definite.smallest", "args": {"value": 0.0026}, "text": "smallest eigenvalue: 0.0026"},
    "value": 0.0026,
    "threshold": 0.001,
    "source": "Zhao, Li, Li 2012, eq. (36)",
    "gains": None,
}
_OBSERVER = {
    "label": "adaptive",
    "kind": "zhao-adaptive",
    "title": {"code": "observer.zhao-adaptive.title", "args": {}, "text": "Adaptive observer (Zhao, Li, Li)"},
    "diverged": None,
    "rmse": {"x1": 3.1e-8, "x2": 4.4e-8},
    "checks": [_CHECK],
    "facts": {},
}
_SUMMARY = {
    "columns": 24,
    "rows": 10001,
    "step": 0.001,
    "substeps": 1,
    "diverged": None,
    "observers": [_OBSERVER],
    "notes": [],
    "seconds": {"run": 0.03},
}


class Problem(Strict):
    """A refusal or failure as application/problem+json (RFC 9457), with its sentences in the requested language."""

    model_config = example(**_PROBLEM)

    type: str = Field(default="about:blank", description="URI reference of the problem type.")
    title: str = Field(description="Short text, the same for every problem of this type.")
    status: int = Field(ge=400, le=599, description="HTTP status.")
    detail: str = Field(default="", description="The problem of this request, and its remedy.")
    code: str = Field(
        default="", description="Key of the problem's sentence in the catalogues, GET /api/messages/{language}."
    )
    args: dict[str, JsonValue] = Field(default_factory=dict, description="Arguments of the sentence by name.")
    instance: str | None = Field(default=None, description="URI reference of this occurrence.")
    errors: tuple[FieldError, ...] = Field(
        default=(), description="For each offending field, its value, the problem and the remedy."
    )


class Divergence(Strict):
    """The divergence of a plant or an observer: its time and likely cause."""

    model_config = example(
        time=2.515,
        cause={"code": "diverged.plant", "args": {}, "text": "the plant's own state escapes to infinity"},
    )

    time: Number = Field(description="Time in s from which the values are missing.")
    cause: Text = Field(description="The likely cause.")


class AssumptionCheck(Strict):
    """The check of one assumption of an observer's theorem for the plant, the gains and the run."""

    model_config = example(**_CHECK)

    name: Text
    verdict: Literal["holds", "fails", "cannot tell"]
    text: Text = Field(description="The check's result in a sentence.")
    value: Number | None = Field(default=None, description="The computed value.")
    threshold: Number | None = Field(default=None, description="The value that it is compared with.")
    source: str = Field(default="", description="Paper and equation.")
    gains: dict[str, tuple[Number, ...]] | None = Field(
        default=None, description="Other gains, designed so that they meet this check; null where there are none."
    )


class FinalValue(Strict):
    """An estimate over the last tenth of the run, in the channel's unit."""

    model_config = example(truth=0.02, estimate=0.0201, error=0.0001, mean_error=0.00002, std=0.0003)

    truth: Number | None = Field(description="The true value at the end.")
    estimate: Number | None = Field(description="The estimate at the end.")
    error: Number | None = Field(description="Estimate minus truth at the end.")
    mean_error: Number | None = Field(description="Mean of estimate minus truth.")
    std: Number | None = Field(description="Standard deviation of estimate minus truth.")


class Settling(Strict):
    """The settling of an estimate after one step of a fault."""

    model_config = example(channel="theta3", at=20, size=0.02, within=0.1, reached=0.7, time=0.75, until=40)

    channel: str
    at: Number = Field(description="Time of the step in s.")
    size: Number = Field(description="Size of the step.")
    within: Number = Field(description="Half-width of the band around the new value, as a fraction of the size.")
    reached: Number | None = Field(description="Time in s after the step at which the band is first reached.")
    time: Number | None = Field(description="Time in s after the step from which the estimate stays in the band.")
    until: Number = Field(description="Time in s at which the evaluation ends: the next event, or the end of the run.")


class ObserverSummary(Strict):
    """The results of one observer."""

    model_config = example(**_OBSERVER)

    label: str
    kind: str
    title: MaybeSentence = Field(default=None, description="The name of the kind.")
    diverged: Divergence | None = None
    rmse: dict[str, Number | None] = Field(
        default_factory=dict, description="Root mean square error of each state over the run; null if undefined."
    )
    rmse_end: dict[str, Number | None] = Field(
        default_factory=dict, description="The same over the last tenth of the run."
    )
    theta: dict[str, FinalValue] = Field(default_factory=dict, description="Estimate of each channel at the end.")
    settling: tuple[Settling, ...] = Field(default=(), description="Settling after each step of a fault.")
    checks: tuple[AssumptionCheck, ...] = ()
    facts: dict[str, JsonValue] = Field(
        default_factory=dict, description="Facts determined during the observer's construction."
    )


class Accuracy(Strict):
    """The accuracy that the integration reached: estimated errors relative to the scale of each state."""

    model_config = example(plant=3.2e-10, observers=4.5e-8, tolerance=1e-6, observer_tolerance=1e-4, implicit=0)

    plant: Number = Field(ge=0, description="Largest error of a plant state, propagated along the run; 1: unknown.")
    observers: Number = Field(ge=0, description="Largest error of an observer's estimate, over about 100 steps.")
    tolerance: Number = Field(gt=0, description="Error of the plant that the steps were chosen for.")
    observer_tolerance: Number = Field(gt=0, description="The same for observers.")
    implicit: int = Field(default=0, ge=0, description="Most implicit substeps of a step; 0: none were needed.")


class RunSummary(Strict):
    """The results of a run without its data."""

    model_config = example(**_SUMMARY)

    columns: int = Field(ge=0, description="Number of columns of the data.")
    rows: int = Field(ge=0, description="Number of recorded times.")
    step: Number = Field(description="Step of the integration in s.")
    substeps: int = Field(default=1, ge=1, description="Substeps of each integration step.")
    accuracy: Accuracy | None = Field(
        default=None, description="Accuracy of the integration; null for fixed substeps and in discrete time."
    )
    diverged: Divergence | None = Field(default=None, description="Divergence of the plant itself.")
    observers: tuple[ObserverSummary, ...] = ()
    facts: Facts | None = Field(
        default=None, description="Observers, faults, noise, alarms and verdicts at the end of the run."
    )
    comparison: Comparison | None = Field(default=None, description="The observers compared on the same data.")
    diagnosis: Diagnosis | None = Field(
        default=None, description="The diagnosis: which fault, since when, its size and confidence."
    )
    record: RecordDiagnosis | None = Field(
        default=None, description="The diagnosis of the record that takes the place of the simulated plant."
    )
    notes: tuple[Text, ...] = ()
    seconds: dict[str, Number] = Field(default_factory=dict, description="Wall time of each stage in s.")


class Progress(Strict):
    """The progress of a run."""

    model_config = example(
        id="5f0c1a9e77b24d3c8a6f01234567890b",
        status="running",
        progress=0.4,
        detail="",
        problem=None,
        links={"self": "/api/runs/5f0c1a9e77b24d3c8a6f01234567890b"},
    )

    id: str = Field(description="The run's id.")
    status: Status
    progress: Number = Field(ge=0, le=1, description="Completed share, 0 to 1.")
    detail: str = ""
    problem: Problem | None = Field(default=None, description="The reason of a failure.")
    links: dict[str, str] = Field(default_factory=dict)


class Run(Strict):
    """A run of an experiment. Its id is the hash of everything that determines its numbers (`Experiment.spec_hash`)."""

    model_config = example(
        id="5f0c1a9e77b24d3c8a6f01234567890b",
        status="done",
        progress=1,
        spec={"plant": "zhao-contois", "horizon": 100, "step": 0.001},
        summary=_SUMMARY,
        problem=None,
        created="2025-01-01T12:00:00Z",
        pinned=False,
        links={"data": "/api/runs/5f0c1a9e77b24d3c8a6f01234567890b/data"},
    )

    id: str = Field(description="Hash of the canonical spec.")
    status: Status
    progress: Number = Field(ge=0, le=1, description="Completed share, 0 to 1.")
    spec: Experiment
    summary: RunSummary | None = Field(default=None, description="Set when the run is done.")
    problem: Problem | None = Field(default=None, description="Set when the run has failed.")
    created: datetime
    pinned: bool = Field(default=False, description="Whether the run is kept when the store is full.")
    warning: str | None = Field(default=None, description="Why the run could not be stored: it is in memory only.")
    links: dict[str, str] = Field(default_factory=dict)
