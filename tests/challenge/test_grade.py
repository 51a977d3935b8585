"""Points of answers: what is right, what is luck, and what waiting and accusing cost."""

import pytest

from thetascope.challenge import grade
from thetascope_schemas.service.learning.challenge import ChallengeAnswer, ChallengeTruth, HiddenFault, Rival

FAULT = HiddenFault(channel="leak", shape="step", onset=100.0, size=0.8)
TOLD = ChallengeTruth(
    fault=FAULT,
    end=400.0,
    rivals=(
        Rival(channel="", fair_until=104.0, until=108.0),
        Rival(channel="pump", fair_until=130.0, until=140.0),
        Rival(channel="bias", fair_until=100.0, until=100.0),
    ),
    seen=((0.0, 0.0), (108.0, 5.0), (140.0, 40.0), (400.0, 200.0)),
)
ALIKE = TOLD.model_copy(
    update={"rivals": (*TOLD.rivals[:1], Rival(channel="pump", fair_until=None, until=None), TOLD.rivals[2])}
)
COARSE = ALIKE.model_copy(update={"seen": ((0.0, 0.0), (400.0, 200.0))})
NOTHING = ChallengeTruth(fault=None, end=400.0)


def leak(at: float = 140.0, size: float = 0.8, **more: object) -> ChallengeAnswer:
    return ChallengeAnswer(verdict="channel", channel="leak", size=size, onset=100.0, at=at, **more)


def alike(*channels: str, at: float = 140.0) -> ChallengeAnswer:
    return ChallengeAnswer(verdict="cannot-be-told", alike=channels, at=at)


NONE = ChallengeAnswer(verdict="none", at=10.0)


@pytest.mark.parametrize(
    ("truth", "answer", "points"),
    [
        (TOLD, leak(), (40, 20, 20, 20)),
        (TOLD, leak(at=190.0), (40, 20, 10, 20)),
        (TOLD, leak(at=135.0), (40, 20, 20, 20)),
        (TOLD, leak(at=120.0), (40, 20, 0, 20)),
        (TOLD, leak(at=90.0), (0, 0, 0, 0)),
        (TOLD, leak(size=0.92), (40, 12, 20, 20)),
        (TOLD, leak(size=-0.8), (40, 0, 20, 20)),
        (TOLD, leak(accused=({"channel": "pump", "at": 120.0},)), (40, 20, 20, 10)),
        (TOLD, ChallengeAnswer(verdict="channel", channel="pump", size=0.8, at=140.0), (0, 0, 0, 0)),
        (TOLD, NONE, (0, 0, 0, 0)),
        (TOLD, alike("leak", "pump", at=135.0), (20, 10, 0, 20)),
        (TOLD, alike("leak", "pump", at=300.0), (0, 0, 0, 0)),
        (TOLD, alike("leak", "pump", "bias", at=10.0), (0, 0, 0, 0)),
        (TOLD, None, (0, 0, 0, 0)),
        (ALIKE, alike("leak", "pump"), (40, 20, 14, 20)),
        (COARSE, alike("leak", "pump", at=108.0), (40, 20, 20, 20)),
        (ALIKE, alike("pump", "bias"), (0, 0, 0, 0)),
        (ALIKE, leak(), (20, 10, 0, 20)),
        (NOTHING, NONE, (40, 20, 20, 20)),
        (NOTHING, leak(), (0, 0, 0, 0)),
    ],
)
def test_points_follow_what_could_be_told(truth: ChallengeTruth, answer: ChallengeAnswer, points: tuple):
    """Right and soon earns 100; luck, waiting, wrong sizes and accusations cost what they should."""
    score = grade(answer, truth)
    assert tuple(p.points for p in score.points) == points
    assert score.total == sum(points)
    assert all(p.why.text for p in score.points)


def test_what_could_not_be_told_until_a_round_ended_was_rightly_left_open():
    """A round that ends before the record is graded by what could be told in it."""
    assert grade(alike("leak", "pump", at=135.0), TOLD, until=138.0).total > 90
    assert grade(alike("leak", "pump", at=135.0), TOLD).total < 60
    assert grade(leak(at=139.0), TOLD, until=139.0).total < 60


def test_accusing_while_it_looks_alike_is_not_wrong():
    """A suspect that cannot be excluded until the end was not accused wrongly."""
    answer = leak(accused=({"channel": "pump", "at": 120.0},))
    assert grade(answer, ALIKE).points[3].points == 20


@pytest.mark.parametrize(
    "answer",
    [
        {"verdict": "channel", "at": 1.0},
        {"verdict": "none", "channel": "leak", "at": 1.0},
        {"verdict": "cannot-be-told", "alike": ["leak"], "at": 1.0},
        {"verdict": "cannot-be-told", "alike": ["leak", "leak"], "at": 1.0},
    ],
)
def test_an_incomplete_answer_is_refused(answer: dict):
    """A channel needs its name, and what cannot be told needs at least two."""
    with pytest.raises(ValueError, match=r"challenge\.answer"):
        ChallengeAnswer.model_validate(answer)
