"""Figures for print: sizes, fonts, line styles and data of the files, each read by another reader."""

import io
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.mathtext import MathTextParser
from PIL import Image

from thetascope import figures, library
from thetascope.figures.html_symbols import HAT, TILDE, symbol
from thetascope.figures.printed.draw import NoGlyph, printed
from thetascope.figures.printed.looks import LOOKS, apart, assign, lightness
from thetascope.figures.printed.markup import latex, mathtext, plain, unit_html
from thetascope.figures.printed.pgf import tikz
from thetascope.figures.printed.sheet import About, RefusedChoice, Sheet, sheet
from thetascope_schemas.service.figures.printed_figure import PrintSettings

ABOUT = About("Faults", "Faults of a run.", "thetascope figure a faults --out a.pdf")


@pytest.fixture(scope="module")
def page(experiment, result, plant):
    """Return a function that makes the sheet of a figure of the run."""
    spec = experiment()
    run = result(spec, lost={"slow": 50.0})

    def make(name: str = "faults", **settings: object) -> Sheet:
        drawing = figures.drawing(run, spec, plant, name, language=str(settings.get("lang", "en")))
        return sheet(drawing, PrintSettings(**settings), ABOUT)

    make.columns = {name: run.column(name) for name in run.names}
    return make


@pytest.mark.parametrize("font", ["times", "sans", "serif"])
def test_a_pdf_has_its_width_and_contains_all_its_fonts_as_truetype(page, font):
    """The page is as wide as chosen, every font has a file, and no font is of Type 3."""
    content = printed(page(width=8.5, height=6.0, font=font), "pdf")
    box = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", content)
    assert [float(size) / 72 * 2.54 for size in box.groups()] == pytest.approx([8.5, 6.0], abs=1e-6)
    fonts = re.findall(rb"/Type /FontDescriptor", content)
    assert len(fonts) == content.count(b"/FontFile2") > 0
    assert b"/Subtype /Type3" not in content and b"/Subtype /Type1" not in content


@pytest.mark.parametrize("width", [3.0, 8.5, 17.5])
def test_a_png_has_600_pixels_an_inch(page, width):
    """The number of pixels is the width in inches times 600, and the file says so."""
    image = Image.open(io.BytesIO(printed(page(width=width, height=4.0, panels=[3]), "png")))
    assert image.size == (round(width / 2.54 * 600), round(4.0 / 2.54 * 600))
    assert image.info["dpi"] == pytest.approx((600, 600), abs=0.01)


def test_an_svg_is_well_formed_and_needs_no_font(page):
    """It has the chosen size, a group for every curve, and no text that depends on installed fonts."""
    root = ElementTree.fromstring(printed(page(width=17.5, height=8.0), "svg"))
    width, height = (float(root.attrib[name].removesuffix("pt")) / 72 * 2.54 for name in ("width", "height"))
    assert (width, height) == (pytest.approx(17.5, abs=1e-6), pytest.approx(8.0, abs=1e-6))
    assert root.findall(".//{http://www.w3.org/2000/svg}text") == []
    assert {"true", "adaptive", "slow"} <= {group.get("id") for group in root.iter("{http://www.w3.org/2000/svg}g")}


def test_the_same_sheet_gives_the_same_bytes(page):
    """Files contain no date and no random name."""
    for format in ("pdf", "svg"):
        assert printed(page(panels=[1]), format) == printed(page(panels=[1]), format)


def tables(source: str) -> list[tuple[list[str], np.ndarray]]:
    """Return names and numbers of every table of a TikZ source."""
    found = re.findall(r"\\pgfplotstableread\{\n(.*?)\n(.*?)\}\{", source, re.DOTALL)
    return [(head.split(), np.array([row.split() for row in body.splitlines()], float)) for head, body in found]


def test_the_tables_of_tikz_are_rows_of_the_run(page):
    """Each number is a float64 of the column that its table names, at the time beside it, within the chosen span."""
    source = tikz(page(format="tex", start=15.0, end=60.0))
    read = tables(source)
    names = [name for name, _ in read]
    assert names == [["t", f"{of}theta.theta{i}"] for i in (1, 2, 3) for of in ("adaptive.", "slow.", "")]
    for (_, column), values in read:
        rows = np.searchsorted(page.columns["t"], values[:, 0])
        assert np.array_equal(page.columns["t"][rows], values[:, 0])
        assert np.array_equal(page.columns[column][rows], values[:, 1], equal_nan=True)
        assert values[0, 0] == 15.0 and values[-1, 0] == 60.0 and len(values) <= 1004
    assert source.count("{") == source.count("}") and source.count(r"\nextgroupplot") == 3


@pytest.mark.parametrize("name", ["states", "outputs", "residuals", "errors", "inputs", "excitation"])
def test_every_figure_of_a_run_can_be_printed(page, name):
    """Each general figure is drawn, and its TikZ source has a table for every curve of every panel."""
    made = page(name, format="tex")
    assert printed(made, "svg").startswith(b"<?xml")
    assert len(tables(tikz(made))) == sum(len(panel.curves) for panel in made.panels)


@pytest.mark.parametrize(
    ("settings", "field"),
    [
        ({"curves": ["adaptive", "none"]}, "curves[1]"),
        ({"panels": [4]}, "panels[0]"),
        ({"styles": ["adaptive=zigzag"]}, "styles[0]"),
        ({"styles": ["none=line"]}, "styles[0]"),
        ({"start": 200.0}, "start"),
        ({"end": 0.001}, "end"),
    ],
)
def test_a_choice_that_the_figure_does_not_have_is_refused_by_field(page, settings, field):
    """The refusal names the field."""
    with pytest.raises(RefusedChoice) as refused:
        page(**settings)
    assert refused.value.field == field


def test_curves_panels_and_styles_are_chosen(page):
    """Panels are in the chosen order, with the chosen curves in the chosen styles."""
    made = page(panels=[3, 1], curves=["true", "slow"], styles=["slow=dots"])
    assert [[curve.source for curve in panel.curves] for panel in made.panels] == [
        ["slow.theta.theta3", "theta.theta3"],
        ["slow.theta.theta1", "theta.theta1"],
    ]
    assert made.looks["slow"].dashes == LOOKS["dots"].dashes


@pytest.mark.parametrize("colour", ["grey", "black", "colour"])
def test_the_curves_of_many_observers_differ_without_colour(colour, experiment, result, plant):
    """Six observers, the truth: dashes, grey or width tell all apart, and only `colour` has colours."""
    labels = [f"o{place}" for place in range(6)]
    spec = experiment(observers=[{"label": o, "kind": "zhao-adaptive", "gains": {"rho": 4}} for o in labels])
    drawing = figures.drawing(result(spec, rows=101), spec, plant, "faults")
    made = sheet(drawing, PrintSettings(colour=colour), ABOUT)
    assert len(made.looks) == 7 and made.apart
    greys = [look.colour for look in made.looks.values() if len(set(re.findall("..", look.colour[1:]))) == 1]
    assert (len(greys) == 7) == (colour != "colour")


def test_styles_that_look_the_same_are_not_called_apart():
    """Two equal styles, and two that differ in colour only, are alike."""
    line = LOOKS["line"]
    assert not apart([line, line]) and apart([line, LOOKS["thin-grey"]]) and apart(LOOKS.values())
    assert lightness("#000000") == 0 and lightness("#ffffff") == pytest.approx(1, abs=1e-6)
    assert assign({"a": "solid", "true": "dash"}, {"a": "dashes"}) == {"a": "dashes", "true": "line"}


def test_symbols_of_the_library_are_formulas_that_matplotlib_reads():
    """Every name of every plant, with and without accents, is set by the parser of mathtext."""
    parser, font = MathTextParser("path"), FontProperties(family="STIXGeneral")
    names = {
        item.name
        for plant in library.plants().values()
        for kind in ("states", "inputs", "outputs", "channels", "signals", "references")
        for item in getattr(plant, kind)
    }
    units = {unit_html(s.unit) for plant in library.plants().values() for s in plant.states if s.unit}
    for source in {symbol(name, accent) for name in names for accent in ("", HAT, TILDE)} | units:
        parser.parse(mathtext(source), 72, font)
        assert "\n" not in latex(source) and plain(source)


@pytest.mark.parametrize(
    ("source", "math", "words"),
    [
        ("<i>θ\u0302</i><sub>12</sub>", r"$\hat{\theta}_{\mathrm{12}}$", "θ\u0302₁₂"),
        ("<i>level</i> (m<sup>2</sup>)", r"$\mathit{level}$ (m${}^{\mathrm{2}}$)", "level (m²)"),
        ("cost &lt; 5 $", r"cost < 5 \$", "cost < 5 $"),
        ("<i>x</i><sub>1</sub> 的误差", "x₁ 的误差", "x₁ 的误差"),
    ],
)
def test_markup_is_written_as_formulas_and_as_plain_text(source, math, words):
    """Accents, indices, powers and special characters keep their meaning."""
    assert (mathtext(source), plain(source)) == (math, words)


@pytest.mark.parametrize(
    ("unit", "shown"), [("1/h2", "1/h²"), ("kg*m^2/s^3", "kg·m²/s³"), ("m3/s", "m³/s"), ("%", "%")]
)
def test_powers_of_units_are_raised(unit, shown):
    """Units are written as a journal wants them."""
    assert plain(unit_html(unit)) == shown


def test_latex_escapes_its_special_characters():
    """A name that a user typed cannot be a command."""
    assert latex(r"50 % of a_b \input{x} #1 & $~^") == (
        r"50 \% of a\_b \textbackslash{}input\{x\} \#1 \& \$\textasciitilde{}\textasciicircum{}"
    )


@pytest.mark.parametrize("write", [latex, mathtext, plain])
@pytest.mark.parametrize("char", ["\r", "\n", "\f", "\v", "\0", "\x1b", "\x7f", "\x85", "\u2028", "&#13;", "&#12;"])
def test_characters_that_command_tex_or_a_terminal_become_blanks(write, char):
    """A carriage return ends a line of TeX and hides the rest of it; a form feed is a paragraph within a label."""
    assert write(f"<i>x</i> (a{char}b)").split("(")[1] == "a b)"


def test_a_character_that_no_font_has_is_refused(page):
    """The refusal names the characters; nothing is printed as an empty box."""
    made = page(panels=[1])
    with pytest.raises(NoGlyph, match="\U00013080"):
        printed(
            Sheet(
                **{**vars(made), "panels": (type(made.panels[0])(**{**vars(made.panels[0]), "label": "\U00013080"}),)}
            ),
            "pdf",
        )
