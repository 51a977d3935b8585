"""Curves of several runs on the same axes, on the page and for print, and the command that draws them again."""

from collections.abc import Callable, Sequence

from thetascope.figures.figure_data import FigureData
from thetascope.figures.overlaid import NothingInCommon, OverlaidRun, overlaid
from thetascope.figures.strips import Drawing
from thetascope.messages import Message
from thetascope.runs.jobs.job import Finished
from thetascope.runs.notebook.comparison import compare_runs
from thetascope.runs.printed_figure import Print, Printable, language_of, prepare_drawing
from thetascope.runs.specs.refusals import NotReady
from thetascope.runs.specs.resolve_spec import plant_of
from thetascope_schemas.service.figures.printed_figure import PrintSettings

OVERLAID, LESS = "overlaid", "less-the-first"
"""The names of these figures on the command line."""


def names_of(runs: Sequence[Finished], given: Callable[[str], str]) -> list[str]:
    """Return a name of each run for legends, all different. given: the name that its owner gave it, or ""."""
    names: list[str] = []
    for run in runs:
        record = run.snapshot.spec.truth.record
        name = given(run.snapshot.id) or (record.name if record is not None else "") or f"r-{run.snapshot.id[:4]}"
        names.append(name if name not in names else f"{name} ({run.snapshot.id[:4]})")
    return names


def overlaid_runs(
    runs: Sequence[Finished],
    names: Sequence[str],
    observer: str | None,
    less: bool,
    theme: str = "light",
    language: str = "en",
) -> Drawing:
    """Return the curves of runs on the same axes; `less`: the differences from the first. Raises NotReady."""
    compared = compare_runs([run.snapshot for run in runs], observer)
    drawn = []
    for run, name, label in zip(runs, names, compared.labels, strict=True):
        spec = run.snapshot.spec
        drawn.append(OverlaidRun(FigureData(run.result, spec, plant_of(spec.plant), theme, language), name, label))
    try:
        return overlaid(drawn, less)
    except NothingInCommon:
        raise NotReady(Message("run.compare-no-curves")) from None


def prepare_overlaid(
    runs: Sequence[Finished],
    names: Sequence[str],
    settings: PrintSettings,
    observer: str | None = None,
    less: bool = False,
    filename: str = "",
) -> Print:
    """Return the curves of runs on the same axes, ready to be drawn. Raises NotReady, and InvalidSpec as `prepare`."""
    language = language_of(settings)
    drawing = overlaid_runs(runs, names, observer, less, "light", language)
    name = LESS if less else OVERLAID
    ids = [run.snapshot.id for run in runs]
    caption = Message("print.caption.runs", title=drawing.title, runs=[id[:12] for id in ids]).text(language)
    times = [run.result.column("t") for run in runs]
    return prepare_drawing(
        drawing,
        Printable(
            name=name,
            target=",".join(id[:16] for id in ids),
            options=() if observer is None else ("--observer", observer),
            caption=caption,
            filename=filename or f"{name}-{'-'.join(id[:4] for id in ids)}.{settings.format}",
            span=(min(float(t[0]) for t in times), max(float(t[-1]) for t in times)),
        ),
        settings,
    )
