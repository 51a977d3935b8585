"""Answers about studies: how far they are, and what is computed from their runs."""

from datetime import datetime
from typing import Literal

from pydantic import Field

from thetascope_schemas.experiment.base import Number, Strict, example
from thetascope_schemas.service.run import Problem

StudyStatus = Literal["running", "done", "cancelled", "failed"]
_STATE = {
    "id": "92671be42d2371653b585277a95f9289",
    "title": "Forgetting against noise",
    "experiment": "zhao-2012",
    "status": "running",
    "runs": 4800,
    "done": 3120,
    "points": 24,
    "created": "2026-12-01T12:00:00Z",
    "mine": True,
    "problem": None,
    "factors": ["observers.adaptive.gains.lambda", "noise.y.std"],
    "sizes": [],
    "measures": ["found.detector.theta3", "delay.detector.theta3"],
    "refused": 0,
    "links": {"self": "/api/studies/92671be42d2371653b585277a95f9289"},
}
_RATE = {"count": 19, "of": 20, "low": 0.751, "high": 0.9987}
_SPREAD = {"n": 20, "of": 20, "median": 0.62, "low": 0.53, "high": 0.98}


class StudyState(Strict):
    """A study: how far it is, and what its table holds."""

    model_config = example(**_STATE)

    id: str = Field(description="Hash of the spec: the same study has the same id.")
    title: str
    experiment: str = Field(description="Id of the experiment that it repeats.")
    status: StudyStatus
    runs: int = Field(description="Number of runs.")
    done: int = Field(description="Runs whose rows are kept.")
    points: int = Field(description="Number of points of the design.")
    created: datetime
    mine: bool = Field(description="Whether this client may cancel and remove it.")
    problem: Problem | None = Field(description="Why it failed.")
    factors: tuple[str, ...] = Field(description="Columns of what varies.")
    sizes: tuple[str, ...] = Field(description="Those of `factors` that are the size of a fault.")
    measures: tuple[str, ...] = Field(description="Columns of numbers that were measured, as far as they are known.")
    refused: int = Field(description="Runs of the kept ones that were refused; the table says why.")
    links: dict[str, str]


class StudyList(Strict):
    """The studies of a client, the newest first."""

    model_config = example(studies=[_STATE])

    studies: tuple[StudyState, ...]


class StudySize(Strict):
    """The size of a study before it is begun."""

    model_config = example(id=_STATE["id"], runs=4800, points=24, seeds=100, seconds=35.0)

    id: str = Field(description="The id that it will have.")
    runs: int = Field(description="Number of runs.")
    points: int = Field(description="Number of points of the design.")
    seeds: int = Field(description="Runs at each point, with as many seeds.")
    seconds: Number | None = Field(
        description="Seconds of one processor, by the time that the first runs take; null: they took too long to tell."
    )


class RateAnswer(Strict):
    """A share of runs with its exact 95 % interval."""

    model_config = example(**_RATE)

    count: int = Field(description="Runs that count.")
    of: int = Field(description="Runs that were counted.")
    low: Number = Field(description="Lower end of the interval, from 0 to 1.")
    high: Number = Field(description="Upper end of the interval, from 0 to 1.")


class SpreadAnswer(Strict):
    """A measure over some runs."""

    model_config = example(**_SPREAD)

    n: int = Field(description="Runs that have a value.")
    of: int = Field(description="Runs.")
    median: Number | None = Field(description="Its median, in the unit of the measure; null: no run has a value.")
    low: Number | None = Field(description="Lower end of the middle half of the runs.")
    high: Number | None = Field(description="Upper end of the middle half of the runs.")


class CurvePoint(Strict):
    """A measure at one value of a factor."""

    model_config = example(value=4.0, curve=None, spread=_SPREAD, rate=_RATE, run=400)

    value: Number | str = Field(description="The value of the factor.")
    curve: Number | str | None = Field(description="The value of the second factor, by which curves are told apart.")
    spread: SpreadAnswer
    rate: RateAnswer | None = Field(description="Of columns of 0 and 1: the share of ones.")
    run: int = Field(description="Number of the first run there.")


class Curves(Strict):
    """A measure against a factor."""

    model_config = example(points=[{"value": 4.0, "curve": None, "spread": _SPREAD, "rate": _RATE, "run": 400}])

    points: tuple[CurvePoint, ...]


class SizeAnswer(Strict):
    """Faults of one size."""

    model_config = example(size=0.02, found=_RATE, delay=_SPREAD, run=400)

    size: Number = Field(description="The size, in the channel's unit.")
    found: RateAnswer = Field(description="Runs in which the fault was found.")
    delay: SpreadAnswer = Field(description="Delay in s of the faults that were found.")
    run: int = Field(description="Number of the first run there.")


class ChannelSizes(Strict):
    """The faults of a channel by size."""

    model_config = example(
        channel="theta3", points=[{"size": 0.02, "found": _RATE, "delay": _SPREAD, "run": 400}], smallest=0.02
    )

    channel: str
    points: tuple[SizeAnswer, ...]
    smallest: Number | None = Field(
        description="The smallest size from which on the wanted share is found; null: there is none."
    )


class FoundBySize(Strict):
    """What is found of faults of each size, and how soon."""

    model_config = example(
        share=0.9,
        channels=[
            {
                "channel": "theta3",
                "points": [{"size": 0.02, "found": _RATE, "delay": _SPREAD, "run": 400}],
                "smallest": 0.02,
            }
        ],
    )

    share: Number = Field(description="The wanted share of faults that are found, from 0 to 1.")
    channels: tuple[ChannelSizes, ...]


class RocPointAnswer(Strict):
    """A point of the receiver operating characteristic."""

    model_config = example(value=0.01, false=_RATE, found=_RATE, delay=_SPREAD)

    value: Number | str = Field(description="The value of the factor that sets how soon an alarm is raised.")
    false: RateAnswer = Field(description="Runs without faults in which there was an alarm.")
    found: RateAnswer = Field(description="Runs with faults in which all of them were found.")
    delay: SpreadAnswer = Field(description="Delay in s of the faults that were found.")


class Roc(Strict):
    """Alarms without faults against faults found, at each value of a factor."""

    model_config = example(points=[{"value": 0.01, "false": _RATE, "found": _RATE, "delay": _SPREAD}])

    points: tuple[RocPointAnswer, ...]


class Confusion(Strict):
    """What the first alarm named: true faults → name → runs."""

    model_config = example(counts={"theta1": {"theta1": 19, "none": 1}, "none": {"none": 20}})

    counts: dict[str, dict[str, int]] = Field(
        description="`none`: no fault, or no alarm; empty: an alarm that names nothing."
    )


class SensitivityAnswer(Strict):
    """What a factor does to a measure."""

    model_config = example(factor="noise.y.std", rank=0.8, first=0.6)

    factor: str
    rank: Number | None = Field(description="Spearman's rank correlation; null for a factor of names.")
    first: Number | None = Field(description="First-order Sobol index: the share of variance that it explains.")


class Sensitivities(Strict):
    """What each factor does to a measure, the strongest first."""

    model_config = example(factors=[{"factor": "noise.y.std", "rank": 0.8, "first": 0.6}])

    factors: tuple[SensitivityAnswer, ...]


class CompromiseAnswer(Strict):
    """A point of the design by two measures."""

    model_config = example(point=3, run=300, a=0.12, b=0.8, best=True, values={"rho": 4.0})

    point: int = Field(description="Number of the point.")
    run: int = Field(description="Number of its first run.")
    a: Number = Field(description="Median of the first measure.")
    b: Number = Field(description="Median of the second measure.")
    best: bool = Field(description="No other point is better in one of them and as good in the other.")
    values: dict[str, Number | str] = Field(description="The values of the factors there.")


class Compromises(Strict):
    """All points of the design by two measures, of which less is better."""

    model_config = example(points=[{"point": 3, "run": 300, "a": 0.12, "b": 0.8, "best": True, "values": {"rho": 4.0}}])

    points: tuple[CompromiseAnswer, ...]


class PointAnswer(Strict):
    """A point of the design with a cell for each measure."""

    model_config = example(point=0, run=0, runs=20, values={"rho": 4.0}, cells=["0.62 [0.53, 0.98]"], numbers=[0.62])

    point: int = Field(description="Number of the point.")
    run: int = Field(description="Number of its first run.")
    runs: int = Field(description="Runs there.")
    values: dict[str, Number | str] = Field(description="The values of the factors.")
    cells: tuple[str, ...] = Field(description="Median [middle half], or count/runs (interval).")
    numbers: tuple[Number | None, ...] = Field(description="Median, or share, of each measure.")


class PointAnswers(Strict):
    """The table of points."""

    model_config = example(
        measures=["delay.detector.theta3"],
        points=[
            {"point": 0, "run": 0, "runs": 20, "values": {"rho": 4.0}, "cells": ["0.6 [0.5, 0.9]"], "numbers": [0.6]}
        ],
    )

    measures: tuple[str, ...] = Field(description="Names of the columns.")
    points: tuple[PointAnswer, ...]
