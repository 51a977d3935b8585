"""The threshold of the onset bank along a record, for an accepted rate of false alarms.

White noise in place of the innovations is sent through the same bank along the same rows: the responses Ω are those
of the recorded trajectory, so that neither inputs nor a loop have to be simulated. The largest statistic of a stretch
exceeds h with the probability 1 − exp(−C √h e^{−h/2}); C follows from the upper half of the replicas, at its upper
bound. The rate that can be promised allows for noise that is larger than a short healthy stretch shows.
"""

import numpy as np
from scipy.optimize import root_scalar
from scipy.special import chdtri

from thetascope.engine.filtering.bundles import Noise, Path, Rows
from thetascope.engine.filtering.record_filter import RecordFilter, part_of

REPLICAS = 64
_ROWS = 4000  # of the stretch that is simulated, at most
_SEED = 0
_LEAST, _MOST = 4.0, 500.0  # of a threshold
_CERTAIN = 0.95  # probability that the variance of the noise is not larger than assumed for a promised rate


def path_part(path: Path, begin: int, end: int) -> Path:
    """Return rows begin … end − 1 of a path."""
    return Path(**{name: getattr(path, name)[begin:end] for name in Path.__dataclass_fields__})


def crossings(filter_: RecordFilter, data: Rows, noise: Noise, path: Path, used: np.ndarray, tick: float) -> float:
    """Return C per second of record."""
    rows = min(len(data.t), _ROWS)
    first = (len(data.t) - rows) // 2
    data, path = part_of(data, first, first + rows), path_part(path, first, first + rows)
    rng = np.random.default_rng(_SEED)
    nu = rng.standard_normal((REPLICAS, rows, filter_.m))
    nu[:, np.isnan(path.nu)] = 0.0
    bank = filter_.new_bank(REPLICAS, path.z.shape[1] > filter_.n)
    largest = np.sort(filter_.scan(data, noise, path, bank, 0, tick, used, nu).largest.max(axis=0))
    if largest[-1] <= 0:
        return 0.0
    k = np.arange(REPLICAS // 2, REPLICAS)
    probability = 1 - (k + 0.5) / REPLICAS
    upper = np.maximum(largest[k], 1e-9)
    C = float(np.mean(-np.log1p(-probability) / (np.sqrt(upper) * np.exp(-upper / 2))))
    return C * (1 + 1.64 / np.sqrt(REPLICAS / 2)) / float(data.t[-1] - data.t[0])


def threshold(crossing_rate: float, false_alarms: float) -> float:
    """Return h for a rate of false alarms per hour, from C per second."""
    if crossing_rate <= 0:
        return _LEAST

    def excess(h: float) -> float:
        return np.log(3600 * crossing_rate) + 0.5 * np.log(h) - h / 2 - np.log(false_alarms)

    return _LEAST if excess(_LEAST) < 0 else float(root_scalar(excess, bracket=(_LEAST, _MOST)).root)


def promised_rate(crossing_rate: float, threshold: float, rows: int) -> float:
    """Return the false alarms per hour that a threshold keeps with 95 % certainty, where the noise was estimated.

    The variance of Gaussian innovations in ``rows`` rows has a χ² distribution: the true one is at most v times the
    estimated one, and the statistic, in which it is the denominator, is then v times as large.

    Args:
        crossing_rate: C per second; threshold: h; rows: of the healthy stretch, with readings of every output.
    """
    h = threshold * float(chdtri(rows, _CERTAIN)) / rows
    return float(3600 * crossing_rate * np.sqrt(h) * np.exp(-h / 2))
