"""Findings as plain data, in the user's units and words (the shapes of shared/thetascope_schemas/experiment/diagnosis.py)."""

from statistics import NormalDist

import numpy as np

from thetascope.diagnosis.detection.thresholds import Thresholds
from thetascope.diagnosis.detection.window_tests import WindowSums
from thetascope.diagnosis.input_design.excitation import Excitation, excitation
from thetascope.diagnosis.isolation.decision_state import Finding
from thetascope.diagnosis.monitor.detector import Detector
from thetascope.diagnosis.monitor.monitor import MonitorState
from thetascope.diagnosis.outcome.diagnose_run import EstimateDiagnosis, RunDiagnosis

WINDOW = 0.1  # of the horizon: over which excitation is judged
_MOST_COLOURED = 1.0


def quantile(confidence: float) -> float:
    """How many standard deviations an interval reaches to each side."""
    return NormalDist().inv_cdf(0.5 + confidence / 2)


def alarm(finding: Finding, detector: Detector, confidence: float, place: int) -> dict:
    """Return one finding of the detector; `place` is its place among all findings and makes its id, which never changes."""
    dt, cal = detector.interval, detector.thresholds
    times = {
        "t": finding.raised_at * dt,
        "onset": finding.onset * dt,
        "onset_from": finding.onset_from * dt,
        "onset_to": finding.onset_to * dt,
        "cleared": None if finding.cleared is None else finding.cleared * dt,
    }
    if finding.channel is None:
        output = detector.filter.outputs[finding.output or 0]
        more = {
            "kind": "unexplained",
            "channel": "",
            "output": output,
            "alternatives": (),
            "size": None,
            "size_from": None,
            "size_to": None,
            "test": "residual",
            "threshold": cal.residual,
        }
    else:
        names = [c.removeprefix("theta.") for c in detector.filter.channels]
        width = quantile(confidence) * finding.deviation
        more = {
            "kind": "fault",
            "channel": names[finding.channel],
            "output": "",
            "alternatives": tuple(names[i] for i in finding.alternatives),
            "size": finding.size,
            "size_from": finding.size - width,
            "size_to": finding.size + width,
            "test": "glr",
            "threshold": cal.glr,
        }
    record = {"id": f"detector-{place + 1}", "observer": "", "statistic": finding.statistic} | times | more
    return record | {"text": _sentence(record)}


def _sentence(a: dict) -> str:
    since = f"since {a['onset']:.4g} s"
    if a["onset_to"] - a["onset_from"] > 0.02 * max(a["onset"], 1e-9):
        since += f" ({a['onset_from']:.4g} to {a['onset_to']:.4g})"
    over = "" if a["cleared"] is None else f", over at {a['cleared']:.4g} s"
    if a["kind"] == "unexplained":
        return f"{a['output'].removeprefix('y.')}: not explained by any fault of the model, {since}{over}"
    half = (a["size_to"] - a["size_from"]) / 2
    size = f"{a['size']:+.4g} ± {half:.2g}"
    if a["alternatives"]:
        either = " or ".join((a["channel"], *a["alternatives"]))
        return f"{either}: not separable with this input; as {a['channel']} it would be {size}, {since}{over}"
    return f"{a['channel']}: {size} {since}{over}"


def sentence(alarms: list[dict], settled: float) -> str:
    """The diagnosis in a sentence: what is on now, else what was."""
    on = [a["text"] for a in alarms if a["cleared"] is None]
    if on:
        return "; ".join(on)
    return f"no fault found since {settled:.3g} s" if not alarms else "; ".join(a["text"] for a in alarms[-3:])


def calibration(cal: Thresholds, interval: float) -> dict:
    return {
        "false_alarms": cal.rate,
        "thresholds": {"glr": cal.glr, "residual": cal.residual},
        "seeds": cal.seeds,
        "hours": cal.hours,
        "from_time": cal.begin * interval,
        "note": "",
    }


def window_of(detector: Detector, sums: WindowSums, horizon: float) -> tuple[np.ndarray, float]:
    """J of the last window over which excitation is judged, and its length in s."""
    length = max(2, min(round(WINDOW * horizon / detector.interval), sums.last - sums.first))
    return sums.over(max(sums.last - length, sums.first), sums.last)[0], length * detector.interval


def resolution(detector: Detector, seen: Excitation) -> list[dict]:
    """For each channel the smallest fault that a window like the last one shows, other faults unknown."""
    noise, threshold = detector.thresholds.noise, detector.thresholds.glr
    declared = all(std > 0 for std in detector.filter.experiment.measurement.std)
    answer = []
    for j, c in enumerate(detector.filter.context.model["channels"]):
        name, typical = c["name"], float(c.get("typical", 1.0))
        deviation = seen.deviations.get(name, np.inf) * noise.v[-1, j] ** 0.5
        sigma = float(deviation) if np.isfinite(deviation) else None
        smallest = (
            None if sigma is None else sigma * float((threshold * noise.largest_v[-1, j] / noise.v[-1, j]) ** 0.5)
        )  # as tests go by it
        text = _able(name, smallest, typical, declared)
        answer.append(_resolved(name, sigma, typical, smallest, seen.identifiable.get(name, False), text))
    return answer


def _resolved(
    name: str, sigma: float | None, typical: float, smallest: float | None, identifiable: bool, text: str
) -> dict:
    able = smallest is not None and smallest <= typical
    return {
        "channel": name,
        "sigma": sigma,
        "typical": typical,
        "smallest": smallest,
        "resolvable": able,
        "identifiable": identifiable,
        "text": text,
    }


def _able(name: str, smallest: float | None, typical: float, declared: bool) -> str:
    if smallest is None:
        return f"{name} cannot be seen with this input"
    if smallest <= typical:
        return f"{name}: faults from {smallest:.3g} on are found and told from the others"
    at = "at this noise" if declared else "at the noise that is assumed where none is declared"
    return (
        f"{name} cannot be resolved {at}: it takes {smallest:.3g} to be told from the other faults within a "
        f"window, a typical fault is {typical:.3g}"
    )


def noise_levels(detector: Detector, monitor_state: MonitorState) -> list[dict]:
    """Noise of each output as declared, and as the quieter half of the innovations shows it."""
    experiment = detector.filter.experiment
    each = (
        np.diff(monitor_state.sums.q, axis=0)[max(0, detector.thresholds.begin - monitor_state.sums.first) :]
        / detector.stride
    )
    expected = (
        detector.thresholds.noise.energy[0]
        / detector.thresholds.noise.lengths[0]
        / (detector.stride * detector.filter.m)
    )
    answer = []
    for k, name in enumerate(detector.filter.outputs):
        declared = experiment.measurement.std[k]
        median = float(np.median(each[:, k])) if len(each) else None
        std = detector.filter.stds[k]
        estimated = None if median is None else float(std * np.sqrt(median / expected / _median_share(detector.stride)))
        answer.append({"output": name.removeprefix("y."), "declared": declared or None, "estimated": estimated})
    return answer


def _median_share(rows: int) -> float:
    """Median of a mean of ``rows`` squared normal numbers (Wilson & Hilferty 1931): what a median must be divided by."""
    return (1 - 2 / (9 * rows)) ** 3


def of_detector(d: RunDiagnosis, confidence: float, accuracy: float, horizon: float, begin: int | None = None) -> dict:
    """What the detector says; ``begin``: the decision from which on is judged, if that is not its own."""
    if d.detector is None or d.monitor_state is None:
        return {"observer": "", "note": d.note, "sentence": f"no diagnosis: {d.note}"}
    detector, monitor_state = d.detector, d.monitor_state
    begin = detector.thresholds.begin if begin is None else begin
    alarms = [alarm(f, detector, confidence, place) for place, f in enumerate(monitor_state.decisions.findings)]
    J, length = window_of(detector, monitor_state.sums, horizon)
    seen = seen_in(detector, J, accuracy)
    return {
        "observer": "",
        "alarms": alarms,
        "sentence": sentence(alarms, begin * detector.interval),
        "note": d.note,
        "calibration": calibration(detector.thresholds, detector.interval) | {"from_time": begin * detector.interval},
        "noise": noise_levels(detector, monitor_state),
        "resolution": resolution(detector, seen),
        "excitation": {
            "window": length,
            "level": seen.level,
            "needed": seen.needed,
            "direction": dict(seen.direction),
            "text": seen.text,
            "proposal": None,
        },
    }


def seen_in(detector: Detector, J: np.ndarray, accuracy: float) -> Excitation:
    """What a window tells about the plant's faults."""
    channels = detector.filter.context.model["channels"]
    typical = [float(c.get("typical", 1.0)) for c in channels]
    return excitation(J, [c["name"] for c in channels], typical, accuracy)


# ---- observers' own estimates --------------------------------------------------------------------------------------------


def of_observer(own: EstimateDiagnosis, interval: float, confidence: float, rate: float) -> dict:
    """What the tests on one observer's estimates say."""
    if own.test is None:
        return {"observer": own.label, "note": own.note}
    alarms = [_raised(own, r, interval, confidence, place) for place, r in enumerate(own.alarms)]
    begin = own.test.begin * interval
    record = {
        "false_alarms": rate,
        "thresholds": {own.test.test: own.test.threshold},
        "seeds": own.test.runs,
        "hours": own.test.hours,
        "from_time": begin,
        "note": "",
    }
    return {
        "observer": own.label,
        "alarms": alarms,
        "sentence": sentence(alarms, begin),
        "calibration": record,
        "resolution": _own_resolution(own),
    }


def _raised(own: EstimateDiagnosis, r, interval: float, confidence: float, place: int) -> dict:
    end = len(own.theta) if r.cleared is None else r.cleared
    body = slice(min(r.at, end - 1), max(end, r.at + 1))
    size, sigma = float(np.nanmean(own.theta[body, r.channel])), float(np.nanmean(own.sigma[body, r.channel]))
    width = quantile(confidence) * sigma
    record = {
        "id": f"{own.label}-{place + 1}",
        "observer": own.label,
        "t": (r.at + 1) * interval,
        "kind": "fault",
        "channel": own.channels[r.channel],
        "output": "",
        "alternatives": (),
        "onset": r.onset * interval,
        "onset_from": r.onset * interval,
        "onset_to": (r.at + 1) * interval,
        "size": size,
        "size_from": size - width,
        "size_to": size + width,
        "test": own.test.test,
        "statistic": r.statistic,
        "threshold": own.test.threshold,
        "cleared": None if r.cleared is None else (r.cleared + 1) * interval,
    }
    return record | {"text": _sentence(record)}


def _own_resolution(own: EstimateDiagnosis) -> list[dict]:
    """How small a constant fault the observer's estimate shows, averaged over the longest window of its test."""
    answer = []
    longest = float(np.sqrt(own.test.v[-1])) if own.test.test == "glr" else _MOST_COLOURED
    reach = longest * (own.test.threshold**0.5 if own.test.test == "glr" else own.test.threshold)
    for k, name in enumerate(own.channels):
        sigma = float(own.sigma[-1, k])
        typical = own.typical[k]
        smallest = sigma * reach if np.isfinite(sigma) else None
        known = sigma if np.isfinite(sigma) else None
        answer.append(_resolved(name, known, typical, smallest, True, _own_able(name, smallest, typical, sigma)))
    return answer


def _own_able(name: str, smallest: float | None, typical: float, sigma: float) -> str:
    if smallest is None:
        return f"{name}: the estimate is lost"
    if smallest <= typical:
        return f"{name}: faults from {smallest:.3g} on are found"
    return (
        f"{name} cannot be resolved by this observer at this noise: its estimate scatters by {sigma:.3g}, a typical fault "
        f"is {typical:.3g}"
    )
