"""Observers that can be built for a plant, ranked by how they estimate its faults in an experiment that suits it."""

from dataclasses import dataclass

import numpy as np

from thetascope.assembly.analyses.plant_check import obstacle
from thetascope.assembly.build.prepare import prepare
from thetascope.engine.errors import SpecError
from thetascope.engine.model.result import ObserverReport, Result
from thetascope.engine.observers.registry import kinds
from thetascope.messages import Message
from thetascope_schemas import ObserverConfig, ResolvedExperiment
from thetascope_schemas.experiment.diagnosis import DiagnosisSettings
from thetascope_schemas.experiment.plant import Plant

USEFUL = 0.5  # error in typical faults up to which an observer whose assumptions hold comes first
_MOST = 40.0  # error in typical faults from which an estimate is of no use
_LARGE = 8  # states and channels together up to which observers are run: larger ones take minutes to build
_GOOD = ("adaptive-kalman-discrete", "joint-ekf", "joint-ukf", "adaptive-kalman")  # where none is run


@dataclass(frozen=True)
class Ranked:
    """An observer of a plant.

    Args:
        kind: of observer.
        possible: whether it can be built; `why` says why not.
        error: root mean square error of the estimated faults in typical faults, the faults of the experiment taken
            together; None: it was not run, or it diverged.
        holds: whether none of its assumptions failed in the run.
        why: the reason in a sentence.
    """

    kind: str
    possible: bool
    error: float | None
    holds: bool
    why: Message


def ranked_observers(plant: Plant, spec: ResolvedExperiment) -> list[Ranked]:
    """Return all kinds of observers, the best first: useful ones whose assumptions hold, then by their error.

    Each is run alone with its default gains; one that cannot be built is last, with the reason. Raises SpecError.
    """
    if len(plant.states) + len(plant.channels) > _LARGE:
        return sorted((_unranked(kind, plant) for kind in kinds()), key=_order)
    return sorted((_ranked(kind, plant, spec) for kind in kinds()), key=_order)


def _unranked(kind: str, plant: Plant) -> Ranked:
    """Return an observer of a large plant, which is not run. Only those of Kalman type are looked at."""
    if kind not in _GOOD:
        return Ranked(kind, False, None, False, Message("workshop.observer.large"))
    why = obstacle(kind, plant)
    return Ranked(kind, why is None, None, why is None, why or Message("workshop.observer.not-run"))


def _order(one: Ranked) -> tuple:
    known = _GOOD.index(one.kind) if one.kind in _GOOD else len(_GOOD)
    error = np.inf if one.error is None else round(one.error, 2)
    good = one.holds and error < USEFUL
    return (not one.possible, one.error is None and not one.holds, not good, error, known)


def _ranked(kind: str, plant: Plant, spec: ResolvedExperiment) -> Ranked:
    if not plant.channels:
        why = obstacle(kind, plant)
        return Ranked(kind, why is None, None, why is None, why or Message("workshop.observer.no-faults"))
    changes = {"observers": (ObserverConfig(label="o", kind=kind),), "diagnosis": DiagnosisSettings(enabled=False)}
    try:
        result = prepare(ResolvedExperiment.model_validate(dict(spec) | changes)).run()
    except SpecError as error:
        return Ranked(kind, False, None, False, Message("refusal.sentence", problem=error.problem, remedy=error.remedy))
    (report,) = result.observers
    if report.diverged is not None or result.diverged is not None:
        return Ranked(kind, True, None, False, Message("workshop.observer.diverged"))
    error = estimation_error(result, plant)
    holds = all(check.verdict != "fails" for check in report.checks)
    return Ranked(kind, True, error, holds, _reason(error, report))


def _reason(error: float | None, report: ObserverReport) -> Message:
    """Return the error in a sentence, and the first assumption that failed."""
    failed = next((check.name for check in report.checks if check.verdict == "fails"), None)
    if error is None or error > _MOST:
        return Message("workshop.observer.useless")
    size = Message("workshop.observer.error", share=round(100 * error, 1 if error < 0.1 else 0))
    if failed is None:
        return Message("workshop.observer.holds", size=size)
    return Message("workshop.observer.fails", size=size, name=failed)


def estimation_error(result: Result, plant: Plant) -> float | None:
    """Return the root mean square error of all faults over the run, in typical faults; None if it estimates none.

    A fault that it leaves out counts as estimated by 0, so that estimating fewer faults is no advantage.
    """
    errors = []
    for channel in plant.channels:
        name, true = f"o.theta.{channel.name}", result.column(f"theta.{channel.name}")
        found = result.column(name) if name in result.names else np.zeros_like(true)
        errors.append((found - true) / channel.typical)
    if not any(name.startswith("o.theta.") for name in result.names):
        return None
    error = float(np.sqrt(np.mean(np.square(errors))))
    return error if np.isfinite(error) else None
