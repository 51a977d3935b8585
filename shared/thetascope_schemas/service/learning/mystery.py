"""A mystery: a record with a hidden fault, or none. How it is drawn, what the page gets of it, and its solution."""

from typing import Self

from pydantic import Field, model_validator

from thetascope_schemas.experiment.base import Identifier, Instant, Number, Positive, Reference, Strict, example
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.measurement import Noise
from thetascope_schemas.experiment.signals import Signal
from thetascope_schemas.service.learning.challenge import ChallengeAnswer, ChallengeTruth, Score
from thetascope_schemas.service.learning.questions import Words
from thetascope_schemas.texts.refusal import refuse

MYSTERY_SEED = r"[a-z0-9]{1,16}"
"""Pattern of the seeds from which mysteries are drawn."""
_SUSPECT = {"channel": "leak1", "low": 0.05, "high": 0.15}
_CHOICE = {
    "channel": "leak1",
    "low": 0.0,
    "high": 0.225,
    "unit": "cm²",
    "title": {"en": "leak in tank 1", "zh": "泄漏"},
}
_COLUMN = {"name": "y.y1", "of": "y", "subject": "y1", "observer": "", "unit": "cm", "values": [40.0, 40.1]}


class Suspect(Strict):
    """A channel in which a fault may be hidden, and the sizes that are drawn."""

    model_config = example(**_SUSPECT)

    channel: Reference
    low: Positive = Field(description="Smallest size that is drawn, without sign, in the unit of the channel.")
    high: Positive = Field(description="Largest size that is drawn, without sign, in the unit of the channel.")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.low >= self.high:
            raise refuse("schema.bounds.not-increasing", "low", self.low, low=self.low, high=self.high)
        return self


class MysterySetup(Strict):
    """A plant and what may happen to it, a file of the library."""

    model_config = example(
        id="three-tanks",
        title={"en": "three tanks", "zh": "三容水箱"},
        plant="dts200",
        inputs=[{}],
        noise={"y1": {"std": 0.1, "sample_time": 4.0}},
        horizon=1200.0,
        step=1.0,
        record=4.0,
        ramp=120.0,
        suspects=[_SUSPECT, {"channel": "pump1", "low": 0.1, "high": 0.4}],
    )

    id: Identifier
    title: Words
    plant: Identifier
    inputs: tuple[dict[Reference, Signal], ...] = Field(min_length=1, max_length=8)
    noise: dict[Reference, Noise]
    horizon: Positive = Field(description="Length of a record in s.")
    step: Positive = Field(description="Base step in s.")
    record: Positive = Field(description="Time in s from row to row, and from sample to sample.")
    ramp: Positive = Field(description="Time in s that a gradual fault takes.")
    suspects: tuple[Suspect, ...] = Field(min_length=2, max_length=12)


class MysterySetupLine(Strict):
    """A set-up without what is drawn from it."""

    model_config = example(id="three-tanks", title={"en": "three tanks", "zh": "三容水箱"}, suspects=8)

    id: str
    title: Words
    suspects: int = Field(description="Number of channels in which a fault may be hidden.")


class MysterySetups(Strict):
    """The set-ups of mysteries, those with the fewest suspects first."""

    model_config = example(setups=[{"id": "two-tanks", "title": {"en": "two tanks", "zh": "上下水箱"}, "suspects": 3}])

    setups: tuple[MysterySetupLine, ...]


class MysteryChoice(Strict):
    """A channel among which one chooses, and the sizes that may be answered."""

    model_config = example(**_CHOICE)

    channel: str
    title: Words
    unit: str
    low: Number = Field(description="Smallest size in the unit of the channel.")
    high: Number = Field(description="Largest size in the unit of the channel.")


class MysteryColumn(Strict):
    """A column of the record: what is measured and commanded, or an observer's estimate."""

    model_config = example(**_COLUMN)

    name: str
    of: str = Field(description="u, y, residual (measured minus predicted), or theta.")
    subject: str = Field(description="The input, output or channel.")
    observer: str = Field(description="Channel that its observer suspects; empty: none, or no observer.")
    unit: str
    values: tuple[Number | None, ...] = Field(description="One value for each row in the unit of the column.")


class Mystery(Strict):
    """What the page gets: what was measured, and what may have happened. Nothing in it depends on the truth alone."""

    model_config = example(
        seed="k3f9",
        setup="three-tanks",
        title={"en": "three tanks", "zh": "三容水箱"},
        plant={"en": "Three-tank system DTS200", "zh": "三容水箱 DTS200"},
        end=1200.0,
        record=4.0,
        ramp=120.0,
        choices=[_CHOICE],
        columns=[_COLUMN],
    )

    seed: str
    setup: str
    title: Words
    plant: Words
    end: Instant = Field(description="Length of the record in s.")
    record: Positive = Field(description="Time in s from row to row.")
    ramp: Positive = Field(description="Time in s that a gradual fault takes.")
    choices: tuple[MysteryChoice, ...]
    columns: tuple[MysteryColumn, ...]


class MysterySolution(Strict):
    """The truth, the answer and the detector's, each with its points, and the experiment with everything in it."""

    model_config = example(
        truth={"fault": None, "end": 1200.0},
        answer={"verdict": "none", "at": 1200.0},
        score={"total": 100, "points": []},
        detector={"verdict": "none", "at": 1200.0},
        detector_score={"total": 100, "points": []},
        experiment={"id": "mystery", "title": "Mystery", "plant": "dts200", "horizon": 1200.0, "step": 1.0},
    )

    truth: ChallengeTruth
    answer: ChallengeAnswer
    score: Score
    detector: ChallengeAnswer | None = Field(description="Null: the detector named nothing that can be graded.")
    detector_score: Score
    experiment: Experiment
