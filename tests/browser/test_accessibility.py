"""The pages under axe: all states, large and small, light and dark, both languages."""

from pathlib import Path

import axe_playwright_python
import pytest

from tests.browser.live_helpers import FONTS, SET_FONT, opened

AXE = (Path(axe_playwright_python.__file__).parent / "axe.min.js").read_text() + ";0"
UNFOLD = "for (const one of document.querySelectorAll('.lights, .heading .link[aria-expanded], .dots')) one.click()"
SCROLLS = "scrollable-region-focusable"  # the rule that depends on the font
DIALOGS = {"equations": "e", "share": "s", "keys": "?"}
#: Name → (begin, end, the part of the page that changes).
STATES = {
    "as it opens": ("0", "0", "body"),
    "unfolded": (UNFOLD, UNFOLD, "body"),
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
    "looking back": ("thetascope.act.look(1)", "thetascope.act.look(null)", "body"),
    "zoomed, with a notice": (
        "thetascope.act.select(0.2, 0.8); thetascope.act.tell('a word')",
        "thetascope.act.select(null)",
        "body",
    ),
}


def serious(live, *rules: str, within: str = "body") -> list:
    """Return the serious violations of all rules of axe, or of some, in a part of the page: (rule, elements)."""
    live.wait_for_timeout(300)
    options = {"resultTypes": ["violations"]} | ({"runOnly": list(rules)} if rules else {})
    run = "([part, options]) => axe.run(part === 'body' ? document : document.querySelector(part), options)"
    violations = live.evaluate(run, [within, options])["violations"]
    return [
        (one["id"], [node["target"] for node in one["nodes"]])
        for one in violations
        if one["impact"] in ("serious", "critical")
    ]


def with_faults(page, path: str, **more):
    """Return the page some seconds after a fault and a frozen sensor, with axe loaded."""
    live = opened(page, path, **more)
    live.evaluate("""async () => {
      const {plant: {channels: [channel], outputs: [output]}} = thetascope.state;
      await thetascope.send({type: 'inject', fault: {channel: channel.name, shape: 'step', onset: 0,
        size: channel.typical}});
      await thetascope.send({type: 'inject', fault: {output: output.name, shape: 'freeze', onset: 0}});
      await thetascope.send({type: 'step', rows: 300});
    }""")
    live.evaluate(AXE)
    return live


@pytest.mark.parametrize(
    ("path", "width", "theme", "language"),
    [
        ("/", 1440, "light", "en"),
        ("/?experiment=zhou-tan-2012", 1440, "dark", "zh"),
    ],
)
def test_axe_finds_nothing_serious_in_any_state(page, path, width, theme, language):
    """Unfolded lists, menus and dialogs, looking back, zoom and presentation."""
    live = with_faults(page, path, width=width, height=900, theme=theme)
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
    live.evaluate("document.querySelector('.strip .open').click()")
    live.wait_for_selector(".figure-dialog .js-line", state="attached")
    found["figure"] = serious(live, within=".figure-dialog")
    assert {name: what for name, what in found.items() if what} == {}


@pytest.mark.parametrize(("path", "theme", "language"), [("/", "dark", "en"), ("/?experiment=dts200", "light", "zh")])
def test_axe_finds_nothing_serious_on_a_phone(page, path, theme, language):
    """Every tab, unfolded, and the menu of actions at 390 pixels."""
    live = with_faults(page, path, width=390, height=844, theme=theme)
    live.evaluate(f"thetascope.act.language('{language}')")
    live.evaluate(UNFOLD)
    found = {}
    for tab in ("curves", "inject", "observers", "diagnosis"):
        live.click(f"#tab-{tab}")
        found[tab] = serious(live, within="body" if tab == "curves" else "main")
    live.click(".more-actions")
    found["menu"] = serious(live)
    live.click(".more-actions")
    live.keyboard.press("e")
    live.wait_for_selector("dialog[open] math")
    for font in FONTS:
        live.evaluate(SET_FONT, font)
        found[f"equations {font}"] = serious(live, *([SCROLLS] if font else []))
    assert {name: what for name, what in found.items() if what} == {}


@pytest.mark.parametrize(("theme", "width"), [("light", 1440), ("dark", 390)])
def test_axe_finds_nothing_serious_on_the_page_of_records(page, theme, width):
    """Before and after the diagnosis of a simulated record."""
    shown = page("/records/", width=width, height=900, theme=theme)
    shown.wait_for_selector(".names code")
    shown.evaluate(AXE)
    before = serious(shown)
    shown.click("button:text-is('Simulate a record')")
    shown.wait_for_selector(".buttons [role=status]:has-text('The record is a run')", timeout=60_000)
    shown.click("button.run")
    shown.wait_for_selector(".found", timeout=60_000)
    assert before == serious(shown) == []


def test_axe_finds_nothing_serious_on_the_page_of_plants(page):
    """All plants unfolded at 390 pixels, in narrow and wide fonts: equations that scroll can be focused."""
    shown = page("/plants/", width=390, height=844)
    shown.wait_for_selector(".plant-card")
    shown.evaluate("for (const one of document.querySelectorAll('.plant-card')) one.open = true")
    shown.wait_for_selector(".plant-card:last-of-type math", timeout=60_000)
    shown.evaluate(AXE)
    found = {}
    for font in FONTS:
        shown.evaluate(SET_FONT, font)
        found[font] = serious(shown, *([SCROLLS] if font else []))
    assert {name: what for name, what in found.items() if what} == {}
