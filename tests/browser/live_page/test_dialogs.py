"""Dialogs of the live page: keys after closing, and exports that the server takes long to compute."""

import json

import pytest

from tests.browser.live_helpers import opened, state, until

EXPORT = ".actions button:nth-child(2)"
OPENED = "document.querySelector('dialog[open]') !== null"


@pytest.mark.parametrize("way", ["mouse", "Enter", "key"])
def test_space_plays_after_escape_has_closed_a_dialog(tab, way):
    """However it was opened, Space then pauses the session and does not reopen it; Enter on its button does."""
    live = opened(tab)
    if way == "mouse":
        live.click(EXPORT)
    elif way == "Enter":
        live.focus(EXPORT)
        live.keyboard.press("Enter")
    else:
        live.keyboard.press("e")
    until(live, OPENED)
    live.keyboard.press("Escape")
    until(live, f"!({OPENED})")
    until(live, "thetascope.state.playing")
    live.keyboard.press(" ")
    until(live, "!thetascope.state.playing")
    assert not live.evaluate(OPENED)
    live.focus(EXPORT)
    live.keyboard.press("Enter")
    until(live, OPENED)


def test_a_dialog_that_is_opened_as_another_closes_keeps_its_content(tab):
    """The browser reports that a dialog was closed when the next one is open already."""
    live = opened(tab)
    live.keyboard.press("e")
    until(live, OPENED)
    live.evaluate("""async () => {
      const dialog = document.querySelector('dialog[open]');
      const reported = new Promise((done) => dialog.addEventListener('close', done));
      dialog.close();
      document.body.dispatchEvent(new KeyboardEvent('keydown', {key: 's', bubbles: true}));
      await reported;
    }""")
    assert live.locator("dialog[open] .dialog-body").count() == 1


def test_focus_that_returns_late_leaves_space_to_the_page(tab):
    """The browser may give the focus back a frame after Escape: Space pauses then, too."""
    live = opened(tab)
    until(live, "thetascope.state.playing")
    live.keyboard.press("Escape")
    live.wait_for_timeout(100)
    live.focus(EXPORT)
    live.keyboard.press(" ")
    until(live, "!thetascope.state.playing")
    assert not live.evaluate(OPENED)


def test_space_presses_a_button_that_was_reached_by_tab(tab):
    """With keyboard navigation Space keeps its meaning in the browser."""
    live = opened(tab)
    live.focus(".actions button:nth-child(1)")
    live.keyboard.press("Tab")
    live.keyboard.press(" ")
    until(live, OPENED)


def test_an_export_waits_for_a_long_run(page):
    """The server answers 202 with the progress, without a spec:
    the specification is downloaded when the run has ended."""
    live = opened(page, "/?experiment=zhao-2012&t=3")

    def accepted(route):
        """Answer as the server does when a run exceeds the waiting time of a request."""
        run = json.loads(route.fetch().text())
        part = {key: run[key] for key in ("id", "links")} | {"status": "running", "progress": 0.5, "detail": ""}
        route.fulfill(status=202, json=part)

    live.route("**/save", accepted)
    live.click(EXPORT)
    with live.expect_download() as download:
        live.click("dialog[open] button:text-is('Specification')")
    spec = json.loads(download.value.path().read_text())
    assert spec["id"] == "zhao-2012" and download.value.suggested_filename.startswith("zhao-2012-")
    assert live.watch.errors == []


def test_a_viewer_downloads_the_displayed_data(tab, page):
    """Without the token a session cannot be saved as a run; its data can be downloaded as displayed."""
    live = opened(tab, "/?experiment=zhao-2012&t=3")
    viewer = page(f"/?session={state(live, 'session')}")
    until(viewer, "window.thetascope?.state.role === 'view' && thetascope.samples.rows > 300")
    viewer.click(EXPORT)
    assert viewer.locator("dialog[open] button:text-is('Specification')").count() == 0
    with viewer.expect_download() as download:
        viewer.click("dialog[open] button:text-is('CSV')")
    head, first = download.value.path().read_text().splitlines()[:2]
    assert head.startswith("t,") and first.startswith("0") and viewer.watch.errors == []


def test_escape_closes_a_dialog_wherever_the_focus_is(tab):
    """A click on the title of a dialog takes the focus out of it; Escape closes it all the same."""
    live = opened(tab)
    live.keyboard.press("s")
    until(live, OPENED)
    live.click("#dialog-title")
    live.evaluate("document.activeElement.blur()")
    assert live.evaluate("document.activeElement === document.body")
    live.keyboard.press("Escape")
    until(live, f"!({OPENED})")


def test_contents_that_come_late_do_not_replace_those_of_the_next_dialog(tab):
    """The links to share are computed when the equations are shown already."""
    live = opened(tab)
    live.evaluate("""() => {
      const link = thetascope.act.link;
      const released = new Promise((done) => { window.release = done; });
      thetascope.act.link = async (...options) => {
        await released;
        return link(...options);
      };
    }""")
    live.keyboard.press("s")
    until(live, OPENED)
    live.keyboard.press("Escape")
    until(live, f"!({OPENED})")
    live.keyboard.press("e")
    until(live, "document.querySelector('dialog[open] math') !== null")
    live.evaluate("window.release()")
    live.wait_for_timeout(200)
    assert live.evaluate("document.querySelector('dialog[open] math') !== null")
