"""The outcome of an answer, after the reveal: graded against the truth and against what could be told of it."""

from typing import TYPE_CHECKING

from thetascope.challenge.experiments import setup_plant, sizes_of
from thetascope.challenge.grade import grade
from thetascope.classroom.faults.own_round import OwnRound
from thetascope_schemas.service.classroom.requests import Caption, CurveLine
from thetascope_schemas.service.classroom.views import CurvePanel, Outcome, RoundView
from thetascope_schemas.service.learning.challenge import NO_FAULT
from thetascope_schemas.service.learning.mystery import MysteryChoice, MysterySetup
from thetascope_schemas.service.learning.questions import Words

if TYPE_CHECKING:
    from thetascope.classroom.faults.challenge_jobs import Material


def outcome_of(round: OwnRound, student: str) -> Outcome | None:
    """Return the outcome of a student's answer; None before the reveal, and while the truth is being examined."""
    seat = round.seats.get(student)
    material = None if seat is None or not round.revealed else round.materials.get(seat.place)
    return None if material is None else _outcome(round, student, material)


def _outcome(round: OwnRound, student: str, material: "Material") -> Outcome:
    truth, answer = material.truth, round.answers.get(student)
    fault, end = truth.fault, round.setup.horizon
    score, detector = grade(answer, truth), grade(material.detector, truth)
    alike = truth.alike(end)
    return Outcome(
        right=None if answer is None else score.points[0].points == score.points[0].most,
        points=None if answer is None else score.total,
        fault=fault,
        after=None if answer is None or fault is None else round_to(answer.at - fault.onset),
        told=None if fault is None or len(alike) > 1 else truth.told_from(),
        alike=tuple(sorted(alike - {NO_FAULT})) if len(alike) > 1 else (),
        detector=material.detector,
        detector_points=detector.total,
    )


def round_to(seconds: float) -> float:
    """Return a time to the hundredth of a second."""
    return float(f"{seconds:.2f}")


def rank_of(round: OwnRound, student: str) -> int | None:
    """Return a student's place among the right answers by the time after the fault began; None: it was not right."""
    outcomes = {id: outcome_of(round, id) for id in round.answers}
    times = sorted(o.after for o in outcomes.values() if o is not None and o.right and o.after is not None)
    mine = outcomes.get(student)
    return None if mine is None or not mine.right or mine.after is None else 1 + times.index(mine.after)


def choices_of(setup: MysterySetup) -> tuple[MysteryChoice, ...]:
    """Return the faults among which students choose."""
    plant = setup_plant(setup.id)
    channels = {channel.name: channel for channel in plant.channels}
    choices = []
    for suspect in setup.suspects:
        channel = channels[suspect.channel]
        low, high = sizes_of(plant, suspect)
        words = Words(**both(channel.title or channel.name))
        choices.append(MysteryChoice(channel=channel.name, title=words, unit=channel.unit, low=low, high=high))
    return tuple(choices)


def panels_of(setup: MysterySetup) -> tuple[CurvePanel, ...]:
    """Return a strip for each output."""
    return tuple(
        CurvePanel(
            symbol=output.name,
            title=Caption(**both(output.description or "")),
            unit=output.unit,
            line=CurveLine(column=f"residual.{output.name}"),
        )
        for output in setup_plant(setup.id).outputs
    )


def both(text: str) -> dict[str, str]:
    """Return prose in both languages of the page."""
    texts = getattr(text, "texts", {})
    return {language: texts.get(language, str(text)) for language in ("en", "zh")}


def own_view(round: OwnRound, now: float) -> RoundView:
    """Return the round as everybody sees it: the plant and its suspects, and the time that is left."""
    left = round.left(now)
    return RoundView(
        number=round.number,
        kind="own",
        lead=None,
        revealed=round.revealed,
        left=None if left is None else round_to(left),
        title=round.setup.title,
        choices=choices_of(round.setup),
        horizon=round.setup.horizon,
    )
