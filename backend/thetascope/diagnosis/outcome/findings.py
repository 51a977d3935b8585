"""Findings as plain data, in the user's units and words (the shapes of shared/thetascope_schemas/experiment/diagnosis.py)."""

from statistics import NormalDist

import numpy as np

from thetascope.diagnosis.detection.thresholds import Calibrated
from thetascope.diagnosis.detection.window_tests import Sums
from thetascope.diagnosis.input_design.excitation import Excitation, excitation
from thetascope.diagnosis.isolation.decision_state import Found
from thetascope.diagnosis.monitor.detector import Detector
from thetascope.diagnosis.monitor.monitor import Watched
from thetascope.diagnosis.outcome.diagnose_run import Diagnosed, Own

WINDOW = 0.1  # of the horizon: over which excitation is judged
_MOST_COLOURED = 1.0


def quantile(confidence: float) -> float:
    """How many standard deviations an interval reaches to each side."""
    return NormalDist().inv_cdf(0.5 + confidence / 2)


def alarm(found: Found, made: Detector, confidence: float, place: int) -> dict:
    """Return one finding of the detector; `place` is its place among all findings and makes its id, which never changes."""
    dt, cal = made.interval, made.calibrated
    times = {
        "t": found.at * dt,
        "onset": found.onset * dt,
        "onset_from": found.onset_from * dt,
        "onset_to": found.onset_to * dt,
        "cleared": None if found.cleared is None else found.cleared * dt,
    }
    if found.channel is None:
        output = made.filter.outputs[found.output or 0]
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
        names = [c.removeprefix("theta.") for c in made.filter.channels]
        width = quantile(confidence) * found.deviation
        more = {
            "kind": "fault",
            "channel": names[found.channel],
            "output": "",
            "alternatives": tuple(names[i] for i in found.alternatives),
            "size": found.size,
            "size_from": found.size - width,
            "size_to": found.size + width,
            "test": "glr",
            "threshold": cal.glr,
        }
    told = {"id": f"detector-{place + 1}", "observer": "", "statistic": found.statistic} | times | more
    return told | {"text": _sentence(told)}


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


def calibration(cal: Calibrated, interval: float) -> dict:
    return {
        "false_alarms": cal.rate,
        "thresholds": {"glr": cal.glr, "residual": cal.residual},
        "seeds": cal.seeds,
        "hours": cal.hours,
        "from_time": cal.begin * interval,
        "note": "",
    }


def window_of(made: Detector, sums: Sums, horizon: float) -> tuple[np.ndarray, float]:
    """J of the last window over which excitation is judged, and its length in s."""
    length = max(2, min(round(WINDOW * horizon / made.interval), sums.last - sums.first))
    return sums.over(max(sums.last - length, sums.first), sums.last)[0], length * made.interval


def resolution(made: Detector, seen: Excitation) -> list[dict]:
    """For each channel the smallest fault that a window like the last one shows, other faults unknown."""
    noise, threshold = made.calibrated.noise, made.calibrated.glr
    declared = all(std > 0 for std in made.filter.experiment.measurement.std)
    answer = []
    for j, c in enumerate(made.filter.context.model["channels"]):
        name, typical = c["name"], float(c.get("typical", 1.0))
        deviation = seen.deviations.get(name, np.inf) * noise.v[-1, j] ** 0.5
        sigma = float(deviation) if np.isfinite(deviation) else None
        smallest = (
            None if sigma is None else sigma * float((threshold * noise.loud[-1, j] / noise.v[-1, j]) ** 0.5)
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


def noise_levels(made: Detector, watched: Watched) -> list[dict]:
    """Noise of each output as declared, and as the quieter half of the innovations shows it."""
    experiment = made.filter.experiment
    each = np.diff(watched.sums.q, axis=0)[max(0, made.calibrated.begin - watched.sums.first) :] / made.stride
    expected = made.calibrated.noise.energy[0] / made.calibrated.noise.lengths[0] / (made.stride * made.filter.m)
    answer = []
    for k, name in enumerate(made.filter.outputs):
        declared = experiment.measurement.std[k]
        median = float(np.median(each[:, k])) if len(each) else None
        std = made.filter.stds[k]
        estimated = None if median is None else float(std * np.sqrt(median / expected / _median_share(made.stride)))
        answer.append({"output": name.removeprefix("y."), "declared": declared or None, "estimated": estimated})
    return answer


def _median_share(rows: int) -> float:
    """Median of a mean of ``rows`` squared normal numbers (Wilson & Hilferty 1931): what a median must be divided by."""
    return (1 - 2 / (9 * rows)) ** 3


def of_detector(d: Diagnosed, confidence: float, accuracy: float, horizon: float, begin: int | None = None) -> dict:
    """What the detector says; ``begin``: the decision from which on is judged, if that is not its own."""
    if d.detector is None or d.watched is None:
        return {"observer": "", "note": d.note, "sentence": f"no diagnosis: {d.note}"}
    made, watched = d.detector, d.watched
    begin = made.calibrated.begin if begin is None else begin
    alarms = [alarm(f, made, confidence, place) for place, f in enumerate(watched.standing.found)]
    J, length = window_of(made, watched.sums, horizon)
    seen = seen_in(made, J, accuracy)
    return {
        "observer": "",
        "alarms": alarms,
        "sentence": sentence(alarms, begin * made.interval),
        "note": d.note,
        "calibration": calibration(made.calibrated, made.interval) | {"from_time": begin * made.interval},
        "noise": noise_levels(made, watched),
        "resolution": resolution(made, seen),
        "excitation": {
            "window": length,
            "level": seen.level,
            "needed": seen.needed,
            "direction": dict(seen.direction),
            "text": seen.text,
            "proposal": None,
        },
    }


def seen_in(made: Detector, J: np.ndarray, accuracy: float) -> Excitation:
    """What a window tells about the plant's faults."""
    channels = made.filter.context.model["channels"]
    typical = [float(c.get("typical", 1.0)) for c in channels]
    return excitation(J, [c["name"] for c in channels], typical, accuracy)


# ---- observers' own estimates --------------------------------------------------------------------------------------------


def of_observer(own: Own, interval: float, confidence: float, rate: float) -> dict:
    """What the tests on one observer's estimates say."""
    if own.judged is None:
        return {"observer": own.label, "note": own.note}
    alarms = [_raised(own, r, interval, confidence, place) for place, r in enumerate(own.raised)]
    begin = own.judged.begin * interval
    told = {
        "false_alarms": rate,
        "thresholds": {own.judged.test: own.judged.threshold},
        "seeds": own.judged.runs,
        "hours": own.judged.hours,
        "from_time": begin,
        "note": "",
    }
    return {
        "observer": own.label,
        "alarms": alarms,
        "sentence": sentence(alarms, begin),
        "calibration": told,
        "resolution": _own_resolution(own),
    }


def _raised(own: Own, r, interval: float, confidence: float, place: int) -> dict:
    end = len(own.theta) if r.cleared is None else r.cleared
    body = slice(min(r.at, end - 1), max(end, r.at + 1))
    size, sigma = float(np.nanmean(own.theta[body, r.channel])), float(np.nanmean(own.sigma[body, r.channel]))
    width = quantile(confidence) * sigma
    told = {
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
        "test": own.judged.test,
        "statistic": r.statistic,
        "threshold": own.judged.threshold,
        "cleared": None if r.cleared is None else (r.cleared + 1) * interval,
    }
    return told | {"text": _sentence(told)}


def _own_resolution(own: Own) -> list[dict]:
    """How small a constant fault the observer's estimate shows, averaged over the longest window of its test."""
    answer = []
    longest = float(np.sqrt(own.judged.v[-1])) if own.judged.test == "glr" else _MOST_COLOURED
    reach = longest * (own.judged.threshold**0.5 if own.judged.test == "glr" else own.judged.threshold)
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
