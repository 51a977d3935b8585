"""The gains of an experiment's observers, with defaults filled in."""

from thetascope.assembly.analyses.record_run import with_rows
from thetascope.assembly.build.experiment_builder import engine
from thetascope.assembly.build.gain_values import Values, from_parameters
from thetascope.engine.simulation.experiment import Estimator
from thetascope_schemas import ResolvedExperiment

Labels = dict[str, dict[str, list[str]]]
"""Labels of the rows and of the columns, by gain."""


def present_gains(spec: ResolvedExperiment) -> tuple[dict[str, dict[str, Values]], dict[str, Labels]]:
    """Return the gains of each observer by label, and the labels of their rows and columns.

    Raises SpecError where the experiment cannot run.
    """
    estimators = engine(with_rows(spec)).estimators
    return {e.label: _values(e) for e in estimators}, {e.label: _labels(e) for e in estimators}


def _values(estimator: Estimator) -> dict[str, Values]:
    context, numbers = estimator.context, estimator.parameters
    return {g.name: from_parameters(g.name, g.shape(context), numbers) for g in estimator.kind.gains}


def _labels(estimator: Estimator) -> Labels:
    context = estimator.context
    return {
        g.name: {"rows": list(g.row_labels(context)), "columns": list(g.column_labels(context))}
        for g in estimator.kind.gains
        if g.size is not None
    }
