"""Encode a result as a short JSON head and one block of float64, and decode it bit-identically."""

import json
from typing import Any

import numpy as np

from thetascope.engine.model.result import Accuracy, Check, Diverged, ObserverReport, Result
from thetascope.messages import Message


def encode(result: Result) -> tuple[str, np.ndarray]:
    """Return the head and the numbers, an array of shape (columns, rows) that SQLite writes without a copy."""
    head = {
        "names": result.names,
        "observers": [_report_data(report) for report in result.observers],
        "diverged": result.diverged and _diverged_data(result.diverged),
        "step": result.step,
        "substeps": result.substeps,
        "notes": [note.as_data() for note in result.notes],
        "seconds": result.seconds,
        "costs": result.costs,
        "diagnosis": result.diagnosis,
        "record": result.record,
        "accuracy": result.accuracy and vars(result.accuracy),
    }
    return json.dumps(head, default=plain), np.ascontiguousarray(result.data, dtype="<f8")


def decode(head: str, data: bytes, rows: int) -> Result:
    """Return the result; its array is read-only and shares the memory of `data`."""
    values: dict[str, Any] = json.loads(head)
    names = tuple(values["names"])
    return Result(
        names=names,
        data=np.frombuffer(data, dtype="<f8").reshape(len(names), rows),
        observers=tuple(_observer(report) for report in values["observers"]),
        diverged=_diverged(values["diverged"]),
        step=values["step"],
        substeps=values["substeps"],
        notes=tuple(Message.from_data(note) for note in values["notes"]),
        seconds=values["seconds"],
        costs=values.get("costs", {}),
        diagnosis=values.get("diagnosis"),
        record=values.get("record"),
        accuracy=Accuracy(**values["accuracy"]) if values.get("accuracy") else None,
    )


def plain(value: object) -> Any:
    """Return an observer's facts as JSON data: arrays and NumPy numbers as lists and numbers, complex as [re, im]."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, complex):
        return [value.real, value.imag]
    if isinstance(value, set | frozenset | tuple):
        return list(value)
    return str(value)


def _report_data(report: ObserverReport) -> dict[str, Any]:
    checks = [{**vars(check), "name": check.name.as_data(), "text": check.text.as_data()} for check in report.checks]
    diverged = report.diverged and _diverged_data(report.diverged)
    return vars(report) | {"title": report.title.as_data(), "checks": checks, "diverged": diverged}


def _diverged_data(diverged: Diverged) -> dict[str, Any]:
    return {"time": diverged.time, "cause": diverged.cause.as_data()}


def _observer(values: dict[str, Any]) -> ObserverReport:
    checks = tuple(
        Check(**check | {"name": Message.from_data(check["name"]), "text": Message.from_data(check["text"])})
        for check in values.pop("checks")
    )
    title, diverged = Message.from_data(values.pop("title")), _diverged(values.pop("diverged"))
    return ObserverReport(title=title, checks=checks, diverged=diverged, **values)


def _diverged(values: dict[str, Any] | None) -> Diverged | None:
    return None if values is None else Diverged(values["time"], Message.from_data(values["cause"]))
