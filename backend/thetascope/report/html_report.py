"""A run as one HTML file that opens offline: the experiment, its results, their reliability, and how to repeat it."""

import json
import platform
import shlex
from collections.abc import Callable, Mapping
from functools import cache
from importlib import metadata, resources
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from markupsafe import Markup

from thetascope.assembly.analyses.observability_report import observability
from thetascope.assembly.build.diagnosis_settings import findings
from thetascope.diagnosis.evaluation import metrics
from thetascope.diagnosis.evaluation.observer_comparison import compare
from thetascope.figures import figure, figure_names
from thetascope.figures.figure_data import FigureData
from thetascope.messages.catalogue import catalogue
from thetascope.report.comparison_section import comparison
from thetascope.report.diagnosis_section import diagnosis
from thetascope.report.observers_section import observers
from thetascope.report.plant_section import plant_section, timeline
from thetascope.report.record_section import record
from thetascope.report.words import ReportContext, mark, number
from thetascope_schemas import ResolvedExperiment
from thetascope_schemas.experiment.diagnosis import Observability
from thetascope_schemas.experiment.figures import Note
from thetascope_schemas.service.record_diagnosis import RecordDiagnosis
from thetascope_schemas.texts.local_text import ALL

Observed = Callable[[ResolvedExperiment], Observability | None]

PACKAGES = ("numpy", "scipy", "llvmlite", "sympy", "plotly")


class PlotlyMissing(RuntimeError):
    """The script that draws the figures is missing from the installed plotly package."""


def plotly_script() -> Path:
    """Return the path of plotly.min.js in the installed wheel, without importing plotly."""
    spec = find_spec("plotly")
    path = Path(spec.origin).parent / "package_data" / "plotly.min.js" if spec and spec.origin else None
    if path is None or not path.is_file():
        raise PlotlyMissing(
            "plotly.min.js was not found in the installed plotly package; install the pinned plotly wheel"
        )
    return path


@cache
def _script() -> str:
    """Return the library's text, safe inside <script>."""
    return plotly_script().read_text(encoding="utf-8").replace("</script", "<\\/script").replace("<!--", "<\\!--")


def _asset(name: str) -> str:
    return resources.files("thetascope.report").joinpath(name).read_text(encoding="utf-8")


def embedded_json(value: object) -> str:
    """Return JSON that is safe inside a <script> element: no text in it can end the element."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026").replace("\u2028", "\\u2028")


def _plotly_words(language: str) -> dict[str, str]:
    """Return the words of Plotly's buttons in a language by its own English ones, which are the English entries."""
    english, words = catalogue("en").templates, catalogue(language).templates
    return {str(english[code]): str(words[code]) for code in english if code.startswith("page.plotly.")}


def versions() -> dict[str, str]:
    """Return the versions of Python and of the numerical packages."""
    found = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return found


def report(
    result, spec, plant, run_meta: Mapping[str, Any], language: str = "en", observed: Observed = observability
) -> str:
    """Return the whole report as HTML text in a language.

    result: the run's `Result`; spec: its Experiment; plant: the Plant in full. run_meta, all optional: `id` (of the
    run), `created` (text or datetime), `command` (the command line that makes this report), `versions` (name →
    version). `observed` returns the observability of the experiment, None if it was not computed.

    Raises PlotlyMissing when the drawing script cannot be found.
    """
    own = ReportContext(FigureData(result, spec, plant, "light", language))
    figures = [
        figure(result, spec, plant, entry["name"], language=language) for entry in figure_names(spec, result.names)
    ]
    summary = metrics.summary(result, spec.faults)
    found = findings(result)
    compared = compare(result, spec.faults, found)
    return own.render(
        "report.html",
        language=language,
        title=own.text(spec.title) or spec.id,
        source=own.text(spec.source),
        description=own.text(spec.description),
        alarms=_alarms(own),
        notes=[own.text(note) for note in result.notes],
        errata=[own.text(text) for text in spec.errata],
        plant=plant_section(own),
        timeline=timeline(own),
        marks=[_mark(own, note) for note in sorted(spec.notes, key=lambda note: note.t)],
        diagnosis=diagnosis(own, found, observed(spec.with_plant(plant))) if found else "",
        record=record(own, RecordDiagnosis.model_validate(result.record)) if result.record else "",
        figures=[drawn["layout"]["meta"] for drawn in figures],
        comparison=comparison(own, compared, summary) if summary else "",
        observers=observers(own) if summary else "",
        reproduce=_reproduce(own, run_meta),
        figures_json=Markup(embedded_json(figures)),  # no text in it can end its element
        plotly_words=Markup(embedded_json(_plotly_words(language))),
        plotly=Markup(_script()),
        style=Markup(_asset("report.css")),  # these two are files of this package
        script=Markup(_asset("report.js")),
    )


def _mark(own: ReportContext, note: Note) -> Markup:
    """Return a note of the session or the experiment, or a bookmark, with its time."""
    if not note.text:
        return own.say("report.bookmark", t=number(note.t, 6))
    return own.say("report.own-note", t=number(note.t, 6), text=note.text)


def _alarms(own: ReportContext) -> list[Markup]:
    """Return what went wrong: divergence of the plant or of observers."""
    result = own.run.result
    lines = []
    if result.diverged:
        cause = own.text(result.diverged.cause)
        lines.append(own.say("report.diverged.plant", t=number(result.diverged.time), cause=cause))
    for one in result.observers:
        if one.diverged:
            cause, t = own.text(one.diverged.cause), number(one.diverged.time)
            lines.append(own.say("report.diverged", label=one.label, t=t, cause=cause))
    return lines


def _accuracy(own: ReportContext) -> list[tuple[Markup, Markup | str]]:
    """Return the row that states the accuracy of the integration, if it was measured."""
    sentence = own.run.result.accuracy_message
    return [] if sentence is None else [(own.say("report.reproduce.accuracy"), own.text(sentence))]


def _reproduce(own: ReportContext, run_meta: Mapping[str, Any]) -> Markup:
    result, spec = own.run.result, own.run.spec
    command = run_meta.get("command")
    known = dict(run_meta.get("versions") or versions())
    steps = {"step": number(result.step), "n": result.substeps, "horizon": number(spec.horizon, 6)}
    return own.render(
        "reproduce.html",
        rows=[
            (own.say("report.reproduce.run"), mark("code", run_meta.get("id", "–"))),
            (own.say("report.reproduce.created"), run_meta.get("created", "–")),
            (own.say("report.reproduce.seed"), spec.seed),
            (own.say("report.reproduce.step"), own.say("report.reproduce.steps", **steps)),
            *_accuracy(own),
            (own.say("report.reproduce.versions"), ", ".join(f"{name} {version}" for name, version in known.items())),
        ],
        save_as="" if command else own.say("report.reproduce.save", file=mark("code", f"{spec.id}.json")),
        command=command or f"thetascope run {shlex.quote(spec.id + '.json')} --out report.html",
        spec=json.dumps(spec.model_dump(mode="json", context={"language": ALL}), ensure_ascii=False, indent=1),
    )
