"""Write a sheet as TikZ: a groupplot of pgfplots with the run's values in tables. TeX is not needed to write it."""

from thetascope.figures.printed.looks import Look
from thetascope.figures.printed.markup import latex, plain
from thetascope.figures.printed.sheet import Curve, Sheet, SheetPanel

_FONTS = {"times": "", "serif": "", "sans": r"\sffamily"}
_HEAD = r"""% {title}
% {caption}
% Drawn again by: {command}
% In the preamble: \usepackage{{pgfplots}} \usepgfplotslibrary{{groupplots}} \pgfplotsset{{compat=1.16}}
% {chinese}In the text: \input{{{name}}}
"""


def tikz(sheet: Sheet, name: str = "figure.tex") -> str:
    """Return the source of a picture; its columns of numbers read back to exactly the run's float64.

    Every curve has a table, whose columns are named after those of the run.
    """
    about = sheet.about
    texts = (about.title, *(panel.label + panel.x_title for panel in sheet.panels))
    chinese = "" if all(ord(char) < 0x2E80 for text in texts for char in text) else r"Chinese: \usepackage{ctex}. "
    head = {key: " ".join(value.split()) for key, value in vars(about).items()}
    out = [_HEAD.format(**head, name=name, chinese=chinese)]
    tables = [_tables(panel, place) for place, panel in enumerate(sheet.panels)]
    out += [text for panel in tables for text, _ in panel]
    out.append(_begin(sheet))
    for place, (panel, named) in enumerate(zip(sheet.panels, tables, strict=True)):
        out.append(_axis(sheet, place))
        out += _background(panel, sheet)
        for curve, (_, table) in zip(panel.curves, named, strict=True):
            out.append(_plot(curve, _x_name(panel), table))
    out.append("\\end{groupplot}\n\\end{tikzpicture}\n")
    return "".join(out)


def _tables(panel: SheetPanel, place: int) -> list[tuple[str, str]]:
    """Return the table of every curve and the command that holds it."""
    tables = []
    for number, curve in enumerate(panel.curves):
        command = f"\\thetascope{_letters(place)}x{_letters(number)}"
        rows = "".join(f"{x!r} {y!r}\n" for x, y in zip(curve.x.tolist(), curve.y.tolist(), strict=True))
        tables.append((f"\\pgfplotstableread{{\n{_x_name(panel)} {column(curve)}\n{rows}}}{{{command}}}\n", command))
    return tables


def column(curve: Curve) -> str:
    """Return the name of a curve's column in its table: its source without blanks and characters of TeX."""
    return (
        "".join(char if char.isalnum() or char in ".-|" else "-" if char == "_" else "" for char in curve.source) or "y"
    )


def _x_name(panel: SheetPanel) -> str:
    return "t" if panel.x_limits else "x"


def _letters(number: int) -> str:
    """Return a number as letters, of which commands of TeX consist: 0 → a, 25 → z, 26 → ba."""
    digits = ""
    while True:
        digits = chr(97 + number % 26) + digits
        number //= 26
        if number == 0:
            return digits


def _begin(sheet: Sheet) -> str:
    count = len(sheet.panels)
    shared = sheet.panels[0].shares_x
    gap = "0.2cm" if shared else "1.2cm"
    height = (sheet.height - 1.1 - (count - 1) * (0.2 if shared else 1.2)) / count
    names = _FONTS[sheet.font]
    options = [
        f"group style={{group size=1 by {count}, vertical sep={gap}"
        + (", x descriptions at=edge bottom}" if shared else "}"),
        "scale only axis",
        f"width={max(sheet.width - 1.6, 1):.4g}cm, height={max(height, 0.5):.4g}cm",
        "tick align=inside, axis line style={line width=0.5pt}, tick style={line width=0.5pt, black}",
        "unbounded coords=jump, legend cell align=left, label style={font=\\thetascopefont}",
        "tick label style={font=\\thetascopefont}, legend style={draw=none, fill=none, font=\\thetascopefont}",
        "every axis plot/.append style={no markers}, axis on top",
    ]
    font = f"\\def\\thetascopefont{{{names}\\fontsize{{{sheet.size:g}}}{{{1.2 * sheet.size:.4g}}}\\selectfont}}\n"
    return font + "\\begin{tikzpicture}\n\\begin{groupplot}[\n  " + ",\n  ".join(options) + ",\n]\n"


def _axis(sheet: Sheet, place: int) -> str:
    panel = sheet.panels[place]
    options = [f"ylabel={{{latex(panel.label)}}}", f"xlabel={{{latex(panel.x_title)}}}"]
    if panel.log:
        options.append("ymode=log")
    if panel.x_limits:
        options.append(f"xmin={panel.x_limits[0]!r}, xmax={panel.x_limits[1]!r}")
    if panel.limits:
        options.append(f"ymin={panel.limits[0]!r}, ymax={panel.limits[1]!r}")
    entries = {curve.key: curve for curve in panel.curves if curve.label}
    if place == 0 and sheet.legend == "above":
        at = "at={(0.5,1.03)}, anchor=south, legend columns=-1, /tikz/every even column/.append style={column sep=6pt}"
        options.append(f"legend style={{{at}}}")
    elif place == 0 and entries:
        options.append("legend pos=north east")
    return "\\nextgroupplot[" + ", ".join(options) + "]\n" + _legend(sheet, place)


def _legend(sheet: Sheet, place: int) -> str:
    """Return the legend of all panels' curves for the first panel."""
    if place or sheet.legend == "none":
        return ""
    curves: dict[str, Curve] = {}
    for curve in (curve for panel in sheet.panels for curve in panel.curves if curve.label):
        curves.setdefault(curve.key, curve)
    return "".join(
        f"\\addlegendimage{{{_style(curve.look)}}}\\addlegendentry{{{latex(curve.label)}}}\n"
        for curve in curves.values()
    )


def _background(panel: SheetPanel, sheet: Sheet) -> list[str]:
    """Return the intervals of faults, and the hairlines where other faults begin or end."""
    if panel.limits is None:
        return []
    lines, (bottom, top) = [], panel.limits
    across = f"(axis cs:{{a!r}},{bottom!r}) {{shape}} (axis cs:{{b!r}},{top!r})"
    if sheet.colour != "black":
        lines += [f"\\path[fill=black!8] {across.format(a=a, b=b, shape='rectangle')};\n" for a, b in panel.shade]
    marks = (*panel.marks, *(at for pair in panel.shade for at in pair)) if sheet.colour == "black" else panel.marks
    lines += [
        f"\\draw[black!50, line width=0.5pt, dash pattern=on 1pt off 2pt] {across.format(a=at, b=at, shape='--')};\n"
        for at in marks
    ]
    if panel.limit is not None and panel.x_limits:
        low, high = panel.x_limits
        line = f"(axis cs:{low!r},{panel.limit!r}) -- (axis cs:{high!r},{panel.limit!r})"
        lines.append(f"\\draw[black!50, line width=0.7pt, dash pattern=on 3pt off 2pt] {line};\n")
    return lines


def _plot(curve: Curve, x: str, table: str) -> str:
    comment = f" % {plain(curve.label)}: {curve.source}" if curve.label else f" % {curve.source}"
    return f"\\addplot[forget plot, {_style(curve.look)}] table[x={x}, y={{{column(curve)}}}] {{{table}}};{comment}\n"


def _style(look: Look) -> str:
    """Return a line style as options of TikZ; colours by their parts, so that none must be defined."""
    red, green, blue = (int(look.colour[place : place + 2], 16) for place in (1, 3, 5))
    pairs = zip(look.dashes[::2], look.dashes[1::2], strict=True)
    dashes = " ".join(f"on {on:g}pt off {off:g}pt" for on, off in pairs)
    parts = [
        f"color={{rgb,255:red,{red};green,{green};blue,{blue}}}",
        f"line width={look.width:g}pt",
        f"dash pattern={dashes}" if dashes else "solid",
    ]
    return ", ".join(parts)
