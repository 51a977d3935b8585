"""How regularly rows were taken: gaps and jitter."""

from dataclasses import dataclass

import numpy as np

from thetascope.messages import Message
from thetascope.records.defects.finding import Finding, Rows

_GAP = 1.9  # times the period
_JITTER = 0.01
_MOST_GAPS = 20


@dataclass(frozen=True)
class Sampling:
    """Median, shortest and longest time in s from row to row; the usual deviation as a share of the median."""

    period: float
    shortest: float
    longest: float
    jitter: float


def sampling_of(t: np.ndarray) -> Sampling:
    """Return how regularly rows were taken."""
    steps = np.diff(t)
    period = float(np.median(steps))
    usual = steps[steps < _GAP * period]
    jitter = float(np.std(usual) / period) if len(usual) else 0.0
    return Sampling(period, float(steps.min()), float(steps.max()), jitter)


def sampling_findings(rows: Rows, sampling: Sampling, column: str | None) -> list[Finding]:
    """Return gaps, one finding each or one for all if there are many, and jitter."""
    steps = np.diff(rows.t)
    gaps = np.flatnonzero(steps > _GAP * sampling.period)
    regular = len(gaps) <= 0.2 * len(steps)
    findings = []
    if len(gaps) > _MOST_GAPS and regular:
        text = Message("record.finding.gaps", n=len(gaps), longest=float(steps[gaps].max()))
        findings.append(Finding("gap", "note", text, Message("record.treatment.gap"), None, column, **rows.marks(gaps)))
    elif regular:
        for k in gaps:
            text = Message(
                "record.finding.gap", length=float(steps[k]), t=float(rows.t[k]), n=_missed(steps[k], sampling)
            )
            marks = rows.marks(np.array([k]))
            end = float(rows.t[k + 1])
            findings.append(
                Finding("gap", "note", text, Message("record.treatment.gap"), None, column, until=end, **marks)
            )
    if sampling.jitter > _JITTER or not regular:
        low, high = (float(q) for q in np.quantile(steps, (0.02, 0.98)))
        text = Message("record.finding.jitter", low=low, high=high, share=sampling.jitter)
        treatment = Message("record.treatment.jitter")
        findings.append(Finding("jitter", "note", text, treatment, None, column, count=len(steps)))
    return findings


def _missed(step: float, sampling: Sampling) -> int:
    return max(1, round(float(step) / sampling.period) - 1)
