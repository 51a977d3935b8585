"""The detector's 95 % intervals hold the truth; docs/diagnosis.md has the counts over many seeds."""

import numpy as np
import pytest

from benchmarks.coverage import count
from benchmarks.coverage_plants import experiment
from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.build.diagnosis_settings import detector_settings
from thetascope.diagnosis.monitor.detector import prepare_detector
from thetascope.diagnosis.yield_points import run_to_end
from thetascope.engine.execution.run_experiment import spans_of
from thetascope.engine.simulation.simulation import row_values


@pytest.mark.parametrize("name", ["pendulum", "van der Pol"])
def test_intervals_hold_where_a_fault_reaches_the_output_through_an_integration(name):
    """Of eight intervals of size and onset at least six hold (of 95 % ones, but for 0.6 %); there is no other alarm."""
    size, onset, others = count(name, range(8))
    assert (size.reported, onset.reported, others) == (8, 8, 0)
    assert size.held >= 6 and onset.held >= 6


@pytest.mark.parametrize(
    ("name", "first", "least"),
    [
        ("friction that grows", 20_049, 7),  # its onset is first estimated up to a second late
        ("orbit", 20_028, 8),  # the interval of its size reaches further down than up
    ],
)
def test_intervals_hold_where_simpler_ones_do_not(name, first, least):
    """Data since shortly before the first estimate of the onset, or symmetric intervals, miss three of these eight."""
    size, onset, _ = count(name, range(first, first + 8))
    assert size.held >= least - 1 and onset.held >= least - 1
    assert (onset if name.startswith("friction") else size).held >= least


def test_a_sensor_fault_between_two_rows_began_up_to_a_row_earlier():
    """The fault at 15.004 s shows in the row of 15.01 s, without doubt: the interval is the row before."""
    alarms = prepare(library.resolve(experiment("sensor of a linear plant"))).run().diagnosis["detector"]["alarms"]
    (found,) = alarms
    assert (found["onset_from"], found["onset_to"]) == pytest.approx((15.0, 15.01))


def test_the_onset_of_an_actuator_fault_lies_between_rows():
    """With little noise the interval of the onset at 15.004 s is shorter than a row of 10 ms and holds it."""
    spec = experiment("cubic")
    spec = spec.model_copy(update={"noise": {"y": spec.noise["y"].model_copy(update={"std": 1e-4})}})
    (found,) = prepare(library.resolve(spec)).run().diagnosis["detector"]["alarms"]
    assert 15.0 < found["onset_from"] < 15.004 < found["onset_to"] < 15.01
    assert found["onset_from"] < found["onset"] < found["onset_to"]


@pytest.mark.parametrize("seed", [10106, 10118, 10099])
def test_an_onset_between_two_rows_does_not_become_a_change_of_size_later(seed):
    """The filter goes on with the size of the best onset; that of the nearest row left errors of 12 standard
    deviations, half an hour later, where the noise is small against the displacement of an orbit."""
    prepared = prepare(library.resolve(experiment("orbit").model_copy(update={"seed": seed})))
    (found,) = prepared.run().diagnosis["detector"]["alarms"]
    deviation = (found["size_to"] - found["size_from"]) / 3.92
    assert abs(found["size"] - 0.05) < 3.5 * deviation


def _filter_along(name: str, count: int):
    """Return (monitor, table, times, backward inputs) of the filter along the first rows of a plant's run."""
    prepared = prepare(library.resolve(experiment(name)))
    engine = prepared.stages[0].experiment
    detector = run_to_end(prepare_detector(engine, engine.context, detector_settings(prepared.spec), ""))
    filter_, (now, rows) = detector.filter, next(iter(spans_of(engine)))
    table = filter_.table(rows.index, rows.y, row_values(now, rows.index, rows.plant), now.signals)[:count]
    t, known = rows.index[:count] * engine.step, np.zeros(filter_.p)
    held = filter_.held(known, table)
    return detector, table, t, detector.backward_pass.backward_inputs(filter_.start(), held, t, np.ones(filter_.m))


def test_the_response_of_scores_to_noise_is_that_of_the_filter():
    """A change of one measurement changes Σ w ν of a linear filter as the adjoint pass says, in any row."""
    detector, table, t, inputs = _filter_along("integral loop", 400)
    filter_, known, w = detector.filter, np.zeros(detector.filter.p), np.random.default_rng(0).normal(size=(1, 400, 1))
    weights = run_to_end(detector.score_programs.noise_weights(inputs, t, w))
    responses = weights[0, -400:] / filter_.stds[0]
    before = filter_.run(filter_.start(), known, table, t).nu
    for row in (0, 1, 57, 200, 398, 399):
        changed = table.copy()
        changed[row, filter_.names.index("measured.y.y")] += 1.0
        change = (w[0] * (filter_.run(filter_.start(), known, changed, t).nu - before)).sum()
        assert change == pytest.approx(responses[row], rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("name", ["leak of two tanks", "stirred tank reactor"])
def test_the_response_to_a_course_is_that_of_the_filter(name):
    """Ω of eleven courses of θ, which begin in different rows, is in each channel the one that the filter computes."""
    detector, table, t, inputs = _filter_along(name, 300)
    filter_, rng = detector.filter, np.random.default_rng(1)
    courses = rng.normal(size=(11, 300)) * (np.arange(300) >= rng.integers(20, 299, size=(11, 1)))
    for channel in range(filter_.p):
        responses = run_to_end(detector.score_programs.responses(inputs, channel, courses))
        for course, response in zip(courses, responses, strict=True):
            profile = np.zeros((300, filter_.p))
            profile[:, channel] = course
            state = filter_.without_sensitivity(filter_.start())
            omega = filter_.run(state, np.zeros(filter_.p), table, t, profile).omega[:, :, channel]
            np.testing.assert_allclose(response, omega, rtol=1e-10, atol=1e-12 * np.abs(omega).max())
