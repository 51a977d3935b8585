"""The runs of a study by their number: the point, the seed, whether faults act, and the experiment."""

from collections.abc import Mapping
from dataclasses import dataclass

from thetascope.messages import Message
from thetascope.runs.specs.refusals import invalid, validated
from thetascope.runs.specs.resolve_spec import library_experiment, resolved, with_changes
from thetascope.studies.design import values_at
from thetascope_schemas.experiment.experiment import Experiment, ResolvedExperiment
from thetascope_schemas.service.study.factors import ObserversFactor
from thetascope_schemas.service.study.study import Study
from thetascope_schemas.texts.local_text import ALL


@dataclass(frozen=True)
class Place:
    """Where a run stands in its study.

    Args:
        run: its number, from 0.
        point: number of its point.
        repeat: number of its seed.
        faulty: whether the faults act.
    """

    run: int
    point: int
    repeat: int
    faulty: bool


def place_of(study: Study, run: int) -> Place:
    """Return where a run stands: all seeds of a point follow one another, each with its modes."""
    rest, mode = divmod(run, len(study.modes))
    point, repeat = divmod(rest, study.seeds)
    return Place(run, point, repeat, study.modes[mode])


def complete(study: Study, base: Experiment | None = None) -> Study:
    """Return a study that depends on nothing else: its experiment in full, with its plant, `set` applied.

    Args:
        study: the study.
        base: its experiment where that is not the library's, with the plant that the sender saved in full.

    Raises:
        Unknown, InvalidSpec: the experiment does not exist, or is refused.
    """
    chosen = base or (library_experiment(study.experiment) if isinstance(study.experiment, str) else study.experiment)
    spec = resolved(with_changes(chosen, study.set))
    if spec.truth.record is not None:
        raise invalid("experiment", spec.id, Message("study.record", value=spec.id))
    for i, factor in enumerate(study.vary):
        if isinstance(factor, ObserversFactor):
            _check_labels(factor, spec, i)
    whole = study.model_copy(update={"experiment": spec, "set": {}})
    experiment_of_point(whole, 0)  # a path that does not exist, or a first value out of its bounds
    return whole


def _check_labels(factor: ObserversFactor, spec: Experiment, index: int) -> None:
    known = [config.label for config in spec.observers]
    for label in factor.labels:
        if label not in known:
            raise invalid(f"vary[{index}].labels", label, Message("study.label.unknown", label=label, names=known))


def experiment_of_point(study: Study, point: int) -> ResolvedExperiment:
    """Return the experiment of a point of a complete study, with its faults and its first seed.

    Raises InvalidSpec where the values of the point are refused.
    """
    base = study.experiment
    assert isinstance(base, Experiment), "a complete study holds its experiment"
    values = values_at(study, point)
    changes: dict[str, object] = {}
    for value in values:
        changes |= value.changes
    for value in values:
        if value.observer is not None:
            kept = [config for config in base.observers if config.label == value.observer]
            base = base.model_copy(update={"observers": tuple(kept)})
    for value in values:
        if value.faults is not None:
            base = _with_faults(base, value.faults)
    return resolved(with_changes(base, changes) if changes else base)


def at_place(spec: ResolvedExperiment, place: Place) -> ResolvedExperiment:
    """Return the experiment of a run; `spec` is that of its point."""
    return spec.model_copy(update={"seed": spec.seed + place.repeat} | ({} if place.faulty else {"faults": ()}))


def _with_faults(base: Experiment, faults: tuple[Mapping[str, object], ...]) -> Experiment:
    data = base.model_dump(mode="json", context={"language": ALL}) | {"faults": [dict(one) for one in faults]}
    return validated(Experiment, data)
