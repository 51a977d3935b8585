"""Gains shared by the Kalman-type observers, with defaults in the plant's units and at its time scale.

The defaults are multiples of the scales and the rate of the plant's healthy run (scales.py), of a channel's typical
size and of the declared noise. They are admissible for every plant and give a working start, not a tuned filter.
"""

from thetascope.engine.model.events import modes
from thetascope.engine.observers.support.declaration import Context, Gain, Option
from thetascope.engine.observers.support.dimensions import (
    FAULT_PER_ROOT_SECOND,
    FAULT_SQUARED,
    OUTPUT_SQUARED,
    OUTPUT_SQUARED_SECONDS,
    RATE,
    SECONDS,
    STATE_SQUARED,
    STATE_SQUARED_PER_SECOND,
)
from thetascope.messages import Message

DOUBT = 0.01  # process noise: one per cent of a state's scale over the plant's time constant
MISFIT = 0.003  # the same for the observers, which estimate faults that would otherwise pass as process noise
WANDER = 0.1  # random walk of θ: its standard deviation over one time constant, in typical faults
FORGETTING = 2.0  # rate of forgetting, in paces
_SPANS = 5.0  # time constants in a run, at least, that λ and the window assume
_SAMPLES = 0.2  # of a time constant: the shortest that λ and the window assume, per sample


def state_scales(c: Context) -> list[float]:
    """Return the size of a change of each state, see `Scales`."""
    return list(c.scales.states)


def uncertain_scales(c: Context) -> list[float]:
    """Return the scales of the states, 0 for those that only events change: they follow from the other states."""
    return [0.0 if mode else s for mode, s in zip(modes(c.model), state_scales(c), strict=True)]


def output_scales(c: Context) -> list[float]:
    """Return the size of a change of each output, see `Scales`."""
    return list(c.scales.outputs)


def pace(c: Context) -> float:
    """Return the slowest rate of the plant in 1/s, along its healthy run."""
    return c.scales.rate


def learning_rate(c: Context) -> float:
    """Return the pace in 1/s within the limits of a run.

    It is at least _SPANS per span of the run, at most _SAMPLES per sample of the noise or of the observer.
    """
    interval = max((c.period, *c.noise_hold))
    return float(min(max(pace(c), _SPANS / c.scales.span), _SAMPLES / interval))


def typical_sizes(c: Context) -> list[float]:
    """Return the typical size of each fault to be estimated."""
    typical = {ch["name"]: float(ch.get("typical", 1.0)) for ch in c.model.get("channels", [])}
    names = c.channels or (tuple(typical) if len(typical) == c.p else ("",) * c.p)
    return [typical.get(name, 1.0) for name in names]


def noise_std(c: Context) -> list[float]:
    """Return the noise of each output: as declared, else one per cent of the output's scale."""
    if all(c.noise_std):  # no need for a healthy run
        return list(c.noise_std)
    return [std or 0.01 * scale for std, scale in zip(c.noise_std, output_scales(c), strict=True)]


def process_noise(c: Context) -> list[float]:
    """Return the default intensity of process noise of every state, from its scale and the plant's time constant."""
    return [pace(c) * (DOUBT * s) * (DOUBT * s) for s in uncertain_scales(c)]


def _state_noise(c: Context) -> list[float]:
    return [pace(c) * (MISFIT * s) ** 2 for s in uncertain_scales(c)]


def _noise_intensity(c: Context) -> list[float]:
    holds = c.noise_hold or (0.0,) * c.m
    return [std * std * (hold or c.period) for std, hold in zip(noise_std(c), holds, strict=True)]


def _quiet_start(c: Context) -> list[float]:
    # √(q r), near the steady state of the Riccati equation: a larger P(0) causes a stiff transient in continuous time
    noise = min(r**0.5 / scale for r, scale in zip(_noise_intensity(c), output_scales(c), strict=True))
    return [q**0.5 * noise * s for q, s in zip(process_noise(c), state_scales(c), strict=True)]


def _walk(c: Context) -> list[float]:
    return [WANDER * learning_rate(c) ** 0.5 * s for s in typical_sizes(c)]


def _typical_variance(c: Context) -> list[float]:
    return [s * s for s in typical_sizes(c)]


Q = Gain(
    "q",
    Message("gain.process-noise"),
    _state_noise,
    size="n",
    symbol="Q",
    unit=STATE_SQUARED_PER_SECOND,
)
R_INTENSITY = Gain(
    "r",
    Message("gain.noise-intensity"),
    _noise_intensity,
    positive=True,
    size="m",
    symbol="R",
    unit=OUTPUT_SQUARED_SECONDS,
)
R_VARIANCE = Gain(
    "r",
    Message("gain.noise-variance"),
    lambda c: [s * s for s in noise_std(c)],
    positive=True,
    size="m",
    symbol="R",
    unit=OUTPUT_SQUARED,
)
P0_QUIET = Gain(
    "p0",
    Message("gain.initial-p-stiff"),
    _quiet_start,
    size="n",
    symbol="P(0)",
    unit=STATE_SQUARED,
    live=False,
)
P0 = Gain(
    "p0",
    Message("gain.initial-p"),
    lambda c: [s * s for s in uncertain_scales(c)],
    size="n",
    symbol="P(0)",
    unit=STATE_SQUARED,
    live=False,
)
LAMBDA = Gain(
    "lambda",
    Message("gain.forgetting-rate"),
    lambda c: FORGETTING * learning_rate(c),
    symbol="λ",
    unit=RATE,
)
GAMMA0_QUIET = Gain(
    "gamma0",
    Message("gain.initial-gamma-stiff"),
    lambda c: [1e-4 * variance for variance in _typical_variance(c)],
    positive=True,
    size="p",
    symbol="Γ(0)",
    unit=FAULT_SQUARED,
    live=False,
)
GAMMA0 = Gain(
    "gamma0",
    Message("gain.initial-theta-covariance"),
    _typical_variance,
    positive=True,
    size="p",
    symbol="Γ(0)",
    unit=FAULT_SQUARED,
    live=False,
)
BOUND = Gain(
    "bound",
    Message("gain.gamma-bound"),
    _typical_variance,
    positive=True,
    size="p",
    symbol="Γ̄",
    unit=FAULT_SQUARED,
)
BOUNDED, PLAIN = "bounded", "plain"
FORGETTING_OPTION = Option("forgetting", Message("option.forgetting"), "choice", BOUNDED, (BOUNDED, PLAIN))
Q_THETA = Gain(
    "q_theta",
    Message("gain.random-walk"),
    _walk,
    size="p",
    symbol="Qθ^½",
    unit=FAULT_PER_ROOT_SECOND,
)
WINDOW = Gain(
    "window",
    Message("gain.excitation-window"),
    lambda c: 3 / learning_rate(c),
    positive=True,
    symbol="T",
    unit=SECONDS,
    live=False,
)
DELTA = Gain(
    "delta",
    Message("gain.excitation-level"),
    1.0,
    symbol="δ",
    live=False,
)
