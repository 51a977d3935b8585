"""Values and times that do not suit the plant: bounds, domains, units, time constants, inputs that never move."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from thetascope.messages import Message
from thetascope.records.columns.mapping import Taken
from thetascope.records.columns.times import TimeChoice
from thetascope.records.columns.units import choices, conversion
from thetascope.records.defects.finding import Finding, Rows
from thetascope.records.defects.sampling import Sampling

_BEYOND = 0.005  # of the width of bounds by which values may exceed them
_RATIO, _CLOSE = 0.4, 0.12  # decades by which a value misses the plant's usual one; and by which it fits
_FIRST = 10  # rows that are compared with the plant's initial values
_SHORT, _SLOW = 0.2, 2.0  # of the slowest time constant, for the length of a record and for its period
_LONG = 1e5
_TIME_UNITS = (("ms", 1e-3), ("us", 1e-6), ("min", 60.0), ("h", 3600.0), ("s", 1.0), ("d", 86_400.0))


@dataclass(frozen=True)
class PlantFacts:
    """What is known of a plant before a record.

    Attributes:
        outputs: by name, at the initial state.
        slowest: its slowest time constant in s, or None.
        signals: by name, the function of t that a known signal is where the record does not have it.
    """

    outputs: Mapping[str, float] = field(default_factory=dict)
    slowest: float | None = None
    signals: Mapping[str, Callable[[np.ndarray], np.ndarray]] = field(default_factory=dict)


def outside(taken: Taken, values: np.ndarray, rows: Rows) -> list[Finding]:
    """Return a finding if values are outside the bounds of an input, or the domain of an output's state."""
    low, high = (np.inf * sign if b is None else b for sign, b in zip((-1, 1), taken.quantity.bounds, strict=True))
    width = high - low if np.isfinite(high - low) else max(abs(v) for v in (low, high, 0.0) if np.isfinite(v))
    with np.errstate(invalid="ignore"):
        places = np.flatnonzero((values < low - _BEYOND * width) | (values > high + _BEYOND * width))
    if not len(places):
        return []
    code = "outside-domain" if taken.quantity.role == "output" else "out-of-bounds"
    args = {
        "name": taken.quantity.name,
        "share": len(places) / max(1, int((~np.isnan(values)).sum())),
        "low": None if np.isinf(low) else low,
        "high": None if np.isinf(high) else high,
        "unit": taken.quantity.unit,
    }
    proposal = unit_proposal(taken, values, None)
    return [
        Finding(
            code,
            "doubtful",
            Message(f"record.finding.{code}", **_shown(args)),
            Message(f"record.treatment.{code}") if proposal is None else _try(proposal),
            taken.quantity.name,
            taken.column,
            proposal=None if proposal is None else _as_mapping(taken, proposal),
            **rows.marks(places),
        )
    ]


def _shown(args: dict) -> dict:
    ends = {"low": "−∞", "high": "∞"}
    return {name: ends[name] if value is None and name in ends else value for name, value in args.items()}


def _try(unit: str) -> Message:
    return Message("record.treatment.other-unit", unit=unit)


def _as_mapping(taken: Taken, unit: str) -> dict:
    return {"quantities": {taken.quantity.name: {"column": taken.column, "unit": unit}}}


def foreign_unit(taken: Taken) -> list[Finding]:
    """Return a finding if the file writes a unit that cannot be converted to the plant's."""
    if not taken.foreign:
        return []
    own = taken.quantity.unit
    text = Message("record.finding.unit-kind", name=taken.quantity.name, unit=taken.foreign, target=own)
    treatment = Message("record.treatment.unit-kind", target=own)
    return [Finding("unit", "doubtful", text, treatment, taken.quantity.name, taken.column)]


def doubtful_unit(taken: Taken, values: np.ndarray, expected: float | None) -> list[Finding]:
    """Return a finding if no unit is written, and another one suits the plant's usual value much better."""
    if taken.written or expected is None:
        return []
    unit = unit_proposal(taken, values, expected)
    if unit is None:
        return []
    begin = _typical(values, taken)
    text = Message(
        "record.finding.unit",
        name=taken.quantity.name,
        value=begin,
        expected=expected,
        unit=taken.quantity.unit,
        other=unit,
    )
    proposal = _as_mapping(taken, unit)
    return [
        Finding("unit", "doubtful", text, _try(unit), taken.quantity.name, taken.column, len(values), proposal=proposal)
    ]


def _typical(values: np.ndarray, taken: Taken) -> float:
    good = values[~np.isnan(values)]
    return float(np.median(good[:_FIRST] if taken.quantity.role == "output" else good)) if len(good) else np.nan


def unit_proposal(taken: Taken, values: np.ndarray, expected: float | None) -> str | None:
    """Return another unit in which the cells of a column suit the plant, or None.

    With `expected` the typical value must come close to it; without, all values must come within the bounds.
    """
    if taken.factor == 0:
        return None
    cells = (values - taken.offset) / taken.factor
    low, high = (np.inf * sign if b is None else b for sign, b in zip((-1, 1), taken.quantity.bounds, strict=True))
    miss = _decades(_typical(values, taken), expected) if expected is not None else np.inf
    if miss is None or expected is not None and miss < _RATIO:
        return None
    best: tuple[float, str] | None = None
    for unit in choices(taken.quantity.unit)[1:]:
        pair = conversion(unit, taken.quantity.unit)
        if unit == taken.unit or pair is None or pair == (taken.factor, taken.offset):
            continue
        other = cells * pair[0] + pair[1]
        good = other[~np.isnan(other)]
        if not len(good) or ((good < low) | (good > high)).mean() > 0.01:
            continue
        if expected is None:
            if np.isfinite(high - low) and np.ptp(good) > 1e-3 * (high - low):
                return unit
            continue
        miss = _decades(_typical(other, taken), expected)
        if miss is not None and miss < _CLOSE and (best is None or miss < best[0]):
            best = (miss, unit)
    return None if best is None else best[1]


def _decades(value: float, expected: float) -> float | None:
    """Return by how many decades a value misses another one, or None where that says nothing."""
    if not (value > 0 and expected > 0) and not (value < 0 and expected < 0):
        return None
    return abs(float(np.log10(abs(value)) - np.log10(abs(expected))))


def motionless(taken: Taken, values: np.ndarray, rows: Rows) -> list[Finding]:
    """Return a finding if a quantity never changes."""
    good = values[~np.isnan(values)]
    if len(good) < 2 or good.min() != good.max():
        return []
    role = "output" if taken.quantity.role == "output" else "input"
    code = f"never-moves-{role}"
    text = Message(f"record.finding.{code}", name=taken.quantity.name, value=float(good[0]), unit=taken.quantity.unit)
    severity = "doubtful" if role == "output" else "note"
    treatment = Message(f"record.treatment.{code}")
    return [Finding("never-moves", severity, text, treatment, taken.quantity.name, taken.column, len(good))]


def pace(
    facts: PlantFacts, time: TimeChoice, t: np.ndarray, sampling: Sampling
) -> tuple[list[Finding], Message | None]:
    """Return a finding if times do not suit the plant's slowest time constant, and the comparison in a sentence."""
    tau = facts.slowest
    if tau is None or not 0 < tau < np.inf or len(t) < 2:
        return [], None
    length = float(t[-1] - t[0])
    about = Message("record.plant.pace", tau=tau, times=length / tau, period=sampling.period)
    if _suits(length, sampling.period, tau):
        return [], about
    proposal = None
    if not time.written and time.column is not None:
        for unit, factor in _TIME_UNITS:
            if factor != 1.0 and _suits(length * factor, sampling.period * factor, tau):
                proposal = unit
                break
    code = "short" if length < _SHORT * tau else "slow" if sampling.period > _SLOW * tau else "long"
    text = Message(f"record.finding.pace-{code}", length=length, period=sampling.period, tau=tau)
    treatment = (
        Message("record.treatment.pace") if proposal is None else Message("record.treatment.time-unit", unit=proposal)
    )
    mapping = None if proposal is None else {"time": {"column": time.column, "unit": proposal}}
    return [Finding("time-unit", "doubtful", text, treatment, None, time.column, len(t), proposal=mapping)], about


def _suits(length: float, period: float, tau: float) -> bool:
    return length >= _SHORT * tau and period <= _SLOW * tau and length <= _LONG * tau
