"""Points of an answer: 40 for the name, 20 for the size, 20 for how soon, 20 for accusing nobody wrongly.

What counts is what could be told. How soon counts from the moment from which it could be told; before it a right name
is luck. Where some explanations look alike until the end, the right answer is that it cannot be told, and which they
are; then the name earns its points together with the size, which nobody can know either.
"""

from dataclasses import dataclass
from typing import Literal

from thetascope.messages import Message
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.service.learning.challenge import NO_FAULT, ChallengeAnswer, ChallengeTruth, Points, Score

NAME, SIZE, SOON, ACCUSED = 40, 20, 20, 20
_PARTS: tuple[tuple[Literal["name", "size", "soon", "accused"], int], ...] = (
    ("name", NAME),
    ("size", SIZE),
    ("soon", SOON),
    ("accused", ACCUSED),
)
_FREE, _WORTHLESS = 0.05, 0.30  # relative errors of a size up to which it earns all, and from which nothing
_ALLOWED = 2.0  # standard deviations of a size by which it may be wrong because of the noise
_PATIENCE = 0.25  # share of the record after which nothing is left for being soon
_EACH = 10  # points that a wrong accusation costs


@dataclass(frozen=True)
class _Name:
    """The share of the name's points that an answer earns, its reason, and whether it was a lucky guess."""

    share: float
    why: Message
    lucky: bool = False


def grade(answer: ChallengeAnswer | None, truth: ChallengeTruth, until: float | None = None) -> Score:
    """Return the points of an answer.

    `until`: the time in s of the record up to which one could have waited, by default its end; what cannot be told
    until then cannot be told. An answer of None earns nothing.
    """
    if answer is None:
        nothing = Message("challenge.none-given")
        return _score((0, nothing), (0, nothing), (0, nothing), (0, nothing))
    last = truth.end if until is None else min(until, truth.end)
    at = last if answer.verdict == "none" else min(answer.at, last)
    name = _name(answer, truth, at, last)
    size = _size(answer, truth, name, at)
    soon = _soon(answer, truth, name, at, last)
    return _score((round(NAME * name.share), name.why), size, soon, _accused(answer, truth, name, last))


def _score(*parts: tuple[int, Message]) -> Score:
    points = tuple(
        Points(of=of, points=earned, most=most, why=Text.of(why))
        for (of, most), (earned, why) in zip(_PARTS, parts, strict=True)
    )
    return Score(total=sum(p.points for p in points), points=points)


def _name(answer: ChallengeAnswer, truth: ChallengeTruth, at: float, last: float) -> _Name:
    right = truth.fault.channel if truth.fault else NO_FAULT
    alike, named = truth.alike(last), answer.named
    if answer.verdict == "cannot-be-told":
        return _cannot(named, right, truth, at, last)
    if named != {right}:
        missed = answer.verdict == "none"
        return _Name(0.0, Message("challenge.name.missed") if missed else Message("challenge.name.wrong"))
    if truth.fault is not None and at < truth.fault.onset:
        return _Name(0.0, Message("challenge.name.before"))
    if len(alike) > 1:
        return _Name(0.5, Message("challenge.name.lucky"), lucky=True)
    return _Name(1.0, Message("challenge.name.right"))


def _cannot(named: frozenset[str], right: str, truth: ChallengeTruth, at: float, last: float) -> _Name:
    if right not in named or NO_FAULT in truth.alike(at, fair=True):  # nothing could be seen yet
        return _Name(0.0, Message("challenge.name.not-alike"))
    final, then = truth.alike(last) - {NO_FAULT}, truth.alike(at) - {NO_FAULT}
    shares = [_overlap(named, final) if len(final) > 1 else 0.0, 0.5 * _overlap(named, then) if len(then) > 1 else 0.0]
    share = max(shares)
    if share == 1.0:
        return _Name(1.0, Message("challenge.name.alike"))
    if len(final) > 1:
        return _Name(share, Message("challenge.name.partly"))
    return _Name(share, Message("challenge.name.later", t=truth.told_from(last)))


def _overlap(a: frozenset[str], b: frozenset[str]) -> float:
    return len(a & b) / len(a | b)


def _size(answer: ChallengeAnswer, truth: ChallengeTruth, name: _Name, at: float) -> tuple[int, Message]:
    if name.share == 0:
        return 0, Message("challenge.size.no-name")
    if truth.fault is None:
        return SIZE, Message("challenge.size.none")
    if answer.channel is None:
        return round(SIZE * name.share), Message("challenge.size.alike")
    if answer.size is None:
        return 0, Message("challenge.size.not-given")
    error = abs(answer.size - truth.fault.size) / abs(truth.fault.size)
    free = max(_FREE, _ALLOWED / max(truth.deviations(at), 1.0))
    earned = SIZE * min(1.0, max(0.0, (_WORTHLESS - error) / (_WORTHLESS - free))) if free < _WORTHLESS else SIZE
    share = 1.0 if not name.lucky else 0.5
    return round(earned * share), Message("challenge.size.off", share=round(100 * error))


def _soon(answer: ChallengeAnswer, truth: ChallengeTruth, name: _Name, at: float, last: float) -> tuple[int, Message]:
    if name.share == 0:
        return 0, Message("challenge.soon.no-name")
    if truth.fault is None:
        return SOON, Message("challenge.soon.none")
    if name.lucky or name.share < 1:
        return 0, Message("challenge.soon.guess")
    told = truth.told_from(last)
    if at < truth.told_from(last, fair=True):
        return 0, Message("challenge.soon.before", t=told)
    late = max(0.0, at - told)
    earned = round(SOON * max(0.0, 1 - late / (_PATIENCE * truth.end)))
    return earned, Message("challenge.soon.late", seconds=late) if late else Message("challenge.soon.first")


def _accused(answer: ChallengeAnswer, truth: ChallengeTruth, name: _Name, last: float) -> tuple[int, Message]:
    if name.share == 0:
        return 0, Message("challenge.accused.no-name")
    right = truth.fault.channel if truth.fault else NO_FAULT
    alike = truth.alike(last)
    onset = truth.fault.onset if truth.fault else truth.end
    wrong = [one.channel for one in answer.accused if one.at < onset or one.channel not in {right, *alike}]
    if answer.verdict == "cannot-be-told":
        wrong += sorted(answer.named - truth.alike(min(answer.at, last)))
    if not wrong:
        return ACCUSED, Message("challenge.accused.nobody")
    return max(0, ACCUSED - _EACH * len(wrong)), Message("challenge.accused.wrongly", n=len(wrong))
