"""Batches: every run has the bits of that run alone, whatever differs and however many there are."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from tests.engine.plants import adaptive, engine, oscillator
from thetascope import library
from thetascope.assembly import prepare
from thetascope.engine.errors import Cancelled
from thetascope.engine.simulation import batch
from thetascope.engine.simulation.batch import run_batch, with_seed
from thetascope.engine.simulation.experiment import Experiment
from thetascope.engine.simulation.simulation import Simulation
from thetascope_schemas import Experiment as Spec

SHORT = {"horizon": 2.0, "evaluate": 0.05}
HIGH_GAIN = {"label": "high", "kind": "high-gain", "gains": {"rho": 3.0}, "initial": {"x1": 0.5}}


def alone(e: Experiment) -> tuple[np.ndarray, list[np.ndarray]]:
    """Return the recorded states of the plant and the observers of one run."""
    parts = [rows for _, rows in Simulation(e, e.substeps or 1).spans(e.steps + 1)]
    plant = np.concatenate([p.plant for p in parts])
    return plant, [np.concatenate(o) for o in zip(*(p.observers for p in parts), strict=True)]


def agree(experiments: Sequence[Experiment]) -> None:
    together = run_batch(experiments)
    assert len(together.plant) == len(experiments)
    for i, e in enumerate(experiments):
        plant, observers = alone(e)
        np.testing.assert_array_equal(together.plant[i], plant)
        for many, one in zip(together.observers, observers, strict=True):
            np.testing.assert_array_equal(many[i], one)
    np.testing.assert_array_equal(together.index, np.arange(0, experiments[0].steps + 1, experiments[0].every))


def various(i: int, **changes) -> Experiment:
    """Return run i of a batch in which seed, parameters, gains, starts, inputs and faults all differ."""
    share = i / 10
    return engine(
        **SHORT
        | {
            "seed": i,
            "parameters": {"k": 4 + share, "d": 0.3 - 0.02 * share},
            "initial": {"x1": 1 - share, "x2": 0.1 * share},
            "inputs": {"u": {"kind": "sine", "amplitude": 1 + share, "frequency": 0.7 + 0.1 * share}},
            "faults": [
                {"channel": "force", "shape": "step", "onset": 0.5 + 0.05 * i, "size": 0.5 + share},
                {"channel": "bias", "shape": "ramp", "onset": 1.0, "size": 0.1 * share, "duration": 0.5},
            ],
            "observers": [adaptive(**{"rho": 3 + share, "lambda": 1 + share}) | {"initial": {"x1": share, "x2": 0.0}}],
        }
        | changes
    )


@pytest.mark.parametrize("runs", [1, 2, 8, 16, 19, 33])
def test_runs_that_differ_in_their_seed(runs: int):
    """Also if their number is not a multiple of the lanes."""
    base = engine(**SHORT)
    experiments = [with_seed(base, i) for i in range(runs)]
    agree(experiments)
    if runs > 1:
        last = run_batch(experiments).observers[0][:, -1]
        assert len(np.unique(last, axis=0)) == runs


def test_runs_in_which_everything_differs():
    """Seed, parameters, gains, initial states, a staged input, sizes and onset times."""
    agree([various(i) for i in range(11)])


def test_faults_of_all_kinds_that_differ():
    """Held ones (steps, pulse trains, random walks) and others, each with its own size and time."""
    shapes = [
        {"shape": "step", "size": 1.0},
        {"shape": "pulse-train", "size": 1.0, "period": 0.3, "width": 0.1},
        {"shape": "random-walk", "intensity": 0.5, "sample_time": 0.05},
    ]
    agree(
        [various(i, faults=[s | {"channel": "force", "onset": 0.1 * i, "end": 1.5} for s in shapes]) for i in range(9)]
    )


def test_steps_divided_at_different_times():
    """Onsets inside steps, at different times: only a run's own steps are divided, as in the run alone."""
    onsets = [0.5, 0.5012, 0.7777, 0.5012, 1.0]
    agree(
        [
            various(i, faults=[{"channel": "force", "shape": "step", "onset": t, "size": 1.0}])
            for i, t in enumerate(onsets)
        ]
    )


def test_steps_divided_at_the_same_times():
    """A sample time of the noise that is not a multiple of the step divides the steps of all runs; each has its own
    std."""
    agree([various(i, noise={"y": {"std": 0.01 * (i + 1), "sample_time": 0.0123}}) for i in range(18)])


def test_noise_of_different_sample_times():
    """Each run keeps its own sample time."""
    agree([various(i, noise={"y": {"std": 0.1, "sample_time": 0.01 * (i % 3 + 1)}}) for i in range(6)])


def test_several_observers_of_different_kinds():
    """The second and the third use the same plant and the same noise."""
    watchers = [adaptive(), HIGH_GAIN, adaptive("both", channels="force,bias")]
    agree([with_seed(engine(**SHORT, observers=watchers), i) for i in range(10)])


@pytest.mark.parametrize(
    "change",
    [
        {"faults": [{"output": "y", "shape": "freeze", "onset": 0.5, "end": 1.0}]},
        {"faults": [{"output": "y", "shape": "dropout", "onset": 0.5, "probability": 0.5, "sample_time": 0.05}]},
        {"measurement": {"mode": "sampled", "period": 0.05}},
        {"observers": [{"label": "ekf", "kind": "joint-ekf", "options": {"channels": "force", "period": 0.05}}]},
        {"observers": []},
    ],
    ids=["freeze", "dropout", "sampled", "sampled observer", "no observer"],
)
def test_runs_that_do_not_fit_into_lanes(change: dict):
    """Measurement faults with memory, sampled measurement and observers at a sample period run one by one."""
    agree([with_seed(engine(**SHORT | {"horizon": 1.0} | change), i) for i in range(3)])


def test_additive_measurement_faults_runin_lanes():
    """Outliers and noise bursts are additional noise."""
    faults = [
        {"output": "y", "shape": "outliers", "onset": 0.5, "probability": 0.3, "size": 0.2, "sample_time": 0.02},
        {"output": "y", "shape": "noise-burst", "onset": 1.0, "end": 1.5, "std": 0.3, "sample_time": 0.03},
    ]
    agree([with_seed(engine(**SHORT, faults=faults), i) for i in range(9)])


def test_a_plant_without_noise_whose_gains_differ():
    """All runs share the plant; an observer's gain is its own."""
    agree([engine(**SHORT, noise={}, observers=[adaptive(rho=3 + 0.1 * i)]) for i in range(9)])


def test_runs_that_do_not_differ_at_all():
    """Equal specs give equal rows."""
    agree([engine(**SHORT) for _ in range(3)])


def test_discrete_time():
    """A discrete plant with an observer in its own time (zhou-tan-2012), from different initial states, in lanes."""
    spec = library.experiment("zhou-tan-2012").model_dump() | {"horizon": 2.0, "evaluate": None}
    state = library.plant(spec["plant"]).states[0].name
    experiments = [
        prepare(library.resolve(Spec.model_validate(spec | {"initial": {state: 0.1 * i}}))).engine for i in range(5)
    ]
    assert all(batch.in_lanes(e) for e in experiments) and experiments[0].plant.time == "discrete"
    agree(experiments)


def test_chunks_change_no_number(monkeypatch):
    """Neither does the number of base steps per call."""
    experiments = [various(i) for i in range(5)]
    whole = run_batch(experiments)
    monkeypatch.setattr(batch, "FEWEST", 37)
    monkeypatch.setattr(batch, "MOST", 37)
    pieces = run_batch(experiments)
    np.testing.assert_array_equal(pieces.plant, whole.plant)
    np.testing.assert_array_equal(pieces.observers[0], whole.observers[0])


def test_given_substeps_are_used():
    """A batch uses the substeps of its experiments."""
    agree([replace(various(i), substeps=3) for i in range(4)])
    fine, coarse = (run_batch([replace(various(i), substeps=n) for i in range(2)]).plant for n in (3, None))
    assert 0 < np.abs(fine - coarse).max() < 1e-6


def test_a_diverging_run_does_not_affect_the_others():
    """Γ of one run grows without bound; its neighbours in the vector have the numbers that they have alone."""
    unexcited = oscillator(channels=[{"name": "force", "kind": "actuator", "enters": {"x2": "0*x1"}}])
    change = SHORT | {"horizon": 10.0, "plant": unexcited, "faults": []}
    experiments = [engine(**change, observers=[adaptive(**{"lambda": g})]) for g in (0.0, 100.0, 0.0)]
    agree(experiments)
    finite = np.isfinite(run_batch(experiments).observers[0]).all(axis=(1, 2))
    assert finite.tolist() == [True, False, True]


def test_experiments_of_different_shape_are_refused():
    """Another step, horizon, record, plant or observer cannot be in one batch."""
    base = engine(**SHORT)
    for other in (
        engine(**SHORT | {"horizon": 3.0}),
        engine(**SHORT | {"evaluate": 0.1}),
        engine(**SHORT, step=0.01),
        engine(**SHORT, observers=[HIGH_GAIN]),
        engine(**SHORT, observers=[]),
    ):
        with pytest.raises(ValueError, match="same programs, step, horizon and record"):
            run_batch([base, other])


@pytest.mark.parametrize(
    "change", [{}, {"measurement": {"mode": "sampled", "period": 0.05}}], ids=["lanes", "one by one"]
)
def test_a_batch_can_be_stopped(change: dict):
    """Cancelled is raised at the next check, and checks are frequent."""
    experiments = [with_seed(engine(**{"horizon": 100.0, "evaluate": 1.0} | change), i) for i in range(3)]
    looks = []

    def cancelled() -> bool:
        looks.append(0)
        return len(looks) == 2

    with pytest.raises(Cancelled):
        run_batch(experiments, cancelled)
    assert len(looks) == 2
