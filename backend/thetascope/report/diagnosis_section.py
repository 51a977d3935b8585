"""The diagnosis in the report: which faults each observer's tests found, how the tests were set, what cannot be seen."""

from collections.abc import Mapping

from thetascope.diagnosis.evaluation.observer_comparison import DETECTOR
from thetascope.figures.figure_data import Scene
from thetascope.figures.html_symbols import escape, symbol
from thetascope.report.prose import bracketed, chip, number, span, table, unit
from thetascope_schemas.experiment.diagnosis import Observability


def diagnosis(scene: Scene, findings: Mapping[str, object]) -> str:
    """The detector's findings (shaped as `shared.diagnosis.ObserverDiagnosis`), then each observer's, in the order of the spec."""
    labels = (DETECTOR, *scene.labels)
    return "".join(_observer(scene, label, findings[label]) for label in labels if label in findings)


def visible(found: Observability) -> str:
    """What the outputs show of states and faults: by the equations alone, and along the run."""
    return (
        f"<h3>Observability of states and faults</h3><p><span class=soft>By the equations:</span> {escape(found.text)}.</p>"
        f"<p><span class=soft>Along this run (empirical Gramian, in units of typical sizes):</span> {escape(found.along)}.</p>"
    )


def _observer(scene: Scene, label: str, found) -> str:
    title = "Detector" if label == DETECTOR else f"{chip(scene, label)}: its own estimates"
    out = f"<h3>{title}</h3>"
    if found.sentence:
        out += f"<p>{escape(found.sentence)}</p>"
    if found.note:
        out += f"<p class=scope-note>{escape(found.note)}</p>"
    return (
        out
        + _alarms(scene, found.alarms)
        + _thresholds(found.calibration)
        + _resolution(scene, found.resolution)
        + _excitation(found.excitation)
        + _noise(scene, found.noise)
    )


def _alarms(scene: Scene, alarms) -> str:
    rows = [
        [
            number(alarm.t, 6),
            _what(alarm),
            ", ".join(symbol(name) for name in alarm.alternatives) or "–",
            escape(alarm.test),
            number(alarm.onset, 6) + span(alarm.onset_from, alarm.onset_to, 6),
            _size(scene, alarm),
            f"{number(alarm.statistic)} <span class=soft>over {number(alarm.threshold)}</span>",
            "still on" if alarm.cleared is None else number(alarm.cleared, 6),
        ]
        for alarm in sorted(alarms, key=lambda a: a.t)
    ]
    if not rows:
        return ""
    head = ["alarm at (s)", "fault", "or as well", "test", "since (s)", "size", "statistic", "over at (s)"]
    return table(head, rows, 4)


def _what(alarm) -> str:
    if alarm.kind == "fault":
        return symbol(alarm.channel)
    return "not explained by the model" + (f", seen in {symbol(alarm.output)}" if alarm.output else "")


def _size(scene: Scene, alarm) -> str:
    if alarm.size is None:
        return "–"
    return number(alarm.size) + unit(scene.unit("theta", alarm.channel)) + span(alarm.size_from, alarm.size_to)


def _thresholds(calibration) -> str:
    if calibration is None:
        return ""
    limits = ", ".join(f"{escape(name)} {number(value)}" for name, value in calibration.thresholds.items())
    note = f" {escape(calibration.note)}" if calibration.note else ""
    return (
        f"<p><span class=soft>Thresholds:</span> {limits or 'none'}, set for {number(calibration.false_alarms)} false alarms "
        f"per hour. They come from {calibration.seeds} simulated runs of this plant, observer and noise without faults, "
        f"{number(calibration.hours, 3)} hours in all. Nothing is judged before {number(calibration.from_time)} s, while "
        f"the observer settles.{note}</p>"
    )


def _resolution(scene: Scene, resolution) -> str:
    rows = [
        [
            symbol(r.channel) + bracketed(scene.unit("theta", r.channel)),
            _yes(r.resolvable),
            _yes(r.identifiable),
            escape(r.text),
            number(r.sigma),
            number(r.typical),
            number(r.smallest),
        ]
        for r in resolution
    ]
    head = [
        "fault",
        "a typical one can be found",
        "the input excites it",
        "",
        "standard deviation",
        "typical size",
        "smallest step found",
    ]
    return table(head, rows, 3) if rows else ""


def _yes(value: bool) -> str:
    return f"<span class='verdict {'holds' if value else 'fails'}'>{'yes' if value else 'no'}</span>"


def _excitation(excitation) -> str:
    if excitation is None:
        return ""
    enough = excitation.level is not None and excitation.level >= excitation.needed
    out = (
        f"<p><span class=soft>Excitation</span> over the last {number(excitation.window)} s: smallest eigenvalue "
        f"{number(excitation.level)}, and {number(excitation.needed)} {'is' if enough else 'would be'} needed for the "
        f"accuracy asked for. Seen least: {_direction(excitation.direction)}."
    )
    out += f" {escape(excitation.text)}" if excitation.text else ""
    return out + (f" <b>{escape(excitation.proposal)}</b>" if excitation.proposal else "") + "</p>"


def _direction(direction: Mapping[str, float]) -> str:
    """A combination of faults: "0.71 θ1 − 0.71 θ2"; parts below a hundredth of the largest are left out."""
    most = max(map(abs, direction.values()), default=0.0)
    text = ""
    for name, share in direction.items():
        if abs(share) > 0.01 * most:
            sign = ("− " if share < 0 else "") if not text else (" − " if share < 0 else " + ")
            text += f"{sign}{number(abs(share), 2)}\u2009{symbol(name)}"
    return text or "none"


def _noise(scene: Scene, levels) -> str:
    rows = [
        [
            symbol(level.output) + bracketed(scene.unit("y", level.output)),
            number(level.declared),
            number(level.estimated),
        ]
        for level in levels
    ]
    return table(["noise of", "declared std", "std from the residual"], rows, 2) if rows else ""
