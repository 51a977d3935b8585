"""Changes of runs that follow no experiment of the library: each differs from the oldest one of its plant."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from thetascope.runs.specs.spec_changes import spec_changes
from thetascope.store import Line
from thetascope_schemas.experiment.experiment import Experiment

_MOST = 100
"""Most lines for which specs are read."""


def with_own_changes(lines: Sequence[Line], spec_of: Callable[[str], Experiment | None]) -> list[Line]:
    """Return lines in which runs with an own experiment say what they changed; spec_of: the spec of a stored run.

    The oldest such run of each plant among the lines has no changes, and neither has one that cannot be read.
    """
    first: dict[str, Experiment] = {}
    changed: dict[str, Line] = {}
    own = [line for line in lines if line.facts and not line.facts.experiment and line.facts.kind != "record"]
    for line in sorted(own[:_MOST], key=lambda line: line.record.created):
        assert line.facts is not None
        spec = spec_of(line.record.id)
        if spec is None:
            continue  # a damaged run must not take the changes of the others away
        base = first.setdefault(str(line.facts.shown.get("plant")), spec)
        if base is not spec:
            changes = spec_changes(base, spec)
            changed[line.record.id] = replace(line, facts=replace(line.facts, changes=changes, compared=True))
    return [changed.get(line.record.id, line) for line in lines]
