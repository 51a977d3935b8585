"""The pages under axe: all states, large and small, light and dark, both languages."""

from pathlib import Path

import axe_playwright_python
import pytest

from tests.browser.live_helpers import FONTS, SET_FONT, opened, rested, until
from tests.browser.record_files import TANK, checked, csv, read_on, tank_rows

AXE = (Path(axe_playwright_python.__file__).parent / "axe.min.js").read_text() + ";0"
UNFOLD = "for (const one of document.querySelectorAll('.lights, .heading .link[aria-expanded], .dots')) one.click()"
#: The panel Reality with all its sections, a further state and a refused number.
REALITY = """(() => {
  document.querySelector('#panel-truth .heading .link').click();
  for (const one of document.querySelectorAll('#panel-truth details')) one.open = true;
  document.querySelector('.truth-section:last-of-type > .link').click();
  const number = document.querySelector('.truth-row input.number');
  number.value = 'x';
  number.dispatchEvent(new Event('change'));
})()"""
FOLDED = "for (const one of document.querySelectorAll('.truth-foot .link, #panel-truth .heading .link')) one.click()"
#: Colours that fade have their final values: axe measures the contrast of the present ones.
FADED = """(async () => {
  await drawn();
  await Promise.all(document.getAnimations().filter((one) => one.effect?.getComputedTiming().endTime < Infinity)
    .map((one) => one.finished.catch(() => {})));
})()"""
SCROLLS = "scrollable-region-focusable"  # the rule that depends on the font
DIALOGS = {"equations": "e", "share": "s", "keys": "?"}
#: Name → (begin, end, the part of the page that changes).
STATES = {
    "as it opens": ("0", "0", "body"),
    "unfolded": (UNFOLD, UNFOLD, ".left, .right"),
    "reality": (REALITY, FOLDED, ".left"),
    "export": (
        "document.querySelector('.actions button:nth-child(2)').click()",
        "document.querySelector('dialog[open]').close()",
        "dialog[open]",
    ),
    "experiments": (
        "document.querySelector('.experiment').click()",
        "document.querySelector('.experiment').click()",
        "header",
    ),
    "strips": (
        "document.querySelector('.strips-menu').open = true",
        "document.querySelector('.strips-menu').open = false",
        "#scope",
    ),
    "the full comparison": ("thetascope.act.table(true)", "thetascope.act.table(false)", ".centre"),
    "a note": ("document.querySelector('.flag').focus()", "document.activeElement.blur()", ".bar, #panel-log"),
    "a note being written": ("thetascope.act.notes.begin()", "thetascope.act.notes.close()", ".bar"),
    "looking back": ("thetascope.act.look(1)", "thetascope.act.look(null)", "#scope, .bar, .choice"),
    "zoomed, with a notice": (
        "thetascope.act.select(0.2, 0.8); thetascope.act.tell('a word')",
        "thetascope.act.select(null)",
        "#scope, .bar, #notice",
    ),
}


def serious(live, *rules: str, within: str = "body") -> list:
    """Return the serious violations of all rules of axe, or of some, in parts of the page: (rule, elements)."""
    live.evaluate(FADED)
    options = {"resultTypes": ["violations"]} | ({"runOnly": list(rules)} if rules else {})
    parts = None if within == "body" else {"include": [[part.strip()] for part in within.split(",")]}
    violations = live.evaluate("([parts, options]) => axe.run(parts ?? document, options)", [parts, options])
    return [
        (one["id"], [node["target"] for node in one["nodes"]])
        for one in violations["violations"]
        if one["impact"] in ("serious", "critical")
    ]


def with_faults(page, path: str, **more):
    """Return the page some seconds after a fault and a frozen sensor, paused, with axe loaded."""
    live = opened(page, path, **more)
    live.evaluate("""async () => {
      const {plant: {channels: [channel], outputs: [output]}} = thetascope.state;
      await thetascope.send({type: 'inject', fault: {channel: channel.name, shape: 'step', onset: 0,
        size: channel.typical}});
      await thetascope.send({type: 'inject', fault: {output: output.name, shape: 'freeze', onset: 0}});
      await thetascope.send({type: 'add-note', note: {id: 'noted', t: 1, text: 'what is seen here. '.repeat(20)}});
      await thetascope.send({type: 'step', rows: 300});
    }""")
    until(live, "thetascope.samples.rows >= thetascope.state.row && thetascope.state.faults.length > 1")
    until(live, "document.querySelector('.flag')")
    rested(live)
    live.evaluate(AXE)
    return live


@pytest.mark.parametrize(
    ("path", "theme", "language"),
    [("/?experiment=zhao-2012&t=12", "light", "en"), ("/?experiment=zhou-tan-2012&t=2", "dark", "zh")],
)
def test_axe_finds_nothing_serious_in_any_state(tab, path, theme, language):
    """Unfolded lists, menus and dialogs, looking back and zoom."""
    live = with_faults(tab, path, width=1440, height=900, theme=theme)
    live.evaluate(f"thetascope.act.language('{language}')")
    found = {}
    for name, (begin, end, part) in STATES.items():
        live.evaluate(begin)
        found[name] = serious(live, within=part)
        live.evaluate(end)
    for name, key in DIALOGS.items():
        live.evaluate("document.activeElement.blur()")
        live.keyboard.press(key)
        live.wait_for_selector("dialog[open]")
        found[name] = serious(live, within="dialog[open]")
        live.keyboard.press("Escape")
        live.wait_for_selector("dialog[open]", state="detached")
    live.evaluate("document.querySelector('.strip .open').click()")
    live.wait_for_selector(".figure-dialog .js-line", state="attached")
    found["figure"] = serious(live, within=".figure-dialog")
    assert {name: what for name, what in found.items() if what} == {}


@pytest.mark.parametrize(
    ("path", "theme", "language"),
    [("/?experiment=zhao-2012&t=12", "dark", "en"), ("/?experiment=dts200&t=20", "light", "zh")],
)
def test_axe_finds_nothing_serious_on_a_phone(tab, path, theme, language):
    """Every tab, unfolded, and the menu of actions at 390 pixels."""
    live = with_faults(tab, path, width=390, height=844, theme=theme)
    live.evaluate(f"thetascope.act.language('{language}')")
    live.evaluate(UNFOLD)
    found = {}
    for name in ("curves", "inject", "observers", "diagnosis"):
        live.click(f"#tab-{name}")
        found[name] = serious(live, within="body" if name == "curves" else "main")
    live.click(".more-actions")
    found["menu"] = serious(live, within="header")
    live.click(".more-actions")
    live.keyboard.press("e")
    live.wait_for_selector("dialog[open] math")
    for font in FONTS:
        live.evaluate(SET_FONT, font)
        found[f"equations {font}"] = serious(live, *([SCROLLS] if font else []), within="dialog[open]")
    assert {name: what for name, what in found.items() if what} == {}


RECORDS = [("light", 1440), ("dark", 390)]


def test_axe_finds_nothing_serious_on_the_page_of_records(kept_page, tmp_path):
    """Empty, refused, and in all three steps, with a fitted parameter; wide and light, narrow and dark."""
    found = {}

    def look(name: str):
        for theme, width in RECORDS:
            page = kept_page("/records/", width=width, height=900, theme=theme)
            found[name, theme] = serious(page)

    page = kept_page("/records/")
    page.locator("#plant option").nth(2).wait_for(state="attached")
    page.evaluate(AXE)
    look("empty")
    read_on(page, tmp_path, "broken.csv", "t,q,y\n0,1,2\n7\n")
    look("refused")
    rows = tank_rows()
    read_on(page, tmp_path, "tank.csv", csv(rows[:100] + rows[150:]), TANK.replace("value: 0.25", "value: 0.27"))
    look("read")
    checked(page)
    look("checked")
    page.click("#next")
    page.wait_for_selector(".step-3 .verdict")
    page.evaluate("for (const one of document.querySelectorAll('details')) one.open = true")
    look("findings")
    assert {name: what for name, what in found.items() if what} == {}
