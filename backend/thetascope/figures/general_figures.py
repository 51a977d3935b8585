"""The figures of every run, whatever its plant: states, faults, outputs, residuals, errors, inputs, excitation."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from thetascope.figures.figure_data import FigureData
from thetascope.figures.html_symbols import HAT, TILDE, escape, symbol, wrap
from thetascope.figures.strips import Drawing, Line, Strip

EXCITATION = ("pe", "lambda_min", "excitation")
"""Diagnostics that measure excitation, by the first part of the column's name."""


def _excitation_columns(columns: Sequence[str], labels: Sequence[str]) -> list[tuple[str, str]]:
    """Return (label, diagnostic) of every column that measures excitation."""
    return [
        (label, column[len(label) + 1 :])
        for column in columns
        for label in labels
        if column.startswith(label + ".") and column[len(label) + 1 :].split(".")[0] in EXCITATION
    ]


def available(spec, columns: Sequence[str]) -> list[str]:
    """Return the names of the general figures that a result with these columns can fill."""
    kinds = {column.split(".")[0] for column in columns}
    labels = list(spec.observer_configs())
    observed = bool(labels)
    estimated = any(column.startswith(f"{label}.theta.") for column in columns for label in labels)
    unknown = not kinds & {"theta", "x"}  # a record: nobody knows the truth
    states = any(column.startswith(f"{label}.x.") for column in columns for label in labels)
    offered = [
        ("faults", estimated or "theta" in kinds and bool(spec.faults)),
        ("states", "x" in kinds or states),
        ("outputs", "y" in kinds),
        ("residuals", observed and "y" in kinds),
        ("relations", any(column.startswith(f"{label}.residual.") for column in columns for label in labels)),
        ("errors", observed and not unknown),
        ("inputs", bool(kinds & {"u", "signal"})),
        ("excitation", bool(_excitation_columns(columns, labels))),
    ]
    return [name for name, possible in offered if possible]


def _compare(run: FigureData, kind: str) -> list[Strip]:
    """Return the strips of each state or channel: true value and all estimates."""
    strips = []
    for item in getattr(run.plant, {"x": "states", "theta": "channels"}[kind]):
        shade = run.intervals(kind, item.name) if kind == "theta" else []
        edges = {at for interval in shade for at in interval}
        marks = [at for at in run.changes() if at not in edges]
        truth = [run.truth(kind, item.name)] if f"{kind}.{item.name}" in run.columns else []
        lines = [*run.estimates(kind, item.name), *truth]
        caption, unit = run.caption(kind, item.name), run.unit(kind, item.name)
        strips.append(Strip(run.time, symbol(item.name), caption, lines, shade=shade, marks=marks, unit=unit))
    return strips


def _outputs(run: FigureData) -> list[Strip]:
    strips = []
    for item in run.plant.outputs:
        measured = Line(
            run.values(f"y.{item.name}"),
            f"{symbol(item.name)} {run.say('figure.measured')}",
            run.theme.soft,
            run.say("figure.measured"),
            width=1.0,
            final=True,
            framing=True,
            layer=-len(run.labels),
            curve="measured",
            source=f"y.{item.name}",
        )
        strips.append(
            Strip(
                run.time,
                symbol(item.name),
                run.caption("y", item.name),
                [measured, *run.estimates("y", item.name)],
                unit=run.unit("y", item.name),
                shade=run.intervals("y", item.name),
                marks=run.changes(),
            )
        )
    return strips


def _residuals(run: FigureData) -> list[Strip]:
    strips = []
    for item in run.plant.outputs:
        y, sign = run.values(f"y.{item.name}"), f"{symbol(item.name)} − {symbol(item.name, HAT)}"
        lines = [
            replace(
                line,
                y=_difference(y, line.y),
                name=f"{sign} {line.legend}",
                final=False,
                source=f"y.{item.name} - {line.source}",
            )
            for line in run.estimates("y", item.name)
        ]
        if lines:
            strips.append(
                Strip(
                    run.time,
                    sign,
                    run.caption("y", item.name, "residual"),
                    lines,
                    unit=run.unit("y", item.name),
                    marks=run.changes(),
                    shade=run.intervals("y", item.name),
                )
            )
    return strips


def _relations(run: FigureData) -> list[Strip]:
    """Return a strip for each residual that is blind to a channel, in thresholds, with its threshold."""
    strips = []
    for item in run.plant.channels:
        lines = [
            Line(
                run.values(column),
                f"<i>r</i> {escape(label)}",
                run.colour(label),
                run.legend(label),
                final=True,
                layer=-place,
                curve=label,
                source=column,
            )
            for place, label in enumerate(run.labels)
            if (column := f"{label}.residual.{item.name}") in run.columns
        ]
        if lines:
            sign, caption = f"<i>r</i><sub>{escape(item.name)}</sub>", run.caption("theta", item.name)
            shade = run.intervals("theta", item.name)
            strips.append(Strip(run.time, sign, caption, lines, shade=shade, marks=run.changes(), limit=1.0))
    return strips


def _difference(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    with np.errstate(over="ignore", invalid="ignore"):
        return a - b


def _errors(run: FigureData) -> list[Strip]:
    """Return the strips of |x̃| and |θ̃| on logarithmic axes: an exponential decay is a straight line."""
    strips = []
    for kind, items in (("theta", run.plant.channels), ("x", run.plant.states)):
        for item in items:
            truth, sign = run.values(f"{kind}.{item.name}"), f"|{symbol(item.name, TILDE)}|"
            lines = [
                replace(
                    line,
                    y=np.abs(_difference(line.y, truth)),
                    name=f"{sign} {line.legend}",
                    final=False,
                    source=f"|{line.source} - {kind}.{item.name}|",
                )
                for line in run.estimates(kind, item.name)
            ]
            if lines:
                strips.append(
                    Strip(
                        run.time,
                        sign,
                        run.caption(kind, item.name),
                        lines,
                        log=True,
                        unit=run.unit(kind, item.name),
                        marks=run.changes(),
                        shade=run.intervals(kind, item.name),
                    )
                )
    return strips


def _inputs(run: FigureData) -> list[Strip]:
    strips = []
    plant = run.plant
    for kind, items in (("r", plant.references), ("u", plant.inputs), ("signal", plant.signals)):
        for item in (item for item in items if f"{kind}.{item.name}" in run.columns):
            column, unit = f"{kind}.{item.name}", run.unit(kind, item.name)
            line = Line(run.values(column), symbol(item.name), run.theme.ink, framing=True, source=column)
            strips.append(
                Strip(run.time, symbol(item.name), run.caption(kind, item.name), [line], height=72, unit=unit)
            )
    return strips


def _excitation(run: FigureData) -> list[Strip]:
    """Return one strip for each measure of excitation, with the threshold of the check of the same run."""
    strips: dict[str, list[Line]] = {}
    limits: dict[str, float] = {}
    for label, name in _excitation_columns(run.result.names, run.labels):
        strips.setdefault(name, []).append(
            Line(
                run.values(f"{label}.{name}"),
                f"{escape(name)} {escape(label)}",
                run.colour(label),
                run.legend(label),
                layer=-run.labels.index(label),
                curve=label,
                source=f"{label}.{name}",
            )
        )
        for check in (check for r in run.result.observers if r.label == label for check in r.checks):
            if check.name.code == "check.excitation" and check.threshold and check.threshold > 0:
                limits[name] = max(check.threshold, limits.get(name, 0.0))
    return [
        Strip(
            run.time,
            "<i>λ</i><sub>min</sub>" if name in EXCITATION else wrap(name, 12),
            "excitation",
            lines,
            log=_wide(lines),
            marks=run.changes(),
            limit=limits.get(name),
        )
        for name, lines in strips.items()
    ]


def _wide(lines: Sequence[Line]) -> bool:
    """Return whether the lines' positive values span more than a decade."""
    positive = [y[y > 0] for y in (line.y for line in lines) if (y > 0).any()]
    return bool(positive) and max(y.max() for y in positive) > 10 * min(y.min() for y in positive)


_BUILD: dict[str, Callable[[FigureData], list[Strip]]] = {
    "faults": lambda run: _compare(run, "theta"),
    "states": lambda run: _compare(run, "x"),
    "outputs": _outputs,
    "residuals": _residuals,
    "relations": _relations,
    "errors": _errors,
    "inputs": _inputs,
    "excitation": _excitation,
}


def build(run: FigureData, name: str) -> Drawing:
    """Return the general figure of that name. Raises KeyError if it does not exist or this run has nothing to draw."""
    strips = _BUILD[name](run)
    if not strips:
        raise KeyError(name)
    recorded = run.spec.truth.record is not None and name in ("faults", "states")
    caption = f"figure.{name}.caption-record" if recorded else f"figure.{name}.caption"
    return Drawing(run.say(f"figure.{name}"), run.say(caption), strips)
