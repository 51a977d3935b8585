"""Challenges: drawn by a key, with truths that independent simulations and fits confirm."""

from collections import Counter

import pytest

from benchmarks.mysteries import hardest, perfect, separation
from thetascope import library
from thetascope.challenge import challenge, detector_answer, draw, grade, mystery_of

CHECKED = ["mystery:9", "mystery:11", "mystery:5"]  # two that look alike; one told after a while; one of a sensor


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
    for channel, alike in hardest(found):
        assert (separation(found, channel) < 5.0) == alike, channel


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
