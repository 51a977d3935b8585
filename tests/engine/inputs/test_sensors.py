"""The measurement: noise, every fault of an output against its definition, sampling; blocks change nothing."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from thetascope.engine.inputs.sensors import Measurement
from thetascope.engine.inputs.signals import steps as jumps
from thetascope.engine.inputs.time_grid import cut

H, STEPS, HOLD = 0.01, 600, 0.05
END = STEPS * H
STAGE = np.array([0.0, 0.5, 0.5, 1.0])


@dataclass(frozen=True)
class Seen:
    """The measured times and values at the four stages of every step."""

    t: np.ndarray
    y: np.ndarray
    anchor: np.ndarray

    def at(self, a: float, b: float = np.inf) -> np.ndarray:
        """Return the values in the steps within [a, b)."""
        return self.y[(self.anchor > a) & (self.anchor < b)]


def smooth(t: np.ndarray, anchor: np.ndarray) -> np.ndarray:
    return np.sin(t) + 0.3 * t


def sensor(*faults: dict, std: float = 0.0, seed: int = 3, every: int | None = None) -> Measurement:
    return Measurement(
        ("y.y",), (std,), (HOLD,), seed, tuple({"output": "y.y", "end": None} | f for f in faults), every
    )


def seen(m: Measurement, chunks: Sequence[int] = (STEPS,), clean=smooth, late=()) -> Seen:
    """Measure ``clean`` in blocks of these numbers of base steps."""
    memory, first, found = m.start(), 0, []
    for count in chunks:
        last = first + count
        breaks = m.breaks((first - 0.5) * H, (last + 0.5) * H, late)
        grid = cut(first, last, H, breaks, 1, 1)
        t = grid.start[:, None] + STAGE * (grid.end - grid.start)[:, None]
        truth = clean(t, np.repeat(grid.anchor[:, None], 4, axis=1))
        y, memory = m.measure(grid, first, truth[:, :, None], memory)
        found.append((t, y[:, :, 0], grid.anchor))
        first = last
    return Seen(*(np.concatenate(part) for part in zip(*found, strict=True)))


CASES = {
    "noise": [],
    "stuck": [{"shape": "stuck", "onset": 1.0, "end": 2.5, "value": 7.0}],
    "freeze": [{"shape": "freeze", "onset": 1.0, "end": 2.5}],
    "freeze from the start": [{"shape": "freeze", "onset": 0.0, "end": 2.5}],
    "dropout": [{"shape": "dropout", "onset": 0.5, "probability": 0.4, "sample_time": 0.1}],
    "outliers": [{"shape": "outliers", "onset": 0.5, "probability": 0.3, "size": 0.8, "sample_time": 0.1}],
    "noise burst": [{"shape": "noise-burst", "onset": 0.5, "end": 4.0, "std": 0.5, "sample_time": 0.03}],
    "quantisation": [{"shape": "quantisation", "onset": 0.5, "end": 4.0, "resolution": 0.25}],
    "delay": [{"shape": "delay", "onset": 0.5, "end": 4.0, "delay": 0.17}],
    "delay off the grid": [{"shape": "delay", "onset": 0.503, "end": 4.0, "delay": 0.1234}],
    "two delays": [{"shape": "delay", "onset": 0.5, "delay": 0.2}, {"shape": "delay", "onset": 2.0, "delay": 0.35}],
    "freeze while quantised": [
        {"shape": "quantisation", "onset": 0.0, "end": 2.0, "resolution": 0.5},
        {"shape": "freeze", "onset": 1.0, "end": 3.0},
    ],
    "dropout while stuck": [
        {"shape": "dropout", "onset": 0.0, "probability": 0.6, "sample_time": 0.3},
        {"shape": "stuck", "onset": 1.0, "end": 2.0, "value": 9.0},
    ],
    "everything": [
        {"shape": "delay", "onset": 0.2, "delay": 0.1},
        {"shape": "quantisation", "onset": 0.4, "resolution": 0.1},
        {"shape": "dropout", "onset": 0.6, "probability": 0.5, "sample_time": 0.07},
        {"shape": "outliers", "onset": 0.8, "probability": 0.3, "size": 1.0, "sample_time": 0.06},
        {"shape": "freeze", "onset": 2.0, "end": 2.4},
        {"shape": "noise-burst", "onset": 3, "std": 1, "sample_time": 0.1},
    ],
}


@pytest.mark.parametrize("every", [None, 7], ids=["continuous", "sampled"])
@pytest.mark.parametrize("faults", CASES.values(), ids=CASES.keys())
def test_chunks_change_no_number(faults: list[dict], every: int | None):
    """Blocks of 1, 2, 49, 148, 1, … base steps, some of which end where faults begin or end: the same bits."""
    m = sensor(*faults, std=0.1, every=every)
    chunks = [1, 2, 47, 50, 1, 99, 50, 1, 49, 100]
    whole, cut_up = seen(m), seen(m, [*chunks, STEPS - sum(chunks)])
    np.testing.assert_array_equal(cut_up.y, whole.y)
    np.testing.assert_array_equal(cut_up.t, whole.t)


def test_noise_has_its_standard_deviation_and_is_held():
    """One independent value per sample time, with the declared standard deviation."""
    m = sensor(std=0.2)
    noise = seen(m, clean=lambda t, anchor: 0 * t)
    index = np.floor(noise.anchor / HOLD).astype(int)
    values = [np.unique(noise.y[index == i]) for i in range(index[-1] + 1)]
    assert all(len(v) == 1 for v in values) and len(np.unique(values)) == len(values)
    many = m.noise_at(HOLD * (np.arange(20_000) + 0.5))[:, 0]
    assert abs(many.std() - 0.2) < 0.005 and abs(np.corrcoef(many[1:], many[:-1])[0, 1]) < 0.03


def test_noise_differs_by_seed_and_output():
    """No two outputs and no two seeds have the same noise."""
    m = Measurement(("y.a", "y.b"), (1.0, 1.0), (HOLD, HOLD), 1)
    other = Measurement(("y.a", "y.b"), (1.0, 1.0), (HOLD, HOLD), 2)
    at = HOLD * (np.arange(2000) + 0.5)
    columns = np.concatenate([m.noise_at(at), other.noise_at(at)], axis=1)
    assert np.abs(np.corrcoef(columns.T) - np.eye(4)).max() < 0.1


def test_stuck_shows_its_value_while_it_lasts():
    """Before and after the fault the output is unaffected."""
    whole, stuck = seen(sensor(std=0.1)), seen(sensor(*CASES["stuck"], std=0.1))
    assert (stuck.at(1.0, 2.5) == 7.0).all()
    for a, b in ((0, 1.0), (2.5, END)):
        np.testing.assert_array_equal(stuck.at(a, b), whole.at(a, b))


def test_freeze_holds_the_last_value():
    """The value at the onset (left limit, with noise) until the end."""
    whole, frozen = seen(sensor(std=0.1)), seen(sensor(*CASES["freeze"], std=0.1))
    assert (frozen.at(1.0, 2.5) == whole.at(0, 1.0)[-1, -1]).all()
    np.testing.assert_array_equal(frozen.at(2.5), whole.at(2.5))
    first = seen(sensor(*CASES["freeze from the start"]))
    assert (first.at(0, 2.5) == smooth(np.zeros(1), np.zeros(1))).all()


def test_dropout_loses_samples_by_chance_and_holds_the_last():
    """Each sample passes unchanged or the last value is held, with the given probability."""
    whole, holed = seen(sensor()), seen(sensor(*CASES["dropout"]))
    last, lost = None, []
    for i in range(len(holed.y)):
        through = np.array_equal(holed.y[i], whole.y[i])
        assert through or (holed.y[i] == last).all()
        lost.append(not through)
        last = holed.y[i, -1]
    per_sample = np.array(lost)[np.searchsorted(holed.anchor, 0.5 + 0.1 * np.arange(55) + 0.051)]
    assert 0.2 < per_sample.mean() < 0.6 and not np.array(lost)[holed.anchor < 0.5].any()
    never, always = ({"shape": "dropout", "onset": 1.0, "probability": p, "sample_time": 0.1} for p in (0.0, 1.0))
    np.testing.assert_array_equal(seen(sensor(never)).y, whole.y)
    assert len(np.unique(seen(sensor(always)).at(1.0))) == 1


def test_outliers_are_displaced_by_their_size_to_either_side():
    """The displacement is 0, +size or −size, held for a sample time, with the given probability."""
    m = sensor(*(f | {"sample_time": 0.01} for f in CASES["outliers"]))
    displaced = (seen(m).y - seen(sensor()).y)[:, 0]
    np.testing.assert_allclose(np.unique(np.round(displaced, 12)), [-0.8, 0.0, 0.8])
    after = np.abs(displaced[50:]) > 0.4
    assert abs(after.mean() - 0.3) < 0.08 and not displaced[:50].any()
    assert 0.3 < (displaced[50:][after] > 0).mean() < 0.7


def test_a_noise_burst_adds_noise_of_its_own_std_while_it_lasts():
    """It has a stream of its own: the ordinary noise is unchanged."""
    burst = seen(sensor(*CASES["noise burst"], std=0.1)).y[:, 0] - seen(sensor(std=0.1)).y[:, 0]
    during = (np.arange(STEPS) + 0.5) * H
    inside = (during > 0.5) & (during < 4.0)
    assert not burst[~inside].any() and 0.35 < burst[inside].std() < 0.65
    changes = np.flatnonzero(np.abs(np.diff(burst[inside])) > 1e-9)
    np.testing.assert_array_equal(np.diff(changes), 3)


def test_quantisation_rounds_to_the_nearest_multiple():
    """Within half a resolution of the truth, for the duration of the fault."""
    whole, coarse = seen(sensor(std=0.1)), seen(sensor(*CASES["quantisation"], std=0.1))
    inside, truth = coarse.at(0.5, 4.0), whole.at(0.5, 4.0)
    np.testing.assert_allclose(inside / 0.25, np.rint(inside / 0.25), atol=1e-12)
    assert np.abs(inside - truth).max() <= 0.125 + 1e-12 and np.abs(inside - truth).max() > 0.1
    np.testing.assert_array_equal(coarse.at(4.0), whole.at(4.0))


@pytest.mark.parametrize("name", ["delay", "delay off the grid"])
def test_a_delay_shows_earlier_values(name: str):
    """y(t − delay) once the delay line is full, until then the value at the onset; after the end the present value."""
    fault = CASES[name][0]
    late = seen(sensor(fault))
    for a, b in ((0, fault["onset"]), (4.0, END)):
        inside = late.y[(late.anchor > a) & (late.anchor < b)]
        t = late.t[(late.anchor > a) & (late.anchor < b)]
        np.testing.assert_allclose(inside, smooth(t, t), atol=1e-12)
    filled = (late.anchor > fault["onset"] + fault["delay"]) & (late.anchor < 4.0)
    expected = smooth(late.t[filled] - fault["delay"], 0)
    np.testing.assert_allclose(late.y[filled], expected, atol=0.2 * H**2)  # linear between the ends of steps
    waiting = (late.anchor > fault["onset"]) & (late.anchor < fault["onset"] + fault["delay"])
    np.testing.assert_allclose(late.y[waiting], smooth(np.array(fault["onset"]), 0), atol=1e-12)


@pytest.mark.parametrize("delay", [0.17, 0.2, 0.1234])
def test_a_delay_keeps_jumps_sharp(delay: float):
    """A held signal with noise is still held: no step contains a mixture of the values before and after a jump."""
    levels = jumps([1.5, 2.0, 2.51], [0.0, 3.0, -1.0, 5.0])
    late = seen(sensor({"shape": "delay", "onset": 0.0, "delay": delay}, std=0.5), clean=levels, late=[levels])
    filled = late.anchor > delay
    then = late.anchor[filled] - delay
    expected = levels(then, then) + sensor(std=0.5).noise_at(then)[:, 0]
    np.testing.assert_allclose(late.y[filled], np.repeat(expected[:, None], 4, axis=1), atol=1e-12)


def test_faults_act_in_the_order_of_the_signal_path():
    """Delay, then loss, then quantisation, in whatever order they are given."""
    faults = [
        {"shape": "quantisation", "onset": 0.0, "resolution": 0.5},
        {"shape": "freeze", "onset": 2.0, "end": 4.0},
        {"shape": "delay", "onset": 0.0, "delay": 0.4},
        {"shape": "stuck", "onset": 4.0, "value": 0.3},
    ]
    for order in (faults, faults[::-1]):
        found = seen(sensor(*order))
        np.testing.assert_allclose(found.at(2.0, 4.0), np.rint(smooth(np.array(1.6), 0) / 0.5) * 0.5, atol=1e-12)
        assert (found.at(4.0) == 0.5).all()


def test_a_fault_of_one_output_does_not_affect_the_others():
    """Of two outputs one is stuck."""
    fault = {"output": "y.a", "shape": "stuck", "onset": 0.0, "end": None, "value": 1.0}
    m = Measurement(("y.a", "y.b"), (0.0, 0.0), (HOLD, HOLD), 0, (fault,))
    grid = cut(0, 10, H, m.breaks(0, 1), 1, 1)
    clean = np.random.default_rng(0).normal(size=(10, 4, 2))
    y, _ = m.measure(grid, 0, clean, m.start())
    assert (y[:, :, 0] == 1.0).all()
    np.testing.assert_array_equal(y[:, :, 1], clean[:, :, 1])


def test_sampled_measurement_holds_the_value_of_the_sample_instant():
    """Every 7 base steps the right limit, with its noise, is sampled and held."""
    sampled, whole = seen(sensor(std=0.1, every=7)), seen(sensor(std=0.1))
    for k in range(0, STEPS, 7):
        assert (sampled.y[k : k + 7] == whole.y[k, 0]).all()


def test_only_additive_disturbances_are_direct():
    """If y is not h(x) plus a known term it cannot be formed inside a kernel."""
    assert sensor(std=0.1).direct and sensor(*CASES["outliers"]).direct and sensor(*CASES["noise burst"]).direct
    assert not any(sensor(*CASES[n]).direct for n in ("stuck", "freeze", "dropout", "quantisation", "delay"))
    assert not sensor(every=5).direct
