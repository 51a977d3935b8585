"""The diagnosis as plain data in the user's units (the shapes of shared/thetascope_schemas/experiment/diagnosis.py).

Sentences are messages, which are rendered in the reader's language where they are shown.
"""

from statistics import NormalDist

import numpy as np

from thetascope.diagnosis.detection.thresholds import Thresholds
from thetascope.diagnosis.detection.window_tests import WindowSums
from thetascope.diagnosis.evaluation.observer_tests import EstimateAlarm
from thetascope.diagnosis.input_design.excitation import Excitation, excitation
from thetascope.diagnosis.isolation.decision_state import Finding
from thetascope.diagnosis.monitor.detector import Detector
from thetascope.diagnosis.monitor.monitor import MonitorState
from thetascope.diagnosis.outcome.diagnose_run import EstimateDiagnosis, RunDiagnosis, TestedEstimates
from thetascope.diagnosis.sentences import joined
from thetascope.messages import Message

WINDOW = 0.1  # of the horizon: the window over which excitation is judged
_MOST_COLOURED = 1.0  # deviation of a mean of z over a window, were z constant: no average helps
_CERTAIN_ONSET = 0.02  # relative width of the interval of an onset below which it is not reported
_LATEST = 3  # alarms that the summary names when none is on


def quantile(confidence: float) -> float:
    """Return the half width of an interval in standard deviations."""
    return NormalDist().inv_cdf(0.5 + confidence / 2)


def alarm(finding: Finding, detector: Detector, confidence: float, place: int) -> dict:
    """Return one finding of the detector; `place` is its place among all findings and makes its id, which never
    changes."""
    dt, thresholds = detector.interval, detector.thresholds
    data = {
        "id": f"detector-{place + 1}",
        "observer": "",
        "statistic": finding.statistic,
        "t": finding.raised_at * dt,
        "onset": finding.onset * dt,
        "onset_from": finding.onset_from * dt,
        "onset_to": finding.onset_to * dt,
        "cleared": None if finding.cleared is None else finding.cleared * dt,
    }
    if finding.channel is None:
        data |= {
            "kind": "unexplained",
            "channel": "",
            "output": detector.filter.outputs[finding.output or 0],
            "alternatives": (),
            "size": None,
            "size_from": None,
            "size_to": None,
            "test": "residual",
            "threshold": thresholds.residual,
        }
    else:
        names = [c.removeprefix("theta.") for c in detector.filter.channels]
        width = quantile(confidence) * finding.deviation
        data |= {
            "kind": "fault",
            "channel": names[finding.channel],
            "output": "",
            "alternatives": tuple(names[i] for i in finding.alternatives),
            "size": finding.size,
            "size_from": finding.size + finding.skew - width,
            "size_to": finding.size + finding.skew + width,
            "test": "glr",
            "threshold": thresholds.glr,
        }
    return data | {"text": _alarm_text(data)}


def _alarm_text(alarm: dict) -> Message:
    """Return an alarm in a sentence."""
    when = _period_text(alarm)
    if alarm["kind"] == "unexplained":
        return Message("diagnosis.alarm.unexplained", output=alarm["output"].removeprefix("y."), when=when)
    size, half = alarm["size"], (alarm["size_to"] - alarm["size_from"]) / 2
    if alarm["alternatives"]:
        channels = (alarm["channel"], *alarm["alternatives"])
        return Message(
            "diagnosis.alarm.ambiguous", channels=channels, channel=alarm["channel"], size=size, half=half, when=when
        )
    return Message("diagnosis.alarm.fault", channel=alarm["channel"], size=size, half=half, when=when)


def _period_text(alarm: dict) -> Message:
    """Return since when, and until when, an alarm's fault was on."""
    times = {"onset": alarm["onset"]}
    uncertain = alarm["onset_to"] - alarm["onset_from"] > _CERTAIN_ONSET * alarm["onset"]
    if uncertain:
        times |= {"earliest": alarm["onset_from"], "latest": alarm["onset_to"]}
    since = Message("diagnosis.since.between" if uncertain else "diagnosis.since.time", **times)
    return since if alarm["cleared"] is None else Message("diagnosis.since.over", since=since, end=alarm["cleared"])


def summary(alarms: list[dict], settled: float) -> Message:
    """Return the diagnosis in a sentence: the alarms that are on, else the latest ones; `settled`: time from which on
    tests run, s."""
    if not alarms:
        return Message("diagnosis.summary.no-fault", since=settled)
    active = [a["text"] for a in alarms if a["cleared"] is None]
    return joined(active or [a["text"] for a in alarms[-_LATEST:]])


def calibration(thresholds: Thresholds, interval: float) -> dict:
    """Return where the detector's thresholds come from; `interval`: time between decisions, s."""
    return {
        "false_alarms": thresholds.rate,
        "thresholds": {"glr": thresholds.glr, "residual": thresholds.residual},
        "seeds": thresholds.seeds,
        "hours": thresholds.hours,
        "from_time": thresholds.begin * interval,
    }


def window_of(detector: Detector, sums: WindowSums, horizon: float) -> tuple[np.ndarray, float]:
    """Return (J, length in s) of the last window, over which excitation is judged; J is (p, p)."""
    length = max(2, min(round(WINDOW * horizon / detector.interval), sums.last - sums.first))
    return sums.over(max(sums.last - length, sums.first), sums.last)[0], length * detector.interval


def resolution(detector: Detector, excited: Excitation) -> list[dict]:
    """Return for each channel the smallest fault that a window like the last one shows, the other faults being
    unknown."""
    noise, threshold = detector.thresholds.noise, detector.thresholds.glr
    declared = all(std > 0 for std in detector.filter.experiment.measurement.std)
    resolutions = []
    for j, c in enumerate(detector.filter.context.model["channels"]):
        name, typical = c["name"], float(c.get("typical", 1.0))
        deviation = float(excited.deviations.get(name, np.inf) * noise.v[-1, j] ** 0.5)
        sigma = deviation if np.isfinite(deviation) else None
        # tests are normalised by the largest v along the run
        factor = float((threshold * noise.largest_v[-1, j] / noise.v[-1, j]) ** 0.5)
        smallest = None if sigma is None else sigma * factor
        text = _resolution_text(name, smallest, typical, declared)
        identifiable = excited.identifiable.get(name, False)
        resolutions.append(_resolution(name, sigma, typical, smallest, identifiable, text))
    return resolutions


def _resolution(
    name: str, sigma: float | None, typical: float, smallest: float | None, identifiable: bool, text: Message
) -> dict:
    return {
        "channel": name,
        "sigma": sigma,
        "typical": typical,
        "smallest": smallest,
        "resolvable": smallest is not None and smallest <= typical,
        "identifiable": identifiable,
        "text": text,
    }


def _resolution_text(name: str, smallest: float | None, typical: float, declared: bool) -> Message:
    if smallest is None:
        return Message("diagnosis.resolution.hidden", channel=name)
    if smallest <= typical:
        return Message("diagnosis.resolution.found", channel=name, smallest=smallest)
    code = "diagnosis.resolution.lost" if declared else "diagnosis.resolution.lost-assumed-noise"
    return Message(code, channel=name, smallest=smallest, typical=typical)


def noise_levels(detector: Detector, state: MonitorState) -> list[dict]:
    """Return the noise of each output as declared and as estimated from the median of the innovations' energy."""
    experiment, noise = detector.filter.experiment, detector.thresholds.noise
    begin = max(0, detector.thresholds.begin - state.sums.first)
    energy = np.diff(state.sums.q, axis=0)[begin:] / detector.stride
    expected = noise.energy[0] / noise.lengths[0] / (detector.stride * detector.filter.m)
    levels = []
    for k, name in enumerate(detector.filter.outputs):
        estimated = None
        if len(energy):
            share = float(np.median(energy[:, k])) / expected / _median_share(detector.stride)
            estimated = float(detector.filter.stds[k] * np.sqrt(share))
        declared = experiment.measurement.std[k]
        levels.append({"output": name.removeprefix("y."), "declared": declared or None, "estimated": estimated})
    return levels


def _median_share(rows: int) -> float:
    """Return the median of a mean of squared standard normal numbers (Wilson & Hilferty, PNAS 17, 1931)."""
    return (1 - 2 / (9 * rows)) ** 3


def detector_report(
    diagnosis: RunDiagnosis, confidence: float, accuracy: float, horizon: float, begin: int | None = None
) -> dict:
    """Return the detector's diagnosis.

    Args:
        diagnosis: that of the run.
        confidence: of the intervals.
        accuracy: required standard deviation of an estimate, as a share of a typical fault.
        horizon: length of the run, s.
        begin: the decision from which on tests run, if it is not that of the thresholds.
    """
    detector, state = diagnosis.detector, diagnosis.monitor_state
    if detector is None or state is None:
        return {
            "observer": "",
            "note": diagnosis.note,
            "sentence": Message("diagnosis.summary.none", reason=diagnosis.note),
        }
    start = (detector.thresholds.begin if begin is None else begin) * detector.interval
    alarms = [alarm(f, detector, confidence, place) for place, f in enumerate(state.decisions.findings)]
    J, length = window_of(detector, state.sums, horizon)
    excited = excitation_of(detector, J, accuracy)
    return {
        "observer": "",
        "alarms": alarms,
        "sentence": summary(alarms, start),
        "note": diagnosis.note,
        "calibration": calibration(detector.thresholds, detector.interval) | {"from_time": start},
        "noise": noise_levels(detector, state),
        "resolution": resolution(detector, excited),
        "excitation": {
            "window": length,
            "level": excited.level,
            "needed": excited.needed,
            "direction": dict(excited.direction),
            "text": excited.text,
            "proposal": None,
        },
    }


def excitation_of(detector: Detector, J: np.ndarray, accuracy: float) -> Excitation:
    """Return the excitation of the plant's faults in a window with information J (p, p)."""
    channels = detector.filter.context.model["channels"]
    typical = [float(c.get("typical", 1.0)) for c in channels]
    return excitation(J, [c["name"] for c in channels], typical, accuracy)


# ---- observers' own estimates ----------------------------------------------------------------------------------------


def observer_report(own: EstimateDiagnosis, interval: float, confidence: float, rate: float) -> dict:
    """Return the diagnosis by one observer's estimates; `interval`: time between decisions, s; `rate`: false alarms per
    hour."""
    if own.tested is None:
        return {"observer": own.label, "note": own.note}
    test = own.tested.test
    alarms = [
        _estimate_alarm(own, own.tested, a, interval, confidence, place) for place, a in enumerate(own.tested.alarms)
    ]
    begin = test.begin * interval
    return {
        "observer": own.label,
        "alarms": alarms,
        "sentence": summary(alarms, begin),
        "calibration": {
            "false_alarms": rate,
            "thresholds": {test.test: test.threshold},
            "seeds": test.runs,
            "hours": test.hours,
            "from_time": begin,
        },
        "resolution": _estimate_resolution(own.channels, own.tested),
    }


def _estimate_alarm(
    own: EstimateDiagnosis,
    tested: TestedEstimates,
    raised: EstimateAlarm,
    interval: float,
    confidence: float,
    place: int,
) -> dict:
    """Return one alarm on an observer's estimates; its size is the mean estimate while it is on."""
    end = len(tested.theta) if raised.cleared is None else raised.cleared
    body = slice(min(raised.at, end - 1), max(end, raised.at + 1))
    size = float(np.nanmean(tested.theta[body, raised.channel]))
    width = quantile(confidence) * float(np.nanmean(tested.sigma[body, raised.channel]))
    data = {
        "id": f"{own.label}-{place + 1}",
        "observer": own.label,
        "t": (raised.at + 1) * interval,
        "kind": "fault",
        "channel": own.channels[raised.channel],
        "output": "",
        "alternatives": (),
        "onset": raised.onset * interval,
        "onset_from": raised.onset * interval,
        "onset_to": (raised.at + 1) * interval,
        "size": size,
        "size_from": size - width,
        "size_to": size + width,
        "test": tested.test.test,
        "statistic": raised.statistic,
        "threshold": tested.test.threshold,
        "cleared": None if raised.cleared is None else (raised.cleared + 1) * interval,
    }
    return data | {"text": _alarm_text(data)}


def _estimate_resolution(channels: tuple[str, ...], tested: TestedEstimates) -> list[dict]:
    """Return for each channel the smallest constant fault that the test shows over its longest window."""
    test = tested.test
    if test.test == "glr":
        factor = float(np.sqrt(test.v[-1])) * test.threshold**0.5
    else:
        factor = _MOST_COLOURED * test.threshold
    resolutions = []
    for k, name in enumerate(channels):
        sigma = float(tested.sigma[-1, k])
        finite, typical = np.isfinite(sigma), tested.typical[k]
        smallest = sigma * factor if finite else None
        text = _estimate_resolution_text(name, smallest, typical, sigma)
        resolutions.append(_resolution(name, sigma if finite else None, typical, smallest, True, text))
    return resolutions


def _estimate_resolution_text(name: str, smallest: float | None, typical: float, sigma: float) -> Message:
    if smallest is None:
        return Message("diagnosis.resolution.diverged", channel=name)
    if smallest <= typical:
        return Message("diagnosis.resolution.found-alone", channel=name, smallest=smallest)
    return Message("diagnosis.resolution.lost-observer", channel=name, sigma=sigma, typical=typical)
