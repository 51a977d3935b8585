"""The diagnosis in the report: the faults that each observer's tests found, the thresholds, what cannot be seen."""

from collections.abc import Mapping, Sequence

from markupsafe import Markup

from thetascope.diagnosis.evaluation.observer_comparison import DETECTOR
from thetascope.report.words import ReportContext, bracketed, mark, number, symbol, unit
from thetascope_schemas.experiment.diagnosis import (
    Alarm,
    Calibration,
    Excitation,
    NoiseLevel,
    Observability,
    ObserverDiagnosis,
    Resolution,
)


def diagnosis(report: ReportContext, findings: Mapping[str, ObserverDiagnosis], seen: Observability | None) -> Markup:
    """Return the detector's findings, then each observer's in the order of the spec,
    then the observability of the plant. `seen` is None if that was not computed."""
    labels = [label for label in (DETECTOR, *report.run.labels) if label in findings]
    return report.render(
        "diagnosis.html",
        observers=[_observer(report, label, findings[label]) for label in labels],
        structural=report.say("report.sentence", text=report.text(seen.text)) if seen else "",
        along=report.say("report.sentence", text=report.text(seen.along)) if seen else "",
    )


def _observer(report: ReportContext, label: str, found: ObserverDiagnosis) -> dict[str, object]:
    own = report.say("report.own-estimates", label=report.chip(label))
    excitation = found.excitation
    return {
        "title": report.say("report.detector") if label == DETECTOR else own,
        "sentence": report.text(found.sentence),
        "note": report.text(found.note),
        "alarms": _alarms(report, found.alarms),
        "thresholds": _thresholds(report, found.calibration) if found.calibration else "",
        "resolution": _resolution(report, found.resolution),
        "excitation": _excitation(report, excitation) if excitation else "",
        "text": report.text(excitation.text) if excitation else "",
        "proposal": report.text(excitation.proposal) if excitation and excitation.proposal else "",
        "noise": _noise(report, found.noise),
    }


def _alarms(report: ReportContext, alarms: Sequence[Alarm]) -> Markup:
    rows = [
        [
            number(alarm.t, 6),
            _fault(report, alarm),
            report.joined(symbol(name) for name in alarm.alternatives) or "–",
            report.text(alarm.test),
            number(alarm.onset, 6) + report.span(alarm.onset_from, alarm.onset_to, 6),
            _size(report, alarm),
            report.say("report.statistic", value=number(alarm.statistic), limit=number(alarm.threshold)),
            report.say("report.still-on") if alarm.cleared is None else number(alarm.cleared, 6),
        ]
        for alarm in sorted(alarms, key=lambda a: a.t)
    ]
    names = ("alarm-at", "fault", "alternatives", "test", "since", "size", "statistic", "cleared")
    return report.table([report.say(f"report.head.{name}") for name in names], rows, 4)


def _fault(report: ReportContext, alarm: Alarm) -> Markup:
    if alarm.kind == "fault" and alarm.channel is not None:
        return symbol(alarm.channel)
    if alarm.output:
        return report.say("report.unexplained.output", output=symbol(alarm.output))
    return report.say("report.unexplained")


def _size(report: ReportContext, alarm: Alarm) -> Markup | str:
    if alarm.size is None:
        return "–"
    size = number(alarm.size) + unit(report.run.unit("theta", alarm.channel))
    return size + report.span(alarm.size_from, alarm.size_to)


def _thresholds(report: ReportContext, calibration: Calibration) -> Markup:
    limits = [Markup("{} {}").format(name, number(value)) for name, value in calibration.thresholds.items()]
    return report.say(
        "report.thresholds",
        title=mark("soft", report.say("report.thresholds.title")),
        limits=report.joined(limits) if limits else report.say("report.none"),
        rate=number(calibration.false_alarms),
        seeds=calibration.seeds,
        hours=number(calibration.hours, 3),
        begin=number(calibration.from_time),
        note=report.text(calibration.note or ""),
    )


def _resolution(report: ReportContext, resolution: Sequence[Resolution]) -> Markup:
    rows = [
        [
            symbol(r.channel) + bracketed(report.run.unit("theta", r.channel)),
            _yes(report, r.resolvable),
            _yes(report, r.identifiable),
            report.text(r.text),
            number(r.sigma),
            number(r.typical),
            number(r.smallest),
        ]
        for r in resolution
    ]
    names = ("fault", "resolvable", "identifiable", "details", "sigma", "typical", "smallest")
    return report.table([report.say(f"report.head.{name}") for name in names], rows, 3)


def _yes(report: ReportContext, value: bool) -> Markup:
    return mark("verdict", "holds" if value else "fails", report.say("report.yes" if value else "report.no"))


def _excitation(report: ReportContext, excitation: Excitation) -> Markup:
    enough = excitation.level is not None and excitation.level >= excitation.needed
    return report.say(
        "report.excitation.enough" if enough else "report.excitation.too-low",
        title=mark("soft", report.say("report.excitation.title")),
        window=number(excitation.window),
        level=number(excitation.level),
        needed=number(excitation.needed),
        direction=_direction(excitation.direction) or report.say("report.none"),
    )


def _direction(direction: Mapping[str, float]) -> Markup:
    """Return a combination of faults, "0.71 θ1 − 0.71 θ2"; parts below a hundredth of the largest are left out."""
    most = max(map(abs, direction.values()), default=0.0)
    text = Markup()
    for name, share in direction.items():
        if abs(share) > 0.01 * most:
            sign = ("− " if share < 0 else "") if not text else (" − " if share < 0 else " + ")
            text += Markup("{}{}\u2009{}").format(sign, number(abs(share), 2), symbol(name))
    return text


def _noise(report: ReportContext, levels: Sequence[NoiseLevel]) -> Markup:
    rows = [
        [
            symbol(level.output) + bracketed(report.run.unit("y", level.output)),
            number(level.declared),
            number(level.estimated),
        ]
        for level in levels
    ]
    return report.table([report.say(f"report.head.{name}") for name in ("noise", "declared", "estimated")], rows, 2)
