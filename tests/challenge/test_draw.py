"""Challenges: drawn by a key, with truths that independent simulations and fits confirm."""

from collections import Counter

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from thetascope import library
from thetascope.assembly import prepare
from thetascope.challenge import Challenge, challenge, detector_answer, draw, experiment_of, grade, mystery_of
from thetascope.challenge.experiments import setup_plant, sizes_of
from thetascope_schemas.service.learning.challenge import ChallengeAnswer, HiddenFault

CHECKED = ["mystery:9", "mystery:11", "mystery:5"]  # two that look alike; one told after a while; one of a sensor


def perfect(found: Challenge) -> ChallengeAnswer:
    """Return the answer that earns all points."""
    truth = found.truth
    if truth.fault is None:
        return ChallengeAnswer(verdict="none", at=truth.end)
    left = truth.alike(truth.end)
    at = truth.told_from()
    if len(left) > 1:
        return ChallengeAnswer(verdict="cannot-be-told", alike=tuple(sorted(left)), at=at)
    fault = truth.fault
    return ChallengeAnswer(verdict="channel", channel=fault.channel, onset=fault.onset, size=fault.size, at=at)


def test_a_key_draws_the_same_and_another_something_else():
    """Challenges are a function of the key; set-ups, channels and courses vary over keys."""
    assert draw("a") == draw("a")
    drawn = [draw(f"key {k}") for k in range(60)]
    assert {d.setup.id for d in drawn} == set(library.mysteries())
    faults = Counter(d.fault.channel if d.fault else "" for d in drawn)
    assert faults[""] >= 2 and len(faults) >= 12
    onsets = [d.fault.onset / d.setup.horizon for d in drawn if d.fault]
    assert 0.2 <= min(onsets) < 0.3 and 0.5 < max(onsets) <= 0.6
    assert draw("a", setup="two-tanks").setup.id == "two-tanks"


@pytest.mark.parametrize("key", CHECKED)
def test_a_perfect_answer_earns_everything(key: str):
    """Who names what could be told when it could be told, or what cannot be told, earns 100."""
    found = challenge(key)
    assert grade(perfect(found), found.truth).total == 100


def test_the_detector_is_graded_on_the_same_scale():
    """The detector names a leak, its size and nobody else."""
    found = challenge("mystery:11")
    answer = detector_answer(found.drawn)
    assert answer is not None and answer.channel == found.drawn.fault.channel
    assert grade(answer, found.truth).total >= 90


@pytest.mark.parametrize("key", CHECKED)
def test_an_independent_fit_confirms_what_could_be_told(key: str):
    """Runs of the whole experiment, fitted by another search, leave the same rivals at the end of the record."""
    found = challenge(key)
    rivals = sorted((r for r in found.truth.rivals if r.channel), key=lambda r: np.inf if r.until is None else r.until)
    for rival in rivals[-2:]:  # the hardest to exclude
        assert (separation(found, rival.channel) < 5.0) == (rival.until is None), rival


def separation(found: Challenge, channel: str) -> float:
    """Return how many deviations separate a rival from the truth at the end, by a search over runs without noise."""
    drawn = found.drawn
    plant = setup_plant(drawn.setup.id)
    target = outputs(found, drawn.fault)
    suspect = next(s for s in drawn.setup.suspects if s.channel == channel)
    best = np.inf
    for duration in (None, drawn.setup.ramp):
        for row in offsets(drawn.fault.onset, drawn.setup.record, drawn.setup.horizon):
            for end in (e for e in sizes_of(plant, suspect) if e):

                def distance(size: float, row=row, duration=duration) -> float:
                    shape = "ramp" if duration else "step"
                    onset = round(row * drawn.setup.record, 9)
                    rival = HiddenFault(channel=channel, shape=shape, onset=onset, size=size, duration=duration)
                    return float(np.sqrt(((outputs(found, rival) - target) ** 2).sum()))

                fit = minimize_scalar(distance, bounds=sorted((0.0, end)), method="bounded", options={"maxiter": 12})
                best = min(best, fit.fun)
    return best


def offsets(onset: float, record: float, horizon: float) -> list[int]:
    true = round(onset / record)
    return [k for k in (true + d for d in (-12, -3, 0, 3)) if 0 <= k < horizon / record]


def outputs(found: Challenge, fault: HiddenFault | None) -> np.ndarray:
    """Return the readings without noise in deviations of the noise, from a run of the whole experiment."""
    setup = found.drawn.setup
    spec = experiment_of(setup, found.drawn.program, fault, 0).model_copy(update={"noise": {}})
    result = prepare(spec).run()
    return np.stack([result.column(f"y.{y.name}") / setup.noise[y.name].std for y in spec.plant.outputs], axis=1)


def test_what_is_shown_does_not_contain_the_truth():
    """Columns are those of measurements, inputs and observers; neither true states nor θ are among them."""
    drawn = draw("mystery:11")
    shown = mystery_of(drawn, "11")
    names = {c.name for c in shown.columns}
    assert not any(name.startswith(("x.", "theta.")) for name in names)
    other = mystery_of(type(drawn)(drawn.setup, drawn.program, None, drawn.seed), "11")
    assert [c.name for c in other.columns] == [c.name for c in shown.columns]
    plain = {"columns"}
    assert shown.model_dump(exclude=plain) == other.model_dump(exclude=plain)
    before = round(drawn.fault.onset / drawn.setup.record)
    assert [c.values[:before] for c in other.columns] == [c.values[:before] for c in shown.columns]
