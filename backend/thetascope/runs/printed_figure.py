"""A figure of a run for print, for the service and the command line."""

import shlex
from collections.abc import Sequence
from typing import NamedTuple

from thetascope import figures
from thetascope.engine.compiler import cache
from thetascope.figures.printed.draw import NoGlyph, printed
from thetascope.figures.printed.looks import LOOKS
from thetascope.figures.printed.markup import plain
from thetascope.figures.printed.pgf import tikz
from thetascope.figures.printed.sheet import (
    About,
    RefusedChoice,
    Sheet,
    curves_of,
    panel_label,
    sheet,
    styles_of,
)
from thetascope.figures.strips import Drawing
from thetascope.messages import Message
from thetascope.messages.catalogue import negotiate
from thetascope.runs.jobs.job import Finished
from thetascope.runs.specs.refusals import InvalidSpec, Unknown, invalid
from thetascope.runs.specs.resolve_spec import library_experiment, plant_of, resolved
from thetascope_schemas.service.figures.printed_figure import PrintedCurve, PrintedFigure, PrintedPanel, PrintSettings
from thetascope_schemas.texts.refusal import suggestion

MEDIA_TYPES = {
    "pdf": "application/pdf",
    "svg": "image/svg+xml",
    "png": "image/png",
    "tex": "application/x-tex",
    "json": "application/json",
}
_DEFAULTS = PrintSettings()


class Print(NamedTuple):
    """A figure that is ready to be drawn: what is printed, its description, and the name of its file."""

    sheet: Sheet
    description: PrintedFigure
    filename: str


class Printable(NamedTuple):
    """What is said of a drawing for print.

    Args:
        name: of the figure on the command line.
        target: what the command that reproduces it names: a run, several, or an experiment.
        options: further words of that command.
        caption: for below the figure.
        filename: of the file that the command writes.
        span: first and last time in s.
    """

    name: str
    target: str
    options: Sequence[str]
    caption: str
    filename: str
    span: tuple[float, float]


def prepare(
    finished: Finished,
    name: str,
    settings: PrintSettings,
    target: str | None = None,
    changes: Sequence[str] = (),
    filename: str = "",
) -> Print:
    """Return a figure of a run, ready to be drawn.

    target: what the command that reproduces it names; by default the library's experiment if the run is one, else the
    run. changes: path=value, those of the target that the command repeats. filename: of the file that the command
    writes. Raises Unknown for another figure, and InvalidSpec for a curve, panel, style or span that it does not have.
    """
    snapshot, language = finished.snapshot, language_of(settings)
    try:
        drawing = figures.drawing(
            finished.result, snapshot.spec, plant_of(snapshot.spec.plant), name, "light", language
        )
    except figures.UnknownFigure as error:
        hint = Message.from_data(suggestion(name[:80], error.names))
        raise Unknown(Message("figure.unknown", name=name[:80]), hint) from None
    caption = Message("print.caption", title=drawing.title, experiment=snapshot.spec.id, run=snapshot.id[:12])
    t = finished.result.column("t")
    about = Printable(
        name=name,
        target=target or _target(finished),
        options=[part for change in changes for part in ("--set", change)],
        caption=caption.text(language),
        filename=filename or f"{snapshot.spec.id}-{name}-{snapshot.id[:8]}.{settings.format}",
        span=(float(t[0]), float(t[-1])),
    )
    return prepare_drawing(drawing, about, settings)


def prepare_drawing(drawing: Drawing, about: Printable, settings: PrintSettings) -> Print:
    """Return a drawing, ready to be printed. Raises InvalidSpec as `prepare`."""
    command = command_line(about.target, about.name, settings, about.filename, about.options)
    try:
        page = sheet(drawing, settings, About(drawing.title, about.caption, command))
        return Print(page, _description(drawing, page, settings, about), about.filename)
    except RefusedChoice as error:
        known = error.known
        remedy = Message.from_data(suggestion(str(error.value), known)) if known else None
        raise invalid(error.field, error.value, error.problem, remedy) from None


def drawn(page: Sheet, format: str, filename: str) -> bytes:
    """Return the bytes of a sheet as pdf, svg, png or tex. Raises InvalidSpec for characters that no font has."""
    if format == "tex":
        return tikz(page, filename).encode()
    try:
        return printed(page, format, str(cache.folder() / "matplotlib"))
    except NoGlyph as error:
        raise invalid("lang", None, error.problem) from None


def language_of(settings: PrintSettings) -> str:
    """Return the language of the words in the figure: English unless another one is chosen."""
    return negotiate([settings.lang] if settings.lang else [])


def command_line(target: str, name: str, settings: PrintSettings, filename: str, options: Sequence[str] = ()) -> str:
    """Return the command that writes the figure again; `options`: further words of it."""
    language = language_of(settings)
    words = ["thetascope", *(["--language", language] if language != "en" else []), "figure", target, name, *options]
    for option in ("width", "height", "font", "size", "colour", "legend", "start", "end"):
        value = getattr(settings, option)
        if option == "width" or value != getattr(_DEFAULTS, option):
            words += [f"--{option}", f"{value:g}" if isinstance(value, float | int) else value]
    for option, values in (("curve", settings.curves), ("panel", settings.panels), ("style", settings.styles)):
        words += [part for value in values for part in (f"--{option}", str(value))]
    return shlex.join([*words, "--out", filename])


def _target(finished: Finished) -> str:
    """Return the id of the library's experiment that the run is, or else that of the run."""
    snapshot = finished.snapshot
    try:
        same = resolved(library_experiment(snapshot.spec.id)).spec_hash() == snapshot.id
    except (Unknown, InvalidSpec):
        same = False
    return snapshot.spec.id if same else snapshot.id[:16]


def _description(drawing: Drawing, page: Sheet, settings: PrintSettings, about: Printable) -> PrintedFigure:
    styles = styles_of(drawing, settings.styles)
    numbers = settings.panels or range(1, len(drawing.strips) + 1)
    return PrintedFigure(
        title=page.about.title,
        caption=page.about.caption,
        command=page.about.command,
        filename=about.filename,
        width=page.width,
        height=page.height,
        curves=tuple(
            PrintedCurve(
                key=key,
                label=plain(line.legend),
                style=styles[key],  # type: ignore[arg-type]
                drawn=not settings.curves or key in settings.curves,
            )
            for key, line in curves_of(drawing).items()
        ),
        panels=tuple(
            PrintedPanel(number=number, label=plain(panel_label(strip)), drawn=number in numbers)
            for number, strip in enumerate(drawing.strips, start=1)
        ),
        styles=tuple(LOOKS),  # type: ignore[arg-type]
        type_size=page.size,
        thinnest=page.thinnest,
        apart=page.apart,
        span=about.span,
    )
