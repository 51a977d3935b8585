"""Records of rigs in closed loops, noisy, quantised, with gaps: the right fault, or why the model does not fit."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tests.diagnosis.records.rigs import TANK, heaters, since, tank, three_tanks
from thetascope.assembly.analyses.record_diagnosis import diagnose_recording, fitted_plant
from thetascope.diagnosis.recording import Recording
from thetascope_schemas import Plant
from thetascope_schemas.experiment.measurement import RecordSettings, Stretch
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis


def diagnosed(plant: Plant, recording: Recording, healthy: float | None = None, fit: str = "auto") -> RecordDiagnosis:
    """Return the diagnosis."""
    stretch = None if healthy is None else Stretch(begin=0.0, end=healthy)
    return diagnose_recording(plant, recording, RecordSettings.model_validate({"healthy": stretch, "fit": fit}))


def named(diagnosis: RecordDiagnosis) -> list[str]:
    """Return the channels of the confirmed faults."""
    return [f.best.channel for f in diagnosis.faults if f.confirmed]


def check(diagnosis: RecordDiagnosis, channel: str, onset: float, size: float) -> None:
    """Assert that one fault is named with the true onset and size within its intervals, widened by a half."""
    assert named(diagnosis) == [channel], diagnosis.sentence.text
    best = diagnosis.faults[0].best
    for interval, true in ((best.onset, onset), (best.size, size)):
        slack = 0.5 * (interval.high - interval.low)
        assert interval.low - slack <= true <= interval.high + slack, (true, interval)


# ---- forms of one record ---------------------------------------------------------------------------------------------


def jitter(r: Recording) -> Recording:
    return replace(r, t=r.t + np.random.default_rng(5).uniform(-0.2, 0.2, len(r.t)))


def gap(r: Recording) -> Recording:
    kept = np.r_[0:100, 140 : len(r.t)]
    return Recording(r.t[kept], r.u[kept], r.y[kept], r.held[kept], r.resolution, r.line[kept])


def cells(r: Recording) -> Recording:
    y = r.y.copy()
    y[100:120] = np.nan
    y[::17] = np.nan
    return replace(r, y=y)


def quantised(r: Recording) -> Recording:
    return replace(r, y=np.round(r.y / 0.32) * 0.32, resolution=np.array([0.32]))


def coloured(r: Recording) -> Recording:
    rng, e, y = np.random.default_rng(2), 0.0, r.y.copy()
    for k in range(len(y)):
        e = 0.6 * e + 0.05 * rng.standard_normal()
        y[k] += e
    return replace(r, y=y)


def late_inputs(r: Recording) -> Recording:
    return replace(r, u=np.concatenate([r.u[:1], r.u[:-1]]))


@pytest.mark.parametrize("form", [lambda r: r, jitter, gap, cells, quantised, coloured, late_inputs])
def test_a_sensor_offset_is_found_in_every_form_of_a_record(form: Callable[[Recording], Recording]) -> None:
    """Jitter, a gap, missing cells, coarse readings, coloured noise, and inputs that are written before they change,
    change the interval, not the finding."""
    check(diagnosed(TANK, form(tank({"offset": since(300, 1.0)}))), "offset", 300.0, 1.0)


def test_a_healthy_record_shows_nothing() -> None:
    """No fault in records without one; what would have been found is listed."""
    for recording in (tank(), coloured(tank(seed=1))):
        diagnosis = diagnosed(TANK, recording)
        assert diagnosis.fit.verdict == "fits" and not diagnosis.faults
        assert all(v.smallest is not None and v.smallest < v.typical for v in diagnosis.visible)


@pytest.mark.parametrize("step", [0.1, 0.32, 0.5])
def test_coarse_sensors_are_neither_stuck_nor_faulty(step: float) -> None:
    """A healthy sensor that repeats numbers for many rows shows no fault."""
    recording = tank(noise=0.02)
    coarse = replace(recording, y=np.round(recording.y / step) * step, resolution=np.array([step]))
    changes = np.flatnonzero(np.diff(coarse.y[:, 0]))
    assert step < 0.3 or np.diff(changes).max() >= 5
    diagnosis = diagnosed(TANK, coarse)
    assert diagnosis.fit.verdict == "fits" and not diagnosis.faults, diagnosis.sentence.text


# ---- the model does not fit ------------------------------------------------------------------------------------------


def _seconds(recording: Recording, factor: float) -> Recording:
    return replace(recording, t=recording.t * factor)


def _inputs(recording: Recording, u: np.ndarray | float) -> Recording:
    return replace(recording, u=np.zeros_like(recording.u) + u)


def _readings(recording: Recording, y: np.ndarray) -> Recording:
    return replace(recording, y=y)


@pytest.mark.parametrize(
    ("change", "reason", "suspect"),
    [
        (lambda r: _seconds(r, 1 / 60), "unit", ("time", "", 60.0)),
        (lambda r: _seconds(r, 1000.0), "unit", ("time", "", 1e-3)),
        (lambda r: _readings(r, r.y / 100), "unit", ("output", "y", 100.0)),
        (lambda r: _inputs(r, r.u / 1000), "unit", ("input", "q", 1000.0)),
        (lambda r: _inputs(r, 500.0), "input-bounds", None),
        (lambda r: _inputs(r, -9999.0), "input-bounds", None),
        (lambda r: _inputs(r, 50.0), "still", None),
    ],
)
def test_a_wrong_unit_or_input_ends_before_any_name(change: Callable, reason: str, suspect: tuple | None) -> None:
    """Minutes for seconds, metres for centimetres, an input that is missing or nonsense: no fault is named, the reason
    is, and the unit that would fit."""
    diagnosis = diagnosed(TANK, change(tank({"offset": since(300, 1.0)})), fit="never" if suspect else "auto")
    assert diagnosis.fit.verdict == "does-not-fit" and not diagnosis.faults
    assert reason in [r.kind for r in diagnosis.fit.reasons] and diagnosis.fit.advice
    if suspect is not None:
        first = diagnosis.fit.suspects[0]
        assert (first.kind, first.name, first.factor) == (suspect[0], suspect[1], pytest.approx(suspect[2]))


def test_exchanged_columns_and_kelvin_for_celsius_are_recognised() -> None:
    """Two heaters whose inputs are exchanged, or whose readings are in K or °F: the reason is named."""
    plant, recording = heaters(loss=since(400, 0.3))
    for change, kind in (
        (_inputs(recording, recording.u[:, ::-1]), "swap-inputs"),
        (_readings(recording, recording.y + 273.15), "offset"),
        (_readings(recording, recording.y * 9 / 5 + 32), "fahrenheit"),
    ):
        diagnosis = diagnosed(plant, change, fit="never")
        assert diagnosis.fit.verdict == "does-not-fit" and not diagnosis.faults
        assert diagnosis.fit.suspects[0].kind == kind


def test_a_fault_in_the_declared_stretch_is_not_taken_for_noise() -> None:
    """A stretch that is declared healthy and is not is said to deviate, with the time."""
    diagnosis = diagnosed(TANK, tank({"offset": since(150, 1.0)}), healthy=300)
    assert diagnosis.fit.verdict == "does-not-fit"
    (reason,) = [r for r in diagnosis.fit.reasons if r.kind == "not-healthy"]
    assert reason.t is not None and 150 <= reason.t <= 300


# ---- rigs ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("fault", "size"), [("pump1", 0.2), ("leak1", 0.05), ("leak3", 0.04), ("level1", 1.0), ("level2", -1.0)]
)
def test_faults_behind_a_loop_are_told_apart(fault: str, size: float) -> None:
    """In three tanks under PI control, with coloured and process noise, each fault is named with onset and size."""
    plant, recording = three_tanks({fault: since(700, size)})
    check(diagnosed(plant, recording, healthy=600), fault, 700.0, size)


def test_later_faults_are_added_and_ends_are_seen() -> None:
    """A leak that is mended and a sensor bias after it are two faults; the first one has ended."""
    plant, recording = three_tanks({"leak1": since(500, 0.05, 800), "level3": since(1000, 1.0)})
    diagnosis = diagnosed(plant, recording, healthy=450)
    assert named(diagnosis) == ["leak1", "level3"]
    first, second = diagnosis.faults
    assert first.ended == pytest.approx(800, abs=5) and second.ended is None
    assert second.best.size.value == pytest.approx(1.0, abs=0.05)


def test_faults_far_apart_keep_their_own_numbers() -> None:
    """In a long record a fault beyond the rows that are refined together has its own size, onset and interval."""
    recording = tank({"leak": since(1000, 0.03), "offset": since(14_500, 1.0)}, rows=15_000)
    diagnosis = diagnosed(TANK, recording, healthy=900, fit="never")
    assert named(diagnosis) == ["leak", "offset"]
    for fault, onset, size in zip(diagnosis.faults, (1000.0, 14_500.0), (0.03, 1.0), strict=True):
        assert fault.best.onset.low - 1 <= onset <= fault.best.onset.high + 1
        assert fault.best.size.value == pytest.approx(size, rel=0.05)
        assert 0 < fault.best.size.high - fault.best.size.low < 0.2 * size


def test_a_fault_that_the_plant_lacks_is_proposed() -> None:
    """A flow out of tank 1 is named; without a channel for it, an additive fault of its equation is reported."""
    plant, recording = three_tanks({"flow1": since(700, -8.0)}, rows=2200)
    check(diagnosed(plant, recording, healthy=600), "flow1", 700.0, -8.0)
    data = plant.model_dump()
    data["channels"] = [channel for channel in data["channels"] if not channel["name"].startswith("flow")]
    diagnosis = diagnosed(Plant.model_validate(data), recording, healthy=600)
    assert [m.target for m in diagnosis.missing] == ["h1"]
    assert diagnosis.missing[0].size == pytest.approx(-8.0 / 154, rel=0.05)


def test_units_do_not_matter() -> None:
    """The same heaters in °C and in K give the same numbers."""
    found = [diagnosed(*heaters(kelvin, since(450, 0.3))) for kelvin in (False, True)]
    check(found[0], "heater1", 450.0, 0.3)
    for one, other in zip(found[0].faults, found[1].faults, strict=True):
        for name in ("onset", "size"):
            a, b = getattr(one.best, name), getattr(other.best, name)
            assert [a.value, a.low, a.high] == pytest.approx([b.value, b.low, b.high], rel=1e-4)


def test_a_wrong_parameter_is_fitted_before_faults_are_judged() -> None:
    """A heat loss that is 5 % off is found on the healthy stretch; then the fault has its right size."""
    plant, recording = heaters(loss=since(450, 0.3))
    data = plant.model_dump()
    data["parameters"][0]["value"] *= 1.05
    wrong = Plant.model_validate(data)
    diagnosis = diagnosed(wrong, recording)
    assert diagnosis.fit.verdict == "fits-after-fit"
    check(diagnosis, "heater1", 450.0, 0.3)
    report, fitted = fitted_plant(wrong, recording, RecordSettings(healthy=Stretch(begin=0, end=400), fit="chosen"))
    (loss,) = [p for p in report["parameters"] if p["name"] == "UA"]
    assert loss["before"] == pytest.approx(0.0105) and abs(loss["value"] - 0.01) < 3 * loss["std"] < 0.0005
    assert fitted.parameters[0].value == loss["value"]


def test_the_promised_rate_of_false_alarms_holds() -> None:
    """Of 12 healthy records no more have an alarm than the promised rate allows; a longer stretch promises less."""
    answers = [diagnose_recording(TANK, tank(seed=seed), _often(100.0)) for seed in range(12)]
    rates = [answer.promised_false_alarms or 0.0 for answer in answers]
    allowed = sum(1 - np.exp(-rate * answer.duration / 3600) for rate, answer in zip(rates, answers, strict=True))
    assert sum(bool(answer.decisions) for answer in answers) <= allowed
    assert any(note.code == "record.note.promised" for note in answers[0].notes)
    longer = diagnose_recording(TANK, tank(), _often(400.0)).promised_false_alarms
    assert longer is not None and rates[0] > longer > 4.0


def _often(healthy: float) -> RecordSettings:
    return RecordSettings(healthy=Stretch(begin=0.0, end=healthy), fit="never", false_alarms=4.0)


def test_intervals_hold_the_truth() -> None:
    """In 20 seeds of a sensor offset the size's interval holds the truth at least 17 times."""
    held = 0
    for seed in range(20):
        recording = tank({"offset": since(300, 1.0)}, seed=seed)
        (fault,) = diagnosed(TANK, recording, healthy=290, fit="never").faults
        held += fault.best.size.low <= 1.0 <= fault.best.size.high
    assert held >= 17
