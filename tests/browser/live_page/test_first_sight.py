"""The first minute on the live page: a sentence below each title, until the visitor hides them."""

from tests.browser.live_helpers import eventually, ready, reload
from tests.browser.test_accessibility import AXE, serious


def shown(page) -> list[str]:
    """Return the names of the panels whose sentence is visible."""
    return page.evaluate(
        "[...document.querySelectorAll('.first-words')].filter((one) => one.checkVisibility())"
        ".map((one) => one.dataset.first)"
    )


def test_every_panel_explains_itself_until_that_is_hidden(page):
    """A new visitor sees a sentence below each title; hidden they stay so after a reload, and ? shows them."""
    live = page("/?experiment=zhao-2012&t=12", width=1600, height=1100, hints=True)
    ready(live)
    every = ["plant", "truth", "inject", "try", "scope", "diagnosis", "observers", "comparison", "log"]
    eventually(lambda: shown(live) == every, "every panel has its sentence")
    assert "Contois bioreactor is running" in live.inner_text(".first-line")
    assert live.evaluate("document.querySelector('#panel-log .heading').nextSibling.matches('.first-words')")
    live.evaluate(AXE)
    assert serious(live) == []
    live.get_by_role("button", name="Hide these hints").click()
    assert shown(live) == [] and not live.is_visible(".first-line")
    reload(live)
    ready(live)
    assert shown(live) == []
    live.keyboard.press("?")
    live.get_by_role("button", name="Show the hints below the titles").click()
    live.keyboard.press("Escape")
    eventually(lambda: shown(live) == every, "every panel has its sentence")


def test_a_small_window_keeps_its_room(page):
    """At 1440×900 the panels that act keep their sentence; lower than that only the line above them is left."""
    live = page("/?experiment=dts200&t=20", width=1440, height=900, hints=True)
    ready(live)
    eventually(lambda: shown(live) == ["plant", "inject", "scope", "diagnosis", "observers"], "the panels that act")
    live.set_viewport_size({"width": 1280, "height": 720})
    assert shown(live) == [] and live.is_visible(".first-line")
    live.set_viewport_size({"width": 390, "height": 844})
    eventually(lambda: live.evaluate("document.documentElement.scrollWidth") == 390, "nothing is wider than a phone")
