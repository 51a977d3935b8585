"""A run as one HTML file that opens offline: what was run, what came out, how far to trust it, how to do it again."""

import json
import platform
import shlex
from collections.abc import Mapping
from functools import cache
from importlib import metadata, resources
from importlib.util import find_spec
from pathlib import Path

from thetascope.assembly.analyses.observability_report import observability
from thetascope.assembly.build.diagnosis_settings import findings
from thetascope.diagnosis.evaluation import metrics
from thetascope.diagnosis.evaluation.observer_comparison import compare
from thetascope.figures import figure, figure_names
from thetascope.figures.figure_data import Scene
from thetascope.figures.html_symbols import escape
from thetascope.report import prose
from thetascope.report.comparison_section import comparison
from thetascope.report.diagnosis_section import diagnosis, visible
from thetascope.report.observers_section import observers

PACKAGES = ("numpy", "scipy", "llvmlite", "sympy", "plotly")


class PlotlyMissing(RuntimeError):
    """The script that draws the figures is not where the plotly wheel keeps it."""


def plotly_script() -> Path:
    """plotly.min.js of the installed wheel, found without importing plotly."""
    spec = find_spec("plotly")
    path = Path(spec.origin).parent / "package_data" / "plotly.min.js" if spec and spec.origin else None
    if path is None or not path.is_file():
        raise PlotlyMissing(
            "plotly.min.js was not found in the installed plotly package; install the pinned plotly wheel"
        )
    return path


@cache
def _script() -> str:
    """The library's text, safe inside <script>."""
    return plotly_script().read_text(encoding="utf-8").replace("</script", "<\\/script").replace("<!--", "<\\!--")


def _asset(name: str) -> str:
    return resources.files(__package__).joinpath(name).read_text(encoding="utf-8")


def embedded_json(value: object) -> str:
    """JSON that can stand inside a <script> element: no text in it can end the element."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026").replace("\u2028", "\\u2028")


def versions() -> dict[str, str]:
    """Python's and the numerical packages' versions here."""
    found = {"python": platform.python_version()}
    for package in PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return found


def report(result, spec, plant, run_meta: Mapping[str, object]) -> str:
    """The whole report as HTML text.

    result: the run's `Result`; spec: its Experiment; plant: the Plant in full. run_meta, all optional: `id` (of the run),
    `created` (text or datetime), `command` (the command line that makes this report), `versions` (name → version).
    Raises PlotlyMissing when the drawing script cannot be found.
    """
    scene = Scene(result, spec, plant, "light")
    names = figure_names(spec, result.names)
    figures = [figure(result, spec, plant, entry["name"]) for entry in names]
    summary = metrics.summary(result, spec.faults)
    found = findings(result)
    compared = compare(result, spec.faults, found)
    drawings = [_section(None, _figure(place, drawn["layout"]["meta"])) for place, drawn in enumerate(figures)]
    parts = [
        _head(spec),
        _outcome(scene),
        _section("Errata of the source", _list(spec.errata)) if spec.errata else "",
        _section("Plant", _plant(plant, spec)),
        _section("Faults and noise", prose.timeline(scene)),
        _section("Diagnosis", diagnosis(scene, found) + visible(observability(spec.with_plant(plant))))
        if found
        else "",
        *drawings,
        _section("Comparison", comparison(scene, compared, summary)) if summary else "",
        _section("Observers and their assumptions", observers(scene)) if summary else "",
        _section("Reproduce", _reproduce(result, spec, run_meta)),
    ]
    return _page(escape(spec.title or spec.id), "\n".join(filter(None, parts)), figures)


def _page(title: str, body: str, figures: list[dict]) -> str:
    return (
        f"<!doctype html>\n<html lang=en><head><meta charset=utf-8><title>{title} · Thetascope</title>\n"
        "<meta name=viewport content='width=device-width,initial-scale=1'>\n"
        "<meta http-equiv=Content-Security-Policy content=\"default-src 'none'; script-src 'unsafe-inline'; "
        "style-src 'unsafe-inline'; img-src data: blob:; font-src data:\">\n"
        f"<style>{_asset('report.css')}</style></head>\n<body><main>\n{body}\n</main>\n"
        f"<script type=application/json id=figures>{embedded_json(figures)}</script>\n"
        f"<script>{_script()}</script>\n<script>{_asset('report.js')}</script>\n</body></html>\n"
    )


def _section(title: str | None, body: str) -> str:
    return f"<section>{f'<h2>{escape(title)}</h2>' if title else ''}{body}</section>"


def _list(items) -> str:
    return "<ul>" + "".join(f"<li>{escape(item)}</li>" for item in items) + "</ul>"


def _head(spec) -> str:
    source = f"<p class=soft>{escape(spec.source)}</p>" if spec.source else ""
    text = f"<p>{escape(spec.description)}</p>" if spec.description else ""
    return f"<header><div class=brand>Thetascope · report of a run</div><h1>{escape(spec.title or spec.id)}</h1>{source}{text}</header>"


def _outcome(scene: Scene) -> str:
    """What went wrong, first: divergence of the plant or of observers, and the run's notes."""
    result, lines = scene.result, []
    if result.diverged:
        lines.append(
            f"<p class=alarm>The plant itself diverged at {prose.number(result.diverged.time)} s: "
            f"{escape(result.diverged.cause)}</p>"
        )
    lines += [
        f"<p class=alarm>{escape(r.label)} diverged at {prose.number(r.diverged.time)} s: {escape(r.diverged.cause)}</p>"
        for r in result.observers
        if r.diverged
    ]
    lines += [f"<p class=scope-note>{escape(note)}</p>" for note in result.notes]
    return _section("Notes", "".join(lines)) if lines else ""


def _plant(plant, spec) -> str:
    title = f"<h3>{escape(plant.title or plant.id)}</h3>"
    text = f"<p class=soft>{escape(plant.description)}</p>" if plant.description else ""
    return title + text + prose.equations(plant) + prose.quantities(plant, spec)


def _figure(place: int, meta: dict) -> str:
    caption = f"<figcaption>{escape(meta['caption'])}</figcaption>" if meta["caption"] else ""
    label = escape(f"{meta['title']}. {meta['caption']}")
    return (
        f"<figure><h3>{escape(meta['title'])}</h3>{caption}"
        f'<div class=plot id=plot-{place} role=img aria-label="{label}"></div></figure>'
    )


def _reproduce(result, spec, run_meta: Mapping[str, object]) -> str:
    command = run_meta.get("command") or f"thetascope run {shlex.quote(spec.id + '.json')} --out report.html"
    text = json.dumps(spec.model_dump(mode="json"), ensure_ascii=False, indent=1)
    known = dict(run_meta.get("versions") or versions())
    rows = [
        ["run", f"<code>{escape(run_meta.get('id', '–'))}</code>"],
        ["made", escape(run_meta.get("created", "–"))],
        ["seed", escape(spec.seed)],
        [
            "step",
            f"{prose.number(result.step)} s, observers {result.substeps} per step, horizon {prose.number(spec.horizon, 6)} s",
        ],
        ["versions", escape(", ".join(f"{name} {version}" for name, version in known.items()))],
    ]
    saved = (
        ""
        if run_meta.get("command")
        else f"<p>Save the specification below as <code>{escape(spec.id)}.json</code>, then:</p>"
    )
    body = "".join(f"<tr><th scope=row>{name}</th><td>{value}</td></tr>" for name, value in rows)
    return (
        f"<table class=plain><tbody>{body}</tbody></table>{saved}<pre>{escape(command)}</pre>"
        f"<p class=soft>The same specification gives the same numbers, bit for bit.</p>"
        f"<details><summary>The specification as JSON</summary><pre>{escape(text)}</pre></details>"
    )
