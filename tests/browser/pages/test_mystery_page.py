"""Mystery in a browser: a fault is found, or not; the result is that of the service, and nothing was given away."""

import re

from tests.browser.live_helpers import APP, until
from tests.browser.test_accessibility import AXE, serious
from tests.browser.test_chinese_pages import english

LEAK = "/learn/mystery/?seed=11"
"""Two tanks; the lower one begins to leak at 714 s, which can be told from 786 s on."""


def test_a_leak_is_found_and_the_round_survives_a_reload(page):
    """Played by keyboard: watch, accuse, load the page again, answer; then the points, in both languages, and Live."""
    mystery = page(LEAK)
    mystery.wait_for_selector(".mystery-card")
    mystery.evaluate(AXE)
    assert serious(mystery) == []
    assert mystery.get_attribute("[data-keep=answer]", "aria-disabled") == "true"
    mystery.focus("[data-keep='speed-10']")
    mystery.keyboard.press("Enter")
    mystery.evaluate("document.activeElement.blur()")
    mystery.keyboard.press("Space")
    until(mystery, "parseFloat(document.querySelector('.mystery-clock').textContent) > 800")
    mystery.keyboard.press("2")
    mystery.keyboard.press("a")
    mystery.wait_for_selector(".mystery-claims li")
    mystery.evaluate("document.querySelector('.mystery-play').click()")
    mystery.reload()
    mystery.wait_for_selector(".mystery-claims li")
    assert mystery.is_checked("input[value=leak]")
    assert mystery.locator(".strip").count() == 2, "the difference, and what the leak's observer estimates"
    mystery.focus("[data-keep=onset]")
    mystery.keyboard.press("End")
    mystery.fill("[data-keep=size-field]", "0.0104")
    mystery.keyboard.press("Tab")
    mystery.click("[data-keep=answer]")
    mystery.wait_for_selector(".mystery-result")
    points = re.fullmatch(r"You (\d+), the detector (\d+)", mystery.inner_text("#result-title"))
    assert points and int(points[1]) >= 80 and int(points[2]) >= 90
    assert "both right" in mystery.inner_text(".sentence")
    assert re.search(r"You dated it \d+ s too late", mystery.inner_text(".sentence"))
    mystery.evaluate(AXE)
    assert serious(mystery) == []
    mystery.click(".languages")
    until(mystery, "document.querySelector('#result-title').textContent.includes('检测器')")
    assert english(mystery) == set()
    mystery.reload()
    mystery.wait_for_selector(".mystery-result")
    mystery.click(".mystery-ways .quiet:nth-of-type(3)")
    until(mystery, f"window.thetascope && {APP}.state.spec?.faults.length === 1")
    assert mystery.watch.errors == [] and mystery.watch.foreign == []


def test_a_wrong_name_earns_nothing_on_a_phone(page):
    """A guess at the beginning loses to the detector; everything fits a phone; another round begins afresh."""
    mystery = page(LEAK, width=390, height=844, theme="dark")
    mystery.wait_for_selector(".mystery-card")
    mystery.check("input[value=bias]")
    mystery.click("[data-keep=answer]")
    mystery.wait_for_selector(".mystery-result")
    assert mystery.inner_text("#result-title").startswith("You 0, the detector ")
    assert "you were not" in mystery.inner_text(".sentence")
    assert mystery.evaluate("document.documentElement.scrollWidth <= innerWidth")
    mystery.evaluate(AXE)
    assert serious(mystery) == []
    mystery.click(".mystery-ways .quiet:nth-of-type(2)")
    mystery.wait_for_selector(".mystery-card")
    assert not mystery.is_checked("input[value=bias]")
    mystery.select_option("#mystery-setup", "motor")
    mystery.wait_for_selector("input[value=speed_bias]")
    mystery.goto(mystery.url.split("?")[0].removesuffix("mystery/"))
    mystery.wait_for_selector(".learn-mystery")
    assert "your best 0" in mystery.inner_text(".learn-mystery")
    assert mystery.watch.errors == []
