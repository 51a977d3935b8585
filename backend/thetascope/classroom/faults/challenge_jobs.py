"""What a round of hidden faults computes, in worker processes: records, and the truth with what the detector says."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from thetascope.assembly import prepare
from thetascope.challenge.detector_answer import detector_answer
from thetascope.challenge.draw import draw
from thetascope.challenge.experiments import experiment_of, setup_plant
from thetascope.challenge.signatures import signatures_of
from thetascope.challenge.told import truth_of
from thetascope_schemas.service.learning.challenge import ChallengeAnswer, ChallengeTruth


@dataclass(frozen=True)
class ClassRecord:
    """What a student may see of a hidden fault: for each output what is measured minus what is predicted.

    `residuals` (outputs, rows) are float32, in the units of the outputs.
    """

    residuals: np.ndarray


@dataclass(frozen=True)
class Material:
    """What an answer is graded with: the truth, what could be told of it, and the detector's answer."""

    truth: ChallengeTruth
    detector: ChallengeAnswer | None


def record_of(key: str, setup: str) -> ClassRecord:
    """Return the record of a key. Takes a tenth of a second of processor time, seconds the first time."""
    drawn = draw(key, setup)
    result = prepare(experiment_of(drawn.setup, drawn.program, drawn.fault, drawn.seed)).run()
    signatures = signatures_of(setup, drawn.program)
    predicted = signatures.outputs_with([None])[0] * signatures.deviations
    outputs = setup_plant(setup).outputs
    measured = np.array([result.column(f"y.{output.name}") for output in outputs])
    return ClassRecord((measured - predicted.T).astype("<f4"))


def material_of(key: str, setup: str) -> Material:
    """Return what answers to a key are graded with. Takes some seconds of processor time."""
    drawn = draw(key, setup)
    return Material(truth_of(setup, drawn.program, drawn.fault), detector_answer(drawn))


def early_material_of(_report: Any, key: str, setup: str) -> Material:
    """Return the same, as a task that has time."""
    return material_of(key, setup)
