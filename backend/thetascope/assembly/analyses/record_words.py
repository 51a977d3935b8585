"""Sentences about the diagnosis of a record, as messages."""

import numpy as np

from thetascope.diagnosis.records.diagnose import RecordAnswer
from thetascope.diagnosis.records.findings import Candidate, Estimate
from thetascope.diagnosis.records.fit_check import Finding, OutputFit, Suspect
from thetascope.diagnosis.records.parameter_fit import SuspectedParameter
from thetascope.diagnosis.sentences import joined
from thetascope.messages import Message


def output_sentence(name: str, fit: OutputFit) -> Message:
    """Return how well an output fits."""
    simulated = max(fit.simulated, -9.99) if np.isfinite(fit.simulated) else -9.99
    return Message("record.fit.output", output=name, predicted=100 * fit.predicted, simulated=100 * simulated)


def reason_sentence(finding: Finding, t: float | None) -> Message:
    """Return why the model does not fit."""
    values = {"name": finding.name, "value": finding.value, "share": 100 * finding.value, "t": t}
    code = finding.kind
    if code == "unit" and not finding.name:
        code = "time-unit"
    elif code == "unit" and "," in finding.name:
        code = "swapped"
    elif code == "unit" and finding.name == "*":
        code = "all-units"
    return Message(f"record.misfit.{code}", **{k: v for k, v in values.items() if k in _USED[code]})


_USED = {
    "bias": ("name", "value"),
    "coloured": ("name", "value"),
    "jump": ("name", "value", "t"),
    "driven": ("name",),
    "still": ("name",),
    "input-bounds": ("name", "share", "t"),
    "not-healthy": ("t",),
    "blind": (),
    "unit": ("name",),
    "time-unit": (),
    "swapped": ("name",),
    "all-units": (),
    "later": ("name",),
    "many": ("value",),
}


def suspect_sentence(suspect: Suspect | SuspectedParameter) -> Message:
    """Return what would explain a misfit."""
    if isinstance(suspect, SuspectedParameter):
        return Message("record.suspect.parameter", name=suspect.name, factor=suspect.factor, gain=suspect.gain)
    code = suspect.kind
    if code == "time":
        code = {60.0: "minutes", 3600.0: "hours", 1e-3: "milliseconds"}.get(suspect.factor, "time")
    if code in ("output", "offset", "fahrenheit", "input") and suspect.name == "*":
        code += "-all"
    named = (
        {} if code in ("minutes", "hours", "milliseconds", "time") or code.endswith("-all") else {"name": suspect.name}
    )
    scaled = code.startswith(("output", "offset", "input", "time"))
    return Message(
        f"record.suspect.{code}", **named, **({"factor": suspect.factor} if scaled else {}), gain=suspect.gain
    )


def advice(answer: RecordAnswer) -> list[Message]:
    """Return what would help where the model does not fit."""
    kinds = {f.kind for f in answer.check.findings}
    help_ = []
    if answer.check.suspects:
        help_.append(Message("record.advice.unit"))
    if "input-bounds" in kinds:
        return [*help_, Message("record.advice.input")]
    if kinds & {"not-healthy", "jump"}:
        help_.append(Message("record.advice.stretch"))
    if kinds & {"bias", "coloured", "driven", "later", "many"} and not answer.check.suspects:
        help_.append(Message("record.advice.fit" if answer.parameters is None else "record.advice.equations"))
    if "blind" in kinds:
        help_.append(Message("record.advice.blind"))
    return help_


def verdict_sentence(answer: RecordAnswer, reasons: list[Message]) -> Message:
    """Return the verdict."""
    t0 = answer.rows.t
    begin, end = answer.healthy
    span = {"begin": float(t0[0]) if begin == 0 else 0.0, "end": float(t0[min(end - begin, len(t0)) - 1])}
    if not answer.fits:
        return Message("record.verdict.misfit", reasons=joined(reasons))
    if answer.parameters is not None:
        fitted = [
            Message("record.verdict.parameter", name=p.name, before=p.before, value=p.value)
            for p in answer.parameters.parameters
            if not p.held
        ]
        return Message("record.verdict.fitted", parameters=fitted, **span)
    return Message("record.verdict.fits", **span)


_MOVING = 0.01  # of a fault: what its rate adds since its onset, if it is to be mentioned


def amount(estimate: Estimate, unit: str) -> Message:
    """Return a size with its half interval and unit."""
    half = (estimate.high - estimate.low) / 2
    if not unit:
        return Message("record.amount-plain", value=estimate.value, half=half)
    return Message("record.amount", value=estimate.value, half=half, unit=unit)


def since(onset: Estimate) -> Message:
    """Return since when a fault acts, with the interval where it is wide."""
    if onset.high - onset.low > 0.02 * max(abs(onset.value), 1e-12):
        return Message("diagnosis.since.between", onset=onset.value, earliest=onset.low, latest=onset.high)
    return Message("diagnosis.since.time", onset=onset.value)


def candidate_sentence(candidate: Candidate, title: str | Message, unit: str, ended: float | None, t: float) -> Message:
    """Return a fault in a sentence, as it is at time t, the end of the record."""
    when = since(candidate.onset)
    if ended is not None:
        when = Message("diagnosis.since.over", since=when, end=ended)
    if candidate.bound is not None:
        return Message("record.fault.bound", title=title, bound=candidate.bound, unit=unit, when=when)
    size = amount(candidate.size, unit)
    moving = abs(candidate.rate) * max(t - candidate.onset.value, 0.0) > _MOVING * abs(candidate.size.value)
    if moving and ended is None:
        return Message("record.fault.moving", title=title, size=size, rate=candidate.rate, unit=unit, when=when)
    return Message("record.fault.step", title=title, size=size, when=when)
