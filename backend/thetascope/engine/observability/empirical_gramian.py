"""The empirical observability Gramian along a run: the response of the outputs to small changes of states and faults.

From instants along the nominal trajectory the plant is simulated again with each component of (x, θ) slightly increased
and decreased; half the difference of the outputs is the sensitivity (Lall, Marsden & Glavaski, Int. J. Robust Nonlinear
Control 12, 2002, with one size of change and the unit vectors as directions). States are in units of their scale,
faults in typical faults and outputs in standard deviations of the noise. A singular value of 1 thus means that a change
of that size shifts the outputs by one standard deviation within the window.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from thetascope.engine.estimation.covariance import holds, noise_stds
from thetascope.engine.inputs.sensors import Measurement
from thetascope.engine.inputs.signals import constant, total
from thetascope.engine.observability.opened import opened
from thetascope.engine.observers.support.declaration import Context
from thetascope.engine.observers.support.kalman_defaults import state_scales, typical_sizes
from thetascope.engine.simulation.controlled import simulation_of
from thetascope.engine.simulation.experiment import Experiment, State
from thetascope.messages import Message

SIZE = 1e-3  # size of the changes relative to a scale
RANK = 1e-5  # relative size of a singular value that counts as zero: nonlinearity affects sensitivities at this level
INSTANTS = 12
_MOST_STEPS = 4_000_000  # approximate limit of all simulations together
_MENTIONED = 0.1


@dataclass(frozen=True)
class Empirical:
    """Singular values and Gramians over windows that begin at the times ``t`` (K, in s).

    ``singular`` (K × N): singular values of the sensitivity to ``names`` (N), which are ``x.*`` and ``theta.*``; NaN
    where the plant does not stay finite. ``gramian`` (K × N × N): the square of the sensitivity. ``rank`` (K; −1: not
    finite), ``condition`` (K; ∞ below full rank), ``direction`` (K × N): the least observable direction, a unit vector
    in scaled units.
    """

    window: float
    names: tuple[str, ...]
    t: np.ndarray
    gramian: np.ndarray
    singular: np.ndarray
    rank: np.ndarray
    condition: np.ndarray
    direction: np.ndarray

    @property
    def text(self) -> Message:
        """Return the ranks, the conditions and the least visible combination in a sentence."""
        ranks, size = self.rank[self.rank >= 0], len(self.names)
        if not len(ranks):
            return Message("gramian.diverges")
        low, high = int(ranks.min()), int(ranks.max())
        rank = Message("gramian.ranks", low=low, high=high) if low < high else low
        least = np.where(self.rank >= 0, self.singular[:, -1], np.inf)
        k = int(least.argmin())
        finite = self.condition[np.isfinite(self.condition)]
        parts = [
            f"{v:+.2g} {n.partition('.')[2]}"
            for n, v in zip(self.names, self.direction[k], strict=True)
            if abs(v) >= _MENTIONED
        ]
        values = {"rank": rank, "size": size, "window": self.window, "t": self.t[k]}
        values |= {"direction": " ".join(parts), "level": least[k]}
        if len(finite):
            return Message("gramian.conditioned", low=finite.min(), high=finite.max(), **values)
        return Message("gramian.deficient", **values)


def empirical(
    experiment: Experiment,
    window: float,
    instants: int = INSTANTS,
    unknown: Sequence[str] | None = None,
    size: float = SIZE,
) -> Empirical:
    """Return the Gramian along the experiment (with its faults, without noise) over windows of ``window`` seconds.

    instants: largest number of windows; unknown: the components to test (``x.*``, ``theta.*``; None: all),
    the others are assumed to be known; size: of the changes, relative to a component's scale.
    """
    experiment = opened(experiment.modelled)  # observers know the applied inputs
    context = experiment.context
    names = [*experiment.plant.states, *(i for i in experiment.plant.inputs if i.startswith("theta."))]
    scales = dict(zip(names, [*state_scales(context), *typical_sizes(context)], strict=True))
    names = [n for n in names if unknown is None or n in unknown]
    quiet, stride, weight = _measured(experiment, context)
    count = max(2, round(window / (quiet.every * quiet.step)))
    count = min(count, quiet.steps // quiet.every + 1)
    most = int(_MOST_STEPS / (2 * max(1, len(names)) * count * quiet.every))
    last = max(quiet.steps // quiet.every + 1 - count, 0)
    firsts = np.unique(np.linspace(0, last, min(instants, max(2, most))).astype(int))
    states = _states(quiet, firsts)
    sensitivity = np.stack(
        [
            _sensitivity(
                quiet, State(int(f) * quiet.every, x, (), quiet.measurement.start()), count, stride, names, scales, size
            )
            / weight[:, None]
            for f, x in zip(firsts, states, strict=True)
        ]
    )
    return _result(
        sensitivity.reshape(len(firsts), -1, len(names)),
        count * quiet.every * quiet.step,
        tuple(names),
        firsts * quiet.every * quiet.step,
    )


def _measured(experiment: Experiment, context: Context) -> tuple[Experiment, int, np.ndarray]:
    """Return the experiment without observers and noise, the rows per measured value, and the noise std (m).

    The standard deviation is that of one measured value of each output.
    """
    m = experiment.measurement
    interval = experiment.every * experiment.step
    stride = 1 if m.sample_every is None else max(1, round(m.sample_every / experiment.every))
    # noise held over several rows counts once
    std = noise_stds(m, context) * np.sqrt(np.maximum(1.0, holds(m, experiment.step) / (stride * interval)))
    bare = Measurement(m.outputs, (0.0,) * len(m.outputs), m.sample_time, m.seed)
    return replace(experiment, estimators=(), measurement=bare), stride, std


def _states(e: Experiment, firsts: np.ndarray) -> list[np.ndarray]:
    """Return the plant's state at rows of the nominal trajectory."""
    simulation, last = simulation_of(e), int(firsts[-1]) * e.every + 1
    plant = np.concatenate([rows.plant for _, rows in simulation.spans(last)])
    return [plant[f].copy() for f in firsts]


def _sensitivity(
    e: Experiment, state: State, rows: int, stride: int, names: Sequence[str], scales: dict[str, float], size: float
) -> np.ndarray:
    """Return ∂y/∂(scaled components) over the rows that follow a state (rows, m, N)."""
    columns = []
    for name in names:
        ends = []
        for sign in (1.0, -1.0):
            change = sign * size * scales[name]
            changed, begin = e, state
            if name in e.plant.states:
                x = state.plant.copy()
                x[e.plant.states.index(name)] += change
                begin = replace(state, plant=x)
            else:
                changed = replace(e, signals=e.signals | {name: total([e.signals[name], constant(change)])})
            parts = [r.y for _, r in simulation_of(changed).spans((rows - 1) * e.every + 1, begin)]
            ends.append(np.concatenate(parts)[::stride])
        with np.errstate(invalid="ignore"):  # a plant that diverges
            columns.append((ends[0] - ends[1]) / (2 * size))
    return np.stack(columns, axis=-1)


def _result(S: np.ndarray, window: float, names: tuple[str, ...], t: np.ndarray) -> Empirical:
    K, N = len(S), len(names)
    finite = np.isfinite(S).all(axis=(1, 2))
    singular, direction = np.full((K, N), np.nan), np.full((K, N), np.nan)
    for k in np.flatnonzero(finite):
        # `vectors` must be complete; the other factor is not needed, and would be rows × rows
        _, values, vectors = np.linalg.svd(S[k], full_matrices=len(S[k]) < N)
        singular[k] = np.concatenate([values, np.zeros(N - len(values))])  # fewer values than components
        direction[k] = vectors[-1] * np.sign(vectors[-1][np.abs(vectors[-1]).argmax()])
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(singular[:, :1] > 0, singular / singular[:, :1], 0.0)
        rank = np.where(finite, (relative > RANK).sum(axis=1), -1)
        condition = np.where(rank == N, 1.0 / relative[:, -1], np.inf)
    return Empirical(window, names, t, np.einsum("kri,krj->kij", S, S), singular, rank, condition, direction)
