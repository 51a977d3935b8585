"""The standard deviation of the size that a fault has reached.

The size of a rise and its shape (its beginning, and its end or time constant) are estimated from the same data. Their
covariance is J⁻¹ M J⁻¹ with J = Σ ΩᵀΩ and M the covariance of Σ Ωᵀν for the declared noise, Ω being the derivatives of
the innovations with respect to sizes and shape (Huber 1967; White, Econometrica 50, 1982); the variance of the value
reached follows from its derivatives. The shape is estimated on a grid and not with all data; the change of the value
that one step of Gauss–Newton would still make, squared, adds to the variance.
"""

import numpy as np

from thetascope.diagnosis.isolation.decision_state import Event, Evidence, Finding, KnownTheta
from thetascope.diagnosis.isolation.likelihood_fit import Explanation, pseudo_inverse
from thetascope.diagnosis.isolation.replay import ReplayWindow
from thetascope.diagnosis.yield_points import Steps

_PART = 24  # derivatives with respect to the ends are differences over this part of the rise time, to either side


LARGEST_INFLATION = 3.0  # of the deviation of a rise that is still going on, against one of known shape


def rise_variance(window: ReplayWindow, events: tuple[Event, ...], k: int) -> Steps[float]:
    """Return the variance of the value that event `k`, a ramp or an exponential, has reached; 0 if undetermined."""
    part = max(0.5, events[k].rise_time / _PART)
    d, end, size = window.times, window.end, events[k].size
    shifted = [_shifted(events[k], part * a, part * b) for a, b in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    slopes = [(a.course(d) - b.course(d)) * size / (2 * part) for a, b in (shifted[:2], shifted[2:])]
    reached = [(a.unit_value(end) - b.unit_value(end)) * size / (2 * part) for a, b in (shifted[:2], shifted[2:])]
    courses, channels = (
        [*(e.course(d) for e in events), *slopes],
        [*(e.channel for e in events), *[events[k].channel] * 2],
    )
    yield
    scores = yield from window.linearised(events).scores(channels, np.array(courses))
    J = scores.response @ scores.response.T
    scale = np.sqrt(np.maximum(np.diag(J), 1e-300))
    if np.linalg.det(J / np.outer(scale, scale)) < 1e-9:
        return 0.0
    inverse = pseudo_inverse(J)
    gradient = np.zeros(len(J))
    gradient[k], gradient[-2:] = events[k].unit_value(end), reached
    direction = inverse @ gradient
    noise, change = direction @ scores.noise, direction @ (scores.response @ scores.innovations)
    return float(noise @ noise + change**2)


def _shifted(event: Event, begin: float, end: float) -> Event:
    """Return an event with its onset later by `begin` and its end (or its time constant) by `end` decisions."""
    rise_time = event.rise_time + (end if event.exponential else end - begin)
    return Event(event.channel, event.onset + begin, rise_time, event.size, event.exponential)


def base_deviation(base: KnownTheta, event: Event, before: Finding) -> float:
    """Return the standard deviation of the level that an event changes, if that was still moving; else 0."""
    return before.deviation if base.slope[event.channel] or base.asymptote[event.channel] else 0.0


def size_deviation(evidence: Evidence, end: int, fit: Explanation, k: int, known: list[Finding]) -> tuple[float, float]:
    """Return (deviation, v): the standard deviation of the value reached by event `k` for a known shape, and the
    noise's v.

    v (`WindowNoise`) is taken between that of two thirds of the settling time and that of the whole length, by where
    the information comes from: a response that begins abruptly weighs fast noise more than its length suggests.

    Args:
        evidence: thresholds and data.
        end: the last decision.
        fit, k: the fit, and the place of the event.
        known: the faults known before, whose errors pass on to this one.
    """
    event, noise = fit.events[k], evidence.thresholds.noise
    settling, long = (
        float(noise.v[noise.nearest(n), event.channel]) for n in (2 * evidence.thresholds.settle // 3, end - fit.onset)
    )
    v = long + float(fit.early[k]) * max(settling - long, 0.0)
    variance = max(v * fit.covariance[k, k], 0.0)
    return float(np.sqrt(variance + passed_on(fit, k, known, variance)) * abs(event.unit_value(end))), v


def passed_on(fit: Explanation, k: int, known: list[Finding], variance: float) -> float:
    """Return the variance of the size of event `k` due to errors of the faults known before; `variance`: its own."""
    channel = fit.events[k].channel
    others = sum((fit.passed[k, f.channel] * f.deviation) ** 2 for f in known if f.channel not in (channel, None))
    return min(others, variance)  # older errors are partly compensated by the state estimate


def shape_inflation(window: ReplayWindow, event: Event, deviation: float, v: float) -> float:
    """Return the factor by which the deviation of a rise grows because its shape is estimated: its size shows only
    after its end."""
    end = min(int(event.onset + event.rise_time * (2 if event.exponential else 1)), window.end - 1)
    J = float(window.future.ww[max(end - window.begin, 0), event.channel, event.channel])
    return float(np.clip((v / max(J, 1e-300)) ** 0.5 / max(deviation, 1e-300), 1.0, LARGEST_INFLATION))
