"""Draw a sheet with matplotlib as PDF, SVG or PNG. Fonts come with matplotlib, so files are the same everywhere."""

import io
import os
from typing import TYPE_CHECKING, Any

from thetascope.figures.printed.markup import mathtext
from thetascope.figures.printed.sheet import Curve, Sheet, SheetPanel
from thetascope.messages import Message

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DPI = 600
CM = 1 / 2.54
_FONTS = {
    "times": ("STIXGeneral", "stix", "Noto Serif CJK SC"),
    "sans": ("DejaVu Sans", "dejavusans", "Noto Sans CJK SC"),
    "serif": ("DejaVu Serif", "dejavuserif", "Noto Serif CJK SC"),
}
"""Font → its family, its mathematics, and the family for Chinese that is taken first."""
_CHINESE = ("Noto Sans CJK SC", "Noto Sans SC", "Source Han Sans SC", "Microsoft YaHei", "PingFang SC", "SimSun")
_SHADE = {"colour": "#fbf0d9", "grey": "#ececec"}
_QUIET = "#7f7f7f"


class NoGlyph(ValueError):
    """Raised for a text with characters that no installed font has; `problem` names them."""

    def __init__(self, characters: str) -> None:
        super().__init__(characters)
        self.problem = Message("print.no-glyph", characters=characters)


def printed(sheet: Sheet, format: str, folder: str = "") -> bytes:
    """Return a sheet as a file: pdf with embedded TrueType fonts, svg with outlines, png at 600 dpi.

    folder: where matplotlib keeps its list of fonts; by default its own. The same sheet gives the same bytes.
    Raises NoGlyph.
    """
    if folder:
        os.environ.setdefault("MPLCONFIGDIR", folder)
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(_settings(sheet)):
        width, height = sheet.width * CM, sheet.height * CM
        if format == "png":  # whole pixels
            width, height = ((round(length * DPI) + 0.01) / DPI for length in (width, height))
        figure = Figure(figsize=(width, height), layout="constrained")
        _draw(figure, sheet)
        _check_glyphs(figure)
        file = io.BytesIO()
        figure.savefig(file, format=format, dpi=DPI, metadata=_metadata(sheet, format))
    return file.getvalue()


def _settings(sheet: Sheet) -> dict[Any, Any]:
    """Return matplotlib's settings for a sheet."""
    from matplotlib import font_manager, rcParamsDefault

    family, mathematics, chinese = _FONTS[sheet.font]
    installed = {font.name for font in font_manager.fontManager.ttflist}
    return {
        **{name: value for name, value in rcParamsDefault.items() if not name.startswith(("backend", "date."))},
        "font.family": [family, *(name for name in (chinese, *_CHINESE, "DejaVu Sans") if name in installed)],
        "font.size": sheet.size,
        "mathtext.fontset": mathematics,
        "axes.labelsize": sheet.size,
        "xtick.labelsize": sheet.size,
        "ytick.labelsize": sheet.size,
        "legend.fontsize": sheet.size,
        "axes.linewidth": 0.5,
        "axes.formatter.use_mathtext": True,
        "axes.formatter.limits": (-3, 4),
        "xtick.direction": "in",
        "ytick.direction": "in",
        "xtick.major.width": 0.5,
        "ytick.major.width": 0.5,
        "xtick.minor.width": 0.4,
        "ytick.minor.width": 0.4,
        "xtick.major.size": 2.5,
        "ytick.major.size": 2.5,
        "legend.fancybox": False,
        "legend.framealpha": 1.0,
        "legend.facecolor": "white",
        "legend.edgecolor": "white",
        "legend.borderpad": 0.2,
        "legend.handlelength": 2.6,
        "legend.borderaxespad": 0.3,
        "legend.labelspacing": 0.25,
        "lines.scale_dashes": False,
        "lines.dash_capstyle": "butt",
        "path.simplify": False,
        "pdf.fonttype": 42,
        "svg.fonttype": "path",
        "svg.hashsalt": "thetascope",
    }


def _metadata(sheet: Sheet, format: str) -> dict[str, Any]:
    """Return what the file says about itself; without a date, so that the same run gives the same file."""
    about = sheet.about
    if format == "pdf":
        facts = {"Title": about.title, "Subject": about.caption, "Keywords": about.command}
        return {**facts, "Creator": "Thetascope", "CreationDate": None}
    if format == "svg":
        return {"Title": about.title, "Description": f"{about.caption} {about.command}", "Date": None}
    return {"Title": about.title, "Description": about.caption, "Comment": about.command, "Software": "Thetascope"}


def _draw(figure: "Figure", sheet: Sheet) -> None:
    count = len(sheet.panels)
    shared = sheet.panels[0].shares_x
    axes = figure.subplots(count, 1, sharex=shared, squeeze=False)[:, 0]
    padding = sheet.size / 72 * 0.3
    figure.get_layout_engine().set(w_pad=padding, h_pad=padding / 2, hspace=0.02)  # type: ignore[union-attr]
    for axis, panel in zip(axes, sheet.panels, strict=True):
        _panel(axis, panel, sheet)
        if not shared or axis is axes[-1]:
            axis.set_xlabel(mathtext(panel.x_title))
    figure.align_ylabels(axes)
    _legend(figure, axes, sheet)


def _panel(axis: "Axes", panel: SheetPanel, sheet: Sheet) -> None:
    if panel.log:
        axis.set_yscale("log", nonpositive="mask")
    if sheet.colour in _SHADE:
        for start, end in panel.shade:
            axis.axvspan(start, end, facecolor=_SHADE[sheet.colour], edgecolor="none", zorder=-200)
    marks = (
        (*panel.marks, *(at for interval in panel.shade for at in interval)) if sheet.colour == "black" else panel.marks
    )
    for at in marks:
        axis.axvline(at, color=_QUIET, linewidth=0.5, dashes=(1, 2), zorder=-150)
    if panel.limit is not None:
        axis.axhline(panel.limit, color=_QUIET, linewidth=0.7, dashes=(3, 2), zorder=-140)
    for curve in panel.curves:
        _curve(axis, curve)
    axis.set_ylabel(mathtext(panel.label))
    axis.tick_params(which="both", top=True, right=True)
    if panel.x_limits:
        axis.set_xlim(*panel.x_limits)
    if panel.limits:
        axis.set_ylim(*panel.limits)
    if not panel.log:
        axis.locator_params(axis="y", nbins=5)


def _curve(axis: "Axes", curve: Curve) -> None:
    look = curve.look
    (line,) = axis.plot(curve.x, curve.y, color=look.colour, linewidth=look.width, zorder=2 + curve.layer / 1000)
    if look.dashes:
        line.set_dashes(look.dashes)
    line.set_gid(curve.key or None)


def _legend(figure: "Figure", axes: Any, sheet: Sheet) -> None:
    """Place the legend of all curves, in the first panel or above all; none where one curve needs no name."""
    entries: dict[str, tuple[Any, str]] = {}
    for axis, panel in zip(axes, sheet.panels, strict=True):
        for line, curve in zip(axis.get_lines()[-len(panel.curves) :], panel.curves, strict=True):
            if curve.label:
                entries.setdefault(curve.key, (line, mathtext(curve.label)))
    if sheet.legend == "none" or not entries:
        return
    handles, labels = zip(*entries.values(), strict=True)
    if sheet.legend == "inside":
        axes[0].legend(handles, labels, loc="best")
        return
    columns = min(len(labels), max(1, int(sheet.width / (sheet.size * 0.45))))
    figure.legend(handles, labels, loc="outside upper center", ncols=columns, columnspacing=1.2)


def _check_glyphs(figure: "Figure") -> None:
    """Raise NoGlyph if a text has characters outside of formulas that none of the fonts has."""
    from matplotlib import font_manager, rcParams
    from matplotlib.text import Text

    paths = [font_manager.findfont(name) for name in rcParams["font.family"]]
    known = {code for path in dict.fromkeys(paths) for code in font_manager.get_font(path).get_charmap()}
    texts = [text.get_text() for text in figure.findobj(Text)]
    words = "".join("".join(text.replace(r"\$", "").split("$")[::2]) for text in texts)
    missing = sorted({char for char in words if ord(char) not in known and not char.isspace()})
    if missing:
        raise NoGlyph("".join(missing[:20]))
