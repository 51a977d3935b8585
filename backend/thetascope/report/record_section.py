"""The diagnosis of a record in the report: does the model fit, the faults, and what is missing from the model."""

from markupsafe import Markup

from thetascope.report.words import ReportContext, bracketed, mark, number, symbol, unit
from thetascope_schemas.service.record_diagnosis import FaultCandidate, Interval, OutputFitReport, RecordDiagnosis

_FIT = ("output", "predicted", "simulated", "noise-std", "bias", "white")
_FAULTS = ("alarm-at", "fault", "shape", "since", "size", "rate", "alternatives")
_WHITE = 1e-3  # probability below which innovations are not taken as white


def record(report: ReportContext, found: RecordDiagnosis) -> Markup:
    """Return the result in a sentence, the fit of each output, the faults, reservations and notes."""
    faults = report.table([report.say(f"report.head.{name}") for name in _FAULTS], list(_faults(report, found)), 5)
    fit = report.table(
        [report.say(f"report.head.{name}") for name in _FIT], [_output(report, o) for o in found.fit.outputs], 5
    )
    reservations = [f.note for f in found.faults if f.note is not None]
    return report.render(
        "record.html",
        sentence=report.text(found.sentence),
        verdict=report.text(found.fit.text),
        fit=fit,
        reasons=[report.text(s.text) for s in (*found.fit.reasons, *found.fit.suspects[:3])],
        advice=[report.text(advice) for advice in found.fit.advice],
        faults=faults,
        notes=[report.text(text) for text in (*reservations, *(m.text for m in found.missing), *found.notes)],
    )


def _output(report: ReportContext, fit: OutputFitReport) -> list[Markup | str]:
    return [
        symbol(fit.output) + bracketed(fit.unit),
        _percent(fit.predicted),
        "–" if fit.simulated is None else _percent(fit.simulated),
        number(fit.noise, 3),
        number(fit.bias, 2),
        mark("verdict", *_white(report, fit)),
    ]


def _percent(share: float) -> Markup:
    return Markup("{} %").format(number(100 * share, 3))


def _white(report: ReportContext, fit: OutputFitReport) -> tuple[str, Markup]:
    good = fit.whiteness > _WHITE
    return "holds" if good else "fails", report.say("report.yes" if good else "report.no")


def _faults(report: ReportContext, found: RecordDiagnosis) -> list[list[Markup | str]]:
    rows = []
    for fault in found.faults:
        best = fault.best
        others = [_name(report, other) for other in fault.alternatives if not other.separable]
        size = report.say("report.head.at-bound") if best.bound is not None else _interval(report, best.size, best.unit)
        rows.append(
            [
                number(fault.alarm, 6),
                _name(report, best),
                report.say(f"cli.shape.{best.shape}"),
                _interval(report, best.onset, "", 6),
                size,
                number(best.rate, 3) if best.rate else "–",
                report.joined(others) or "–",
            ]
        )
    return rows


def _name(report: ReportContext, candidate: FaultCandidate) -> Markup | str:
    return symbol(candidate.channel) if candidate.channel else report.text(candidate.title)


def _interval(report: ReportContext, value: Interval, of: str, digits: int = 4) -> Markup:
    return Markup("{}{}").format(number(value.value, digits), unit(of)) + report.span(value.low, value.high, digits)
