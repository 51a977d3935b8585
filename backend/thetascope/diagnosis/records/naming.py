"""Which fault explains a stretch of rows: candidates to first order, then the filter with the fault in it.

Candidates are every channel × course × onset, ranked by the generalised likelihood ratio of their responses. The best
of each channel and course are refined by the Levenberg–Marquardt method in size, onset, and slope or time constant;
each trial runs the filter with the faults in it. The score is −2 log L with a penalty of log(readings) a number, and of
(θ/3 typical)²: faults that a loop hides are equal in fit, and only their usual size orders them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from thetascope.diagnosis.records.events import DRIFT, END, PLATEAU, RAMP, RISE, STEP, FaultEvent, courses
from thetascope.engine.filtering.bundles import Faults, Noise, Rows
from thetascope.engine.filtering.linear import solved
from thetascope.engine.filtering.record_filter import FilterResult, RecordFilter

EQUAL = 6.0  # difference of scores up to which explanations are not separable
_USUAL = 3.0  # typical sizes: the standard deviation of a fault's size
_CHANNELS = 8  # own channels that are refined
_ADDITIVE = 2  # additive faults that are refined
_LACKING = 12.0  # by which an additive fault that the plant lacks must explain better
_MARGIN, _UNCERTAIN = 60.0, 0.4  # first-order scores worse by this, or by this part of the best ratio, are left out
_FIRST = 2  # channels of which several courses are refined
_LOT = 200  # courses in one call
_SHAPES = 3  # courses of these
_ROUGH = 3  # iterations of all candidates,
_ITERATIONS = 12  # and of those whose score is not worse by more than
_FAR = 25.0
_ENOUGH = 0.02  # fall of −2 log L at which refining ends


@dataclass(frozen=True)
class Stretch:
    """Rows with everything that the filter needs along them.

    Attributes:
        filter, noise, coloured: the filter and its noise.
        data: the rows.
        z, P: the prediction for the first row.
        bounds: (channels, 2), of θ, ±∞ for none.
        own: the plant's own channels; the others are additive faults that it lacks.
    """

    filter: RecordFilter
    noise: Noise
    data: Rows
    z: np.ndarray
    P: np.ndarray
    bounds: np.ndarray
    own: int

    @property
    def typical(self) -> np.ndarray:
        """Return the typical size of each fault."""
        return self.filter.scale

    @property
    def period(self) -> float:
        """Return the usual time between rows, s."""
        return float(np.median(self.data.width))

    @property
    def readings(self) -> int:
        """Return the number of readings."""
        return int(np.isfinite(self.data.y).sum())

    def run(self, events: Sequence[FaultEvent], channels: Sequence[int] | None = None) -> FilterResult:
        """Filter the rows with known faults; ``channels``: those whose responses are needed, None: all."""
        faults = Faults(*courses(events, self.filter.p, self.data.t, self.data.width))
        return self.filter.filter(self.data, self.noise, self.z, self.P, faults, channels=channels)


@dataclass(frozen=True)
class Explanation:
    """A story that explains a stretch: its events, score, −2 log L, and the covariance of the free numbers.

    ``free`` counts the events from the end of the story that were refined.
    """

    events: tuple[FaultEvent, ...]
    score: float
    loss: float
    covariance: np.ndarray
    free: int = 1
    result: FilterResult | None = field(default=None, repr=False, compare=False)

    @property
    def event(self) -> FaultEvent:
        """Return the last event."""
        return self.events[-1]

    @property
    def free_events(self) -> tuple[FaultEvent, ...]:
        """Return the events whose numbers were refined."""
        return self.events[len(self.events) - self.free :]


# ---- refining ------------------------------------------------------------------------------------------------------


def _unit(stretch: Stretch, event: FaultEvent, name: str) -> float:
    """Return the natural unit of a number of an event."""
    typical = float(stretch.typical[event.channel])
    span = float(stretch.data.t[-1] - stretch.data.t[0]) or 1.0
    if name == "size":
        return typical / span if event.shape == RAMP else typical
    return {"onset": stretch.period, "slope": typical / span, "tau": event.tau}[name]


def _derivatives(stretch: Stretch, events: Sequence[FaultEvent], free: Sequence[int]) -> tuple[np.ndarray, ...]:
    """Return the courses of the derivatives by all free numbers: channel, means over intervals, values in rows."""
    t, width, typical = stretch.data.t, stretch.data.width, stretch.typical
    channel, interval, row = [], [], []
    for i in free:
        event = events[i]
        for name in event.parameters():
            unit = _unit(stretch, event, name)
            step = unit if name == "onset" else 1e-3 * unit
            value = getattr(event, name)
            sides = []
            for sign in (0.5, -0.5):
                moved = event.moved(**{name: value + sign * step})
                story = [*events[:i], moved, *events[i + 1 :]]
                sides.append([part[:, event.channel] for part in courses(story, stretch.filter.p, t, width)])
            scale = unit / step / typical[event.channel]
            interval.append((sides[0][0] - sides[1][0]) * scale)
            row.append((sides[0][1] - sides[1][1]) * scale)
            channel.append(event.channel)
    return np.array(channel), np.array(interval), np.array(row)


def _moved(stretch: Stretch, events: Sequence[FaultEvent], free: Sequence[int], step: np.ndarray) -> list[FaultEvent]:
    """Return the events with their free numbers changed by a step in natural units."""
    moved, place = list(events), 0
    first, last = stretch.data.t[0], stretch.data.t[-1] - stretch.period
    for i in free:
        event, changes = events[i], {}
        for name in event.parameters():
            change = step[place] * _unit(stretch, event, name)
            if name == "tau":
                changes[name] = event.tau * float(np.exp(np.clip(step[place], -2.0, 2.0)))
            else:
                changes[name] = getattr(event, name) + float(change)
            place += 1
        changes["onset"] = float(np.clip(changes["onset"], min(first, event.onset), last))
        moved[i] = event.moved(**changes)
    return moved


def refine(stretch: Stretch, events: Sequence[FaultEvent], free: Sequence[int], most: int = _ITERATIONS) -> Explanation:
    """Return the events with the most likely numbers of those that are free (Levenberg–Marquardt).

    −2 log L is not smooth in the onset of a fault that shows in whole rows: where a step fails, it is tried again with
    the onsets held.
    """
    events = list(events)
    onset = np.array([name == "onset" for i in free for name in events[i].parameters()])
    channels = sorted({events[i].channel for i in free})
    result = stretch.run(events, channels)
    damping = 1e-3
    covariance = np.zeros((0, 0))
    for _ in range(most):
        channel, interval, row = _derivatives(stretch, events, free)
        omega = stretch.filter.responses(stretch.data, stretch.noise, result.path, channel, interval, row)
        omega = omega.reshape(len(channel), -1)
        information, gradient = omega @ omega.T, omega @ np.nan_to_num(result.path.nu).ravel()
        diagonal = np.diag(information) + 1e-12
        root = np.sqrt(np.outer(diagonal, diagonal))
        covariance = _pseudo_inverse(information / root) / root
        better, trial = None, events
        for attempt in range(8):
            matrix = information + np.diag(damping * diagonal + 1e-12)
            held = onset if attempt % 2 else np.zeros_like(onset)
            step = np.zeros(len(gradient))
            step[~held] = solved(matrix[np.ix_(~held, ~held)], gradient[~held])
            trial = _moved(stretch, events, free, step)
            tried = stretch.run(trial, channels)
            if np.isfinite(tried.loss) and tried.loss < result.loss:
                better = tried
                break
            damping = max(8 * damping, 1e-2) if attempt % 2 else damping
        if better is None:
            break
        fall, events, result = result.loss - better.loss, trial, better
        damping = max(damping / 5, 1e-6)
        if fall < _ENOUGH:
            break
    scale = np.array([_unit(stretch, events[i], name) for i in free for name in events[i].parameters()])
    covariance = covariance * np.outer(scale, scale) if len(covariance) else np.zeros((len(scale), len(scale)))
    return Explanation(
        tuple(events), score(stretch, events, free, result.loss), result.loss, covariance, len(free), result
    )


def _pseudo_inverse(matrix: np.ndarray) -> np.ndarray:
    """Return the pseudo-inverse of a symmetric matrix, 0 where numbers are not finite."""
    if not np.isfinite(matrix).all():
        return np.zeros_like(matrix)
    return np.linalg.pinv(matrix, rcond=1e-10, hermitian=True)


def score(stretch: Stretch, events: Sequence[FaultEvent], free: Sequence[int], loss: float) -> float:
    """Return −2 log L with penalties; ∞ for a fault beyond its bounds."""
    numbers = sum(len(events[i].parameters()) for i in free)
    total = loss + numbers * np.log(max(stretch.readings, 2))
    theta = courses(events, stretch.filter.p, stretch.data.t, stretch.data.width)[1]
    for c in {events[i].channel for i in free}:
        total += _LACKING * (c >= stretch.own)
        size = theta[np.abs(theta[:, c]).argmax(), c]
        total += (size / (_USUAL * stretch.typical[c])) ** 2
        slack = 0.05 * stretch.typical[c]
        if not stretch.bounds[c, 0] - slack <= size <= stretch.bounds[c, 1] + slack:
            return np.inf
    return float(total)


# ---- candidates ------------------------------------------------------------------------------------------------------


def onsets(first: int, last: int, count: int, more: Sequence[int] = ()) -> np.ndarray:
    """Return rows at geometrically growing distances before the last row, and some more."""
    distances = np.geomspace(1, max(last - first, 2), count)
    kept = np.array([k for k in more if first <= k < last], dtype=int)
    rows = np.unique(np.concatenate([np.round(last - distances).astype(int), kept]))
    return rows[(rows >= max(first, 0)) & (rows < last)]


def candidates(
    stretch: Stretch, result: FilterResult, rows: np.ndarray, taus: Sequence[float] = ()
) -> list[tuple[float, FaultEvent]]:
    """Return the best onset of every channel and course with its generalised likelihood ratio, largest first."""
    t, width = stretch.data.t, stretch.data.width
    nu = np.nan_to_num(result.path.nu).ravel()
    best: dict[tuple[int, str], tuple[float, FaultEvent]] = {}

    def offer(ratio: float, event: FaultEvent) -> None:
        key = (event.channel, event.shape)
        if np.isfinite(ratio) and (key not in best or ratio > best[key][0]):
            best[key] = (ratio, event)

    kinds = [(STEP, 1.0), (RAMP, 1.0), *((shape, tau) for tau in taus for shape in (RISE, PLATEAU))]
    unit = [FaultEvent(0, s, float(t[k]), 1.0, 0.0, tau) for k in rows for s, tau in kinds]
    shapes = np.array([e.means(t, width) for e in unit]), np.array([e.values(t) for e in unit])
    for c in range(stretch.filter.d):
        omega = np.concatenate(
            [
                stretch.filter.responses(
                    stretch.data,
                    stretch.noise,
                    result.path,
                    np.full(len(shapes[0][k : k + _LOT]), c),
                    shapes[0][k : k + _LOT],
                    shapes[1][k : k + _LOT],
                ).reshape(len(shapes[0][k : k + _LOT]), -1)
                for k in range(0, len(unit), _LOT)
            ]
        )
        a, b = omega @ nu, np.einsum("ij,ij->i", omega, omega)
        typical = float(stretch.typical[c])
        for event, x, y in zip(unit, a, b, strict=True):
            if y > 1e-9:
                offer(x * x / y, replace(event, channel=c, size=typical * x / y))
        for i in range(0, len(unit), len(kinds)):  # a step and a ramp of one onset together
            cross = omega[i] @ omega[i + 1]
            determinant = b[i] * b[i + 1] - cross * cross
            if determinant > 1e-6 * b[i] * b[i + 1] > 0:
                size = (b[i + 1] * a[i] - cross * a[i + 1]) / determinant
                slope = (b[i] * a[i + 1] - cross * a[i]) / determinant
                event = FaultEvent(c, DRIFT, unit[i].onset, typical * size, typical * slope)
                offer(size * a[i] + slope * a[i + 1], event)
    return sorted(best.values(), key=lambda pair: -pair[0])


def within_bounds(stretch: Stretch, events: Sequence[FaultEvent], event: FaultEvent, slack: float = 0.5) -> bool:
    """Return whether the faults of a channel stay within its bounds, with a slack in typical sizes."""
    theta = courses([*events, event], stretch.filter.p, stretch.data.t, stretch.data.width)[1][:, event.channel]
    slack = slack * stretch.typical[event.channel]
    low, high = stretch.bounds[event.channel]
    return bool(theta.min() >= low - slack and theta.max() <= high + slack)


def explanations(
    stretch: Stretch,
    events: Sequence[FaultEvent],
    rows: np.ndarray,
    taus: Sequence[float] = (),
    channels: int = _CHANNELS,
) -> list[Explanation]:
    """Return stories with one more event that explain a stretch, best first."""
    base = stretch.run(events)
    ranked = candidates(stretch, base, rows, taus)
    ranked = [pair for pair in ranked if within_bounds(stretch, events, pair[1])] or ranked
    if not ranked:
        return []
    rough = [refine(stretch, [*events, e], [len(events)], _ROUGH) for e in _chosen(stretch, ranked, channels)]
    limit = min((story.score for story in rough), default=np.inf) + _FAR
    stories = [refine(stretch, s.events, [len(events)]) if s.score < limit else s for s in rough]
    stories += _endings(stretch, events, rows, base)
    return sorted(stories, key=lambda story: story.score)


def _chosen(stretch: Stretch, ranked: Sequence[tuple[float, FaultEvent]], channels: int) -> list[FaultEvent]:
    """Return the candidates that are refined: the best course of the best channels, and more courses of the first ones.

    To first order a course of k numbers scores k log n − ratio. Large faults of a plant that is not linear may be wrong
    by a part of the ratio.
    """
    numbers = np.log(max(stretch.readings, 2))
    scored = sorted(
        (len(e.parameters()) * numbers - ratio + _LACKING * (e.channel >= stretch.own), place)
        for place, (ratio, e) in enumerate(ranked)
    )
    margin = max(_MARGIN, _UNCERTAIN * ranked[0][0])
    chosen: dict[int, list[FaultEvent]] = {}
    for value, place in scored:
        event = ranked[place][1]
        own = event.channel < stretch.own
        group = [c for c in chosen if (c < stretch.own) == own]
        if event.channel not in chosen and len(group) >= (channels if own else _ADDITIVE):
            continue
        courses_ = chosen.setdefault(event.channel, [])
        most = _SHAPES if list(chosen).index(event.channel) < _FIRST else 1
        if value < scored[0][0] + margin and len(courses_) < most:
            courses_.append(event)
    return [event for part in chosen.values() for event in part]


def _endings(stretch: Stretch, events: Sequence[FaultEvent], rows: np.ndarray, base: FilterResult) -> list[Explanation]:
    """Return stories in which a fault that is present ends; the best row for it is found to first order."""
    t, width, nu = stretch.data.t, stretch.data.width, np.nan_to_num(base.path.nu)
    present = np.flatnonzero(courses(events, stretch.filter.p, t[-1:], width[-1:])[1][0])
    interval, row = courses(events, stretch.filter.p, t, width)
    stories = []
    for c in present if len(rows) else ():
        trials = [FaultEvent(int(c), END, float(t[k])) for k in rows]
        ended = [courses([*events, trial], stretch.filter.p, t, width) for trial in trials]
        changes = [np.array([e[part][:, c] for e in ended]) - now[:, c] for part, now in enumerate((interval, row))]
        channel = np.full(len(trials), c)
        scaled = [change / stretch.typical[c] for change in changes]
        omega = stretch.filter.responses(stretch.data, stretch.noise, base.path, channel, *scaled)
        losses = np.sum((nu - omega) ** 2, axis=(1, 2))
        stories.append(refine(stretch, [*events, trials[int(np.argmin(losses))]], [len(events)], _ROUGH))
    return stories


def size_at(explanation: Explanation, place: int, t: float, channels: int) -> tuple[float, float]:
    """Return the size of the channel of a free event at time t, and its standard deviation.

    ``place``: which of the free events, counted from the first of them.
    """
    events = list(explanation.events)
    first = len(events) - explanation.free
    channel = events[first + place].channel
    instant, width = np.array([t]), np.array([0.0])

    def value(story: list[FaultEvent]) -> float:
        return float(courses(story, channels, instant, width)[1][0, channel])

    gradient = []
    for i in range(first, len(events)):
        for name in events[i].parameters():
            number = getattr(events[i], name)
            if name == "onset" and events[i].shape in (STEP, END):
                gradient.append(0.0)
                continue
            step = 1e-5 * (abs(number) or 1.0)
            sides = [
                value([*events[:i], events[i].moved(**{name: number + s * step}), *events[i + 1 :]]) for s in (1, -1)
            ]
            gradient.append((sides[0] - sides[1]) / (2 * step))
    slope = np.array(gradient)
    return value(events), float(np.sqrt(max(slope @ explanation.covariance @ slope, 0.0)))
