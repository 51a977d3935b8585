"""An experiment that changes while it runs, as stages: each is an experiment that holds from a base step on.

A live session and the run that is saved from it have the same stages, so they give the same numbers.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from thetascope.engine.simulation.controlled import simulation_of
from thetascope.engine.simulation.experiment import Experiment, Rows, State
from thetascope.engine.simulation.initial_states import observer_states
from thetascope.engine.simulation.simulation import Simulation


@dataclass(frozen=True)
class Stage:
    """``experiment`` holds from base step ``k`` until the next stage.

    ``commanded``: whether a timed command begins it; stages of a session may also begin with an injected fault.
    """

    k: int
    experiment: Experiment
    commanded: bool = True


def carry(state: State, old: Experiment, stage: Stage) -> State:
    """Return the state from which a new stage continues: observers keep theirs, added ones start here."""
    new = stage.experiment
    kept = {e.label: (e, s) for e, s in zip(old.estimators, state.observers, strict=True)}
    observers: list[np.ndarray] = []
    at, seen = state.plant[:, None], None
    for i, estimator in enumerate(new.estimators):
        before = kept.get(estimator.label)
        if before is not None and before[0].program == estimator.program and before[0].since == estimator.since:
            observers.append(before[1])
        else:
            if new.loop is not None and seen is None:
                seen = Simulation(new).known_at(state)
            observers.append(observer_states([new], i, state.k, at, seen)[:, 0].copy())
    control = state.control.restarted(state.k) if state.control is not None and stage.commanded else state.control
    return replace(state, observers=tuple(observers), control=control)


def spans(stages: Sequence[Stage], count: int, spacing: int | None = None) -> Iterator[tuple[State, Experiment, Rows]]:
    """Advance from t = 0 by ``count`` base steps through the stages, in chunks.

    ``spacing``: base steps between rows.
    """
    state = None
    for i, stage in enumerate(stages):
        end = min(count, stages[i + 1].k) if i + 1 < len(stages) else count
        simulated = simulation_of(stage.experiment, spacing=spacing)
        state = simulated.initial() if state is None else carry(state, stages[i - 1].experiment, stage)
        if end <= state.k:
            continue
        for after, rows in simulated.spans(end - state.k, state):
            state = after
            yield after, stage.experiment, rows


@dataclass(frozen=True)
class Life:
    """The time during which one observer runs: its rows (positions in the record), states, and parameters by stage."""

    label: str
    experiments: tuple[Experiment, ...]  # one for each part
    positions: tuple[np.ndarray, ...]
    states: tuple[np.ndarray, ...]

    @property
    def where(self) -> slice:
        """Return the positions of its rows, which are consecutive."""
        first = next((int(p[0]) for p in self.positions if len(p)), 0)
        return slice(first, first + sum(len(p) for p in self.positions))


def lives(parts: Sequence[tuple[Experiment, Rows]]) -> list[Life]:
    """Return the lives of all observers, in the order in which they began."""
    open_: dict[str, list] = {}
    begun: list[tuple[str, list]] = []
    position = 0
    for experiment, rows in parts:
        where = np.arange(position, position + len(rows.index))
        position += len(rows.index)
        present = {e.label for e in experiment.estimators}
        for label in [name for name in open_ if name not in present]:
            del open_[label]
        for estimator, states in zip(experiment.estimators, rows.observers, strict=True):
            life = open_.get(estimator.label)
            if life is None or _estimator(life[-1][0], estimator.label).since != estimator.since:
                life = open_[estimator.label] = []
                begun.append((estimator.label, life))
            life.append((experiment, where, states))
    return [Life(label, *(tuple(c) for c in zip(*life, strict=True))) for label, life in begun]


def _estimator(experiment: Experiment, label: str):
    return next(e for e in experiment.estimators if e.label == label)


def parameters_over(life: Life) -> dict[str, float | np.ndarray]:
    """Return the observer's parameters: a number where it never changed, else an array over the rows of its life."""
    each = [_estimator(e, life.label).parameters for e in life.experiments]
    if len(each) == 1:
        return {**each[0]}
    counts = [len(p) for p in life.positions]
    return {
        name: each[0][name] if len({p[name] for p in each}) == 1 else np.repeat([p[name] for p in each], counts)
        for name in each[0]
    }


def final_estimator(life: Life):
    """Return the observer with its last parameters."""
    return _estimator(life.experiments[-1], life.label)
