"""The live page as a whole: dialogs, languages, keys, phone, projector, downloads, accessibility."""

import csv
import io
import re
from pathlib import Path

import pytest

from tests.browser.live_helpers import opened, reload, rested, until

#: With more than a thousand rows.
PAUSED = "/?experiment=zhao-2012&t=12"
#: Labels and names that no language changes.
NAMES = ("adaptive", "Thetascope", "RMSE", "Zhao, Li & Li", "min", "CSV", "MATLAB")
SPOKEN = """() => {
  const words = [];
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const {parentElement: at, data} = walk.currentNode;
    const shown = at.checkVisibility() && !at.closest('noscript, .languages, option, title');
    if (data.trim() && shown) words.push(data.trim());
  }
  for (const one of document.querySelectorAll('[aria-label], [title], [placeholder]')) {
    for (const name of ['aria-label', 'title',
      'placeholder']) if (one.getAttribute(name)) words.push(one.getAttribute(name));
  }
  return words;
}"""


def test_the_equations_are_mathematics_without_script(tab):
    """Plant and observer are MathML; terms of faults are marked, and equations of the paper are numbered."""
    live = opened(tab, PAUSED)
    live.click("#panel-plant .heading .link")
    live.wait_for_selector("dialog math")
    found = live.evaluate("document.querySelectorAll('dialog math').length")
    assert found >= 4 + 6 and live.locator("dialog math .fault").count() == 3
    assert "(34a)" in live.inner_text("dialog")
    live.keyboard.press("Escape")
    assert not live.locator("dialog[open]").count()


def test_in_chinese_no_english_word_of_the_page_is_left(page):
    """After L no English word of the page is visible, and a reload keeps the language."""
    live = opened(page, PAUSED)
    until(live, "thetascope.state.checks.adaptive?.length && thetascope.state.diagnosis?.calibration")
    rested(live)
    english = {word for word in live.evaluate(SPOKEN) if re.search("[a-z]{3}", word)}
    live.keyboard.press("l")
    until(live, "document.documentElement.lang === 'zh-CN'")
    until(live, "document.querySelector('#panel-inject h2')?.textContent === '注入故障'")
    rested(live)
    chinese = set(live.evaluate(SPOKEN))
    same = english & chinese
    assert {word for word in same if not any(name in word for name in NAMES)} == set()
    reload(live)
    until(live, "document.querySelector('#panel-inject h2')?.textContent === '注入故障'")


def test_every_listed_key_works(tab):
    """The help lists the keys for playing, presenting, colours, fault channels and links, and they act."""
    live = opened(tab)
    live.keyboard.press("?")
    assert live.locator("dialog .keys tr").count() >= 15
    live.keyboard.press("Escape")
    live.wait_for_selector("dialog[open]", state="detached")
    until(live, "thetascope.state.playing")
    live.keyboard.press(" ")
    until(live, "!thetascope.state.playing")
    until(live, "thetascope.samples.rows >= thetascope.state.row")
    row = live.evaluate("thetascope.samples.rows")
    live.keyboard.press(".")
    until(live, f"thetascope.samples.rows > {row}")
    live.keyboard.press("p")
    until(live, "document.documentElement.classList.contains('presentation')")
    live.keyboard.press("p")
    live.keyboard.press("t")
    until(live, "document.documentElement.dataset.theme === 'dark'")
    live.keyboard.press("2")
    assert live.evaluate("document.activeElement.closest('.fault').id") == "fault-theta2"
    live.keyboard.press("End")
    assert live.evaluate("Number(document.querySelector('#fault-theta2 input.number').value)") == pytest.approx(0.045)


def test_links_are_offered_to_copy(tab, page, server):
    """Share offers a link that opens a copy and a read-only one, which cannot change the session."""
    live = opened(tab, PAUSED)
    live.click(".actions button:nth-child(1)")
    fields = live.locator("dialog .copy-row input")
    fields.first.wait_for()
    anew, watch = fields.nth(0).input_value(), fields.nth(1).input_value()
    assert "experiment=zhao-2012" in anew and "session=" in watch
    viewer = opened(page, watch.removeprefix(server))
    assert viewer.evaluate("thetascope.state.role") == "view"
    assert viewer.locator("#panel-inject button.press:not(.quiet-press)").evaluate_all(
        "(all) => all.every((one) => one.disabled)"
    )
    assert not viewer.locator(".control-only:visible").count()


def test_the_session_is_downloaded(tab):
    """CSV contains every column up to the present; report and specification are files, too."""
    live = opened(tab, PAUSED)
    live.click(".actions button:nth-child(2)")
    with live.expect_download() as waiting:
        live.click("dialog button:text-is('CSV')")
    rows = list(csv.reader(io.StringIO(Path(waiting.value.path()).read_text())))
    assert rows[0][:2] == ["t", "u.u"] and "adaptive.theta.theta3" in rows[0] and len(rows) > 1000
    for words, suffix in (("Report", ".html"), ("Specification", ".json"), ("SVG", ".svg")):
        with live.expect_download() as waiting:
            live.click(f"dialog button:text-is('{words}')")
        assert waiting.value.suggested_filename.endswith(suffix)


def test_on_a_phone_the_panels_are_behind_tabs(tab):
    """At 390 pixels nothing is wider than the screen, each tab shows its panels only, and the summary is above the
    curves."""
    live = opened(tab, PAUSED, width=390, height=844)
    shown = {
        "curves": "#scope",
        "inject": "#panel-inject",
        "observers": "#panel-observers",
        "diagnosis": "#panel-diagnosis",
    }
    for name in shown:
        live.click(f"#tab-{name}")
        visible = [one for one, selector in shown.items() if live.locator(selector).is_visible()]
        assert visible == ([name, "diagnosis"] if name == "curves" else [name])
        assert live.locator(".verdict").is_visible() == (name in ("curves", "diagnosis"))
        assert live.locator("#panel-diagnosis h2").is_visible() == (name == "diagnosis")
        assert live.evaluate("document.documentElement.scrollWidth") <= 390
    live.click(".more-actions")
    assert live.locator(".actions > button").first.inner_text().strip() == "Share"
    assert live.locator(".actions .marks button").nth(0).inner_text().strip() == "Presentation"


@pytest.mark.parametrize(
    "experiment", ["dts200", "quadruple-tank", "zhou-tan-2012", "shen-hu-2015", "reduced-order-mimo"]
)
def test_other_plants_fill_the_same_panels(tab, experiment):
    """Eleven channels, two outputs, a sandwich system, a plant without inputs: every channel has its row, without
    errors."""
    live = opened(tab, f"/?experiment={experiment}&t=1")
    sites = live.evaluate("thetascope.state.plant.channels.length + thetascope.state.plant.outputs.length")
    assert live.locator("svg.plant .site").count() == sites
    assert live.locator("#panel-inject .fault:not(.noise, .model)").count() == sites
    outside = live.evaluate(
        "(() => { const box = document.querySelector('svg.plant').getBoundingClientRect();"
        " return [...document.querySelectorAll('svg.plant text, svg.plant .site')].filter((one) => { const r = "
        "one.getBoundingClientRect();"
        " return r.left < box.left - 3 || r.right > box.right + 3; }).map((one) => one.textContent); })()"
    )
    assert outside == [] and live.watch.errors == []


def test_symbols_explain_themselves(tab):
    """The pointer or the focus on a strip's symbol shows its sentence within the window; Esc and leaving hide it."""
    live = opened(tab, "/?experiment=zhao-2012&t=12")
    shown = "#explanation:not([hidden])"
    kinds = live.evaluate(
        "[...new Set([...document.querySelectorAll('.strip[data-kind]')].map((e) => e.dataset.kind))]"
    )
    assert {"theta", "state", "residual", "excitation"} <= set(kinds)
    for kind in kinds:
        sign = live.locator(f"[data-kind={kind}] .sign").last
        # in one go: on a busy machine the strip may be drawn anew in between, which hides the sentence
        words, box, described = sign.evaluate(
            """(sign, shown) => {
                sign.focus();
                const sentence = document.querySelector(shown);
                const box = sentence.getBoundingClientRect();
                return [sentence.innerText, [box.left, box.top, box.bottom], sign.getAttribute('aria-describedby')];
            }""",
            shown,
        )
        assert len(words) > 40 and described == "explanation"
        assert box[0] >= 0 and box[1] >= 0 and box[2] <= 900
    live.keyboard.press("Escape")
    assert live.locator(shown).count() == 0
    live.locator("[data-kind=excitation] .sign").hover()
    live.wait_for_selector(shown)
    assert "two faults may look alike" in live.inner_text(shown)
    live.mouse.move(5, 5)
    live.wait_for_selector(shown, state="detached")


def test_the_help_begins_with_the_page(tab):
    """It tells the observer from the detector before it lists keys, and ends with a glossary."""
    live = opened(tab, PAUSED)
    live.keyboard.press("?")
    live.wait_for_selector("dialog[open] .definitions")
    text = live.inner_text("dialog[open] .dialog-body")
    places = [text.index(words) for words in ("An observer", "The detector", "play or pause", "Residual y − ŷ")]
    assert places == sorted(places)
    live.keyboard.press("Escape")
