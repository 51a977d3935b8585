"""The information of a window about the faults, in numbers and in words."""

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from thetascope.diagnosis.input_design.excitation import band, excitation

PAIR = np.outer([1, -0.7], [1, -0.7]) * 1e8


def block(*parts: np.ndarray) -> np.ndarray:
    """Return a matrix of blocks along its diagonal."""
    size = sum(len(p) for p in parts)
    whole, at = np.zeros((size, size)), 0
    for p in parts:
        whole[at : at + len(p), at : at + len(p)] = p
        at += len(p)
    return whole


def test_two_confounded_faults_are_named_with_their_visible_combination():
    """If only θ1 − 0.7 θ2 is known, neither is identifiable, and their combination is given."""
    found = excitation(PAIR, ["theta1", "theta2"], [0.01, 0.015], 0.1)
    apart = "theta1 and theta2 cannot be distinguished with this input"
    assert str(found.text) == f"{apart}: only their combination theta1 − 0.7 theta2 is visible"
    assert found.level == 0.0
    assert found.needed == pytest.approx(100)
    assert found.identifiable == {"theta1": False, "theta2": False}
    # in typical faults: 0.01 θ1 = 0.7 · 0.015 θ2 shows nothing
    assert found.direction["theta2"] / found.direction["theta1"] == pytest.approx(0.01 / (0.7 * 0.015))
    assert found.deviations == {"theta1": np.inf, "theta2": np.inf}


def test_a_fault_without_excitation_is_named():
    """The fault of a pump at rest is not visible, the other one is."""
    found = excitation(np.diag([1e4, 0.0]), ["pump1", "pump2"], [0.1, 0.1], 0.1)
    assert str(found.text) == "pump2 is not excited at all: its fault would not show in any output now"
    assert found.identifiable == {"pump1": True, "pump2": False}
    assert found.direction == {"pump2": 1.0}
    both = excitation(np.zeros((2, 2)), ["pump1", "pump2"], [0.1, 0.1], 0.1)
    assert str(both.text) == "pump1 and pump2 are not excited at all: their faults would not show in any output now"


def test_the_level_is_compared_with_the_requirement():
    """√λmin in typical faults: 12 is enough if 10 are required, 3 is not."""
    enough = excitation(np.diag([1.44e4, 1e6]), ["a", "b"], [0.1, 0.1], 0.1)
    assert str(enough.text) == "all faults can be distinguished: the least visible combination is 12 times the noise"
    assert enough.level == pytest.approx(144)
    assert not enough.groups
    little = excitation(np.diag([900, 1e6]), ["a", "b"], [0.1, 0.1], 0.1)
    assert str(little.text) == "a is hardly visible now: a typical fault is 3 times the noise, 10 times are required"
    assert little.identifiable == {"a": False, "b": True}


def test_several_groups_are_separate():
    """A pair with one visible combination, a triple with two, and a visible fault each have a sentence."""
    a, b = np.array([1.0, 1.0, 1.0]), np.array([1.0, -1.0, 0.0])
    J = block(PAIR, 1e6 * (np.outer(a, a) + np.outer(b, b)), np.diag([1e6]))
    found = excitation(J, list("abcdef"), [0.01, 0.015, 1, 1, 1, 1], 0.1)
    assert found.groups == (("a", "b"), ("c", "d", "e"))
    assert str(found.text) == (
        "a and b cannot be distinguished with this input: only their combination a − 0.7 b is visible; "
        "c, d and e cannot be distinguished with this input: only 2 combinations of them are visible"
    )
    assert found.identifiable["f"]


@given(st.lists(st.floats(0, 1e6), min_size=3, max_size=3), st.integers(0, 2**31), st.floats(0.02, 0.5))
def test_an_identifiable_fault_has_the_required_accuracy(values, seed, accuracy):
    """The deviations are those of J⁻¹; at a sufficient level every fault is identifiable."""
    rng = np.random.default_rng(seed)
    Q, typical = np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.uniform(0.1, 10, 3)
    N = Q @ np.diag(np.array(values) + 1e-3) @ Q.T
    found = excitation(N / np.outer(typical, typical), list("abc"), typical, accuracy)
    true = np.sqrt(np.diag(np.linalg.inv(N)))
    assert np.array(list(found.deviations.values())) == pytest.approx(true * typical, rel=1e-4)
    if found.level > found.needed * (1 + 1e-6):
        assert all(found.identifiable.values())
        assert not found.groups
    for group in found.groups:
        assert not any(found.identifiable[c] for c in group)


def test_the_order_of_channels_changes_no_finding():
    """Groups and identifiable channels do not depend on the numbering."""
    J, typical = block(PAIR, np.diag([50.0, 1e5])), np.array([0.01, 0.015, 1, 1])
    order = [3, 1, 2, 0]
    one = excitation(J, list("abcd"), typical, 0.1)
    other = excitation(J[np.ix_(order, order)], [list("abcd")[i] for i in order], typical[order], 0.1)
    assert one.identifiable == other.identifiable
    assert {frozenset(g) for g in one.groups} == {frozenset(g) for g in other.groups}
    assert one.level == other.level


def test_without_data_there_is_no_level():
    """No channels, or sums that are not finite, have no level."""
    assert str(excitation(np.zeros((0, 0)), [], [], 0.1).text) == "the plant has no fault channels"
    assert excitation(np.array([[np.nan]]), ["a"], [1.0], 0.1).level is None


def test_the_band_widens_to_the_prior():
    """Without excitation the band is as wide as a typical fault, along the confounded direction only."""
    wide = band(np.stack([PAIR, np.zeros((2, 2)), np.diag([1e8, 1e8])]), [0.01, 0.015])
    assert wide[1] == pytest.approx([0.01, 0.015])
    assert wide[2] == pytest.approx([1e-4, 1e-4], rel=1e-3)
    assert (wide[0] > 0.6 * np.array([0.01, 0.015])).all()
    assert (wide[0] < [0.01, 0.015]).all()


@pytest.mark.parametrize(
    "J",
    [
        [[400, 0, 0], [0, 400, 0], [0, 0, 400]],
        [[0, 0, 0], [0, 400, 0], [0, 0, 400]],
        [[200, 200, 0], [200, 200, 0], [0, 0, 400]],
        [[20, 0, 0], [0, 400, 0], [0, 0, 400]],
        [[210, 200, 0], [200, 210, 0], [0, 0, 400]],
        [[1, 1, 1], [1, 1, 1], [1, 1, 1]],
        [[20, 0, 0], [0, 20, 0], [0, 0, 20]],
    ],
)
def test_the_excitation_is_worded_in_chinese(J):
    """The Chinese sentence has the numbers of the English one and no English word."""
    text = excitation(np.array(J, dtype=float), ["theta1", "theta2", "theta3"], [1.0, 1.0, 1.0], 0.1).text
    chinese, number = text.text("zh"), re.compile(r"\d+\.?\d*")
    assert re.findall(r"(?<![a-z])(?!theta)[a-z]{3,}", chinese) == []
    assert sorted(number.findall(chinese)) == sorted(number.findall(str(text)))
