"""A mystery: the question of a seed as the page gets it, and its solution after an answer."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from thetascope.assembly import prepare
from thetascope.challenge.detector_answer import detector_answer
from thetascope.challenge.draw import Drawn, draw
from thetascope.challenge.experiments import experiment_of, hunter_label, setup_plant, sizes_of
from thetascope.challenge.grade import grade
from thetascope.challenge.signatures import signatures_of
from thetascope.challenge.told import truth_of
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import Result
from thetascope.messages import Message
from thetascope_schemas import Experiment
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.learning.challenge import ChallengeAnswer, ChallengeTruth
from thetascope_schemas.service.learning.mystery import (
    Mystery,
    MysteryChoice,
    MysteryColumn,
    MysterySetup,
    MysterySolution,
)
from thetascope_schemas.service.learning.questions import Words

_DIGITS = 6  # that are sent of a value


@dataclass(frozen=True)
class Challenge:
    """A drawn challenge with its truth."""

    drawn: Drawn
    truth: ChallengeTruth


@lru_cache(maxsize=256)
def challenge(key: str, setup: str | None = None) -> Challenge:
    """Return the challenge of a key with its truth. Takes about a second of processor time, once."""
    drawn = draw(key, setup)
    return Challenge(drawn, truth_of(drawn.setup.id, drawn.program, drawn.fault))


def mystery_of(drawn: Drawn, name: str) -> Mystery:
    """Return what may be seen of a challenge before it is answered; `name`: the name by which it is asked for."""
    setup, plant = drawn.setup, setup_plant(drawn.setup.id)
    result = prepare(experiment_of(setup, drawn.program, drawn.fault, drawn.seed, observers=True)).run()
    choices = []
    for suspect in setup.suspects:
        channel = next(c for c in plant.channels if c.name == suspect.channel)
        low, high = sizes_of(plant, suspect)
        choices.append(
            MysteryChoice(channel=channel.name, title=_words(channel.title), unit=channel.unit, low=low, high=high)
        )
    return Mystery(
        seed=name,
        setup=setup.id,
        title=setup.title,
        plant=_words(plant.title),
        end=setup.horizon,
        record=setup.record,
        ramp=setup.ramp,
        choices=tuple(choices),
        columns=tuple(_columns(drawn, plant, result)),
    )


def mystery_by(seed: str, setup: str | None) -> Mystery:
    """Return the mystery of a seed; `setup`: its set-up, if it is not drawn, too."""
    return mystery_of(draw(_key(seed), setup), seed)


def solution_by(seed: str, setup: str | None, answer: ChallengeAnswer) -> MysterySolution:
    """Return the solution of the mystery of a seed. Raises SpecError for an answer with other channels than it has."""
    return solution_of(_key(seed), answer, setup)


def _key(seed: str) -> str:
    return f"mystery:{seed}"


def _columns(drawn: Drawn, plant: Plant, result: Result) -> list[MysteryColumn]:
    """Return u, y, what is measured minus predicted, and the same and θ̂ of the observer for each suspect."""
    columns = []
    signatures = signatures_of(drawn.setup.id, drawn.program)
    predicted = signatures.outputs_with([None])[0] * signatures.deviations

    def add(name: str, of: str, subject: str, observer: str, unit: str, values: np.ndarray) -> None:
        columns.append(
            MysteryColumn(name=name, of=of, subject=subject, observer=observer, unit=unit, values=_rounded(values))
        )

    for u in plant.inputs:
        add(f"u.{u.name}", "u", u.name, "", u.unit, result.column(f"u.{u.name}"))
    for i, y in enumerate(plant.outputs):
        measured = result.column(f"y.{y.name}")
        add(f"y.{y.name}", "y", y.name, "", y.unit, measured)
        add(f"residual.{y.name}", "residual", y.name, "", y.unit, measured - predicted[:, i])
    for channel in plant.channels:
        label = hunter_label(channel.name)
        theta = result.column(f"{label}.theta.{channel.name}")
        add(f"{label}.theta", "theta", channel.name, channel.name, channel.unit, theta)
        for y in plant.outputs:
            left = result.column(f"y.{y.name}") - result.column(f"{label}.y.{y.name}")
            add(f"{label}.residual.{y.name}", "residual", y.name, channel.name, y.unit, left)
    return columns


def compile_setup(setup: MysterySetup) -> None:
    """Compile what the mysteries of a set-up share, and find the detector's thresholds: seconds, the first time."""
    for program in range(len(setup.inputs)):
        prepare(experiment_of(setup, program, None, 0, observers=True, diagnosis=True)).run()
        signatures_of(setup.id, program).outputs_with([None])


def solution_of(key: str, answer: ChallengeAnswer, setup: str | None = None) -> MysterySolution:
    """Return the truth of a key, the points of an answer, and what the detector said. Takes some seconds, once."""
    found = challenge(key, setup)
    drawn = found.drawn
    _check(answer, [suspect.channel for suspect in drawn.setup.suspects])
    detector = _detector(key, setup)
    spec = experiment_of(drawn.setup, drawn.program, drawn.fault, drawn.seed, observers=True, diagnosis=True)
    return MysterySolution(
        truth=found.truth,
        answer=answer,
        score=grade(answer, found.truth),
        detector=detector,
        detector_score=grade(detector, found.truth),
        experiment=Experiment.model_validate(spec.model_dump(mode="json", context={"language": "*"})),
    )


def _check(answer: ChallengeAnswer, known: list[str]) -> None:
    for name in (*answer.named, *(one.channel for one in answer.accused)):
        if name and name not in known:
            names = Message("suggest.all", names=known)
            raise SpecError("channel", name, Message("challenge.channel.unknown", name=name), names)


@lru_cache(maxsize=256)
def _detector(key: str, setup: str | None) -> ChallengeAnswer | None:
    return detector_answer(challenge(key, setup).drawn)


def _words(text: str) -> Words:
    texts = getattr(text, "texts", {})
    return Words(en=texts.get("en", str(text)), zh=texts.get("zh", str(text)))


def _rounded(values: np.ndarray) -> tuple[float | None, ...]:
    return tuple(float(f"{v:.{_DIGITS}g}") if np.isfinite(v) else None for v in values)
