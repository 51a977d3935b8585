"""The comparison of observers: room for seven of them, the best in bold, order by a column, and the full table."""

import pytest

from tests.browser.live_helpers import opened, rested, state, until
from tests.browser.test_accessibility import AXE, serious

MANY = [(f"kalman{place}", "adaptive-kalman") for place in range(3)] + [
    ("ekf", "joint-ekf"),
    ("ukf", "joint-ukf"),
    ("high", "high-gain"),
]
#: Lines of the panel that are seen whole, and all of them.
WHOLE = """(() => {
  const list = document.querySelector('#panel-comparison .scroll').getBoundingClientRect();
  const lines = [...document.querySelectorAll('#panel-comparison tbody tr:not(.detector)')];
  return [lines.filter((one) => one.getBoundingClientRect().bottom <= list.bottom + 1.5).length, lines.length];
})()"""
NAMES = "(root) => [...document.querySelectorAll(`${root} tbody th .who`)].map((one) => one.textContent)"
#: The table has figures of all observers over the window.
FILLED = """document.querySelectorAll('#panel-table tbody tr').length === thetascope.state.observers.length
  && [...document.querySelectorAll('#panel-table tbody td:nth-child(2)')].every((one) => one.textContent !== '–')"""


def with_seven(live) -> None:
    """Have seven observers with values in the whole window of 10 s."""
    if live.evaluate("thetascope.state.observers.length") == 7:
        return
    commands = ", ".join(
        f"{{type: 'add-observer', observer: {{label: '{label}', kind: '{kind}', options: {{}}}}}}"
        for label, kind in MANY
    )
    live.evaluate(f"thetascope.act.together([{commands}])")
    until(live, "document.querySelectorAll('#panel-observers .observer').length === 7")
    live.evaluate("thetascope.act.window(10)")
    live.evaluate("thetascope.act.step(1100)")
    until(live, "thetascope.samples.now > 40.9 && !thetascope.state.playing")


def ready(kept_page, width: int = 1440, height: int = 900):
    live = opened(kept_page, "/?experiment=zhao-2012&t=30", width=width, height=height)
    with_seven(live)
    live.evaluate("thetascope.store.dispatch({type: 'set', notice: null})")
    rested(live)
    return live


def test_seven_observers_have_room(kept_page):
    """At 1440 × 900 the panel has a whole line for each; nothing is cut, and two lines of the log remain."""
    live = ready(kept_page)
    live.evaluate("thetascope.act.table(false)")
    rested(live)
    assert live.evaluate(WHOLE) == [7, 7]
    log = live.locator("#panel-log").bounding_box()
    assert log["y"] + log["height"] <= 900 and log["height"] > 70


def test_the_best_are_bold_and_a_heading_sorts(kept_page):
    """The smallest error is bold; the panel is sorted by it, and again as the observers were added."""
    live = ready(kept_page)
    live.evaluate("thetascope.act.table(false)")
    until(live, "document.querySelectorAll('#panel-comparison td.best').length >= 2")
    added = live.evaluate(NAMES, "#panel-comparison")
    assert added == live.evaluate("thetascope.state.observers.map(({label}) => label)")
    live.locator("#panel-comparison .sort").first.click()
    first = "document.querySelector('#panel-comparison tbody tr td')"
    until(live, f"{first}.classList.contains('best')")
    values = live.locator("#panel-comparison tbody tr:not(.detector) td:nth-child(2)").all_inner_texts()
    assert [float(one) for one in values] == sorted(float(one) for one in values)
    live.locator("#panel-comparison .sort").first.click()
    until(live, f"({NAMES})('#panel-comparison').join() === {','.join(added)!r}")


def test_the_full_table_has_every_estimate(kept_page):
    """Opened from the panel: errors of all states and faults, sorted by any column."""
    live = ready(kept_page)
    live.evaluate("thetascope.act.table(false)")
    live.click("[data-open=table]")
    until(live, FILLED)
    keys = live.locator("#panel-table thead [data-key]").evaluate_all("(all) => all.map((one) => one.dataset.key)")
    assert keys[:5] == ["rmse:x.x1", "rmse:x.x2", "rmse:theta.theta1", "rmse:theta.theta2", "rmse:theta.theta3"]
    assert "settle:theta.theta3" in keys and "noise:theta.theta1" in keys
    live.click('#panel-table [data-key="rmse:x.x2"] .sort')
    column = "#panel-table tbody tr td:nth-child(3)"
    until(live, f"document.querySelector('{column}').classList.contains('best')")
    assert live.get_attribute('#panel-table [data-key="rmse:x.x2"]', "aria-sort") == "ascending"
    assert live.evaluate("document.activeElement.closest('[data-key]').dataset.key") == "rmse:x.x2"
    values = live.locator(column).evaluate_all("(all) => all.map((one) => Number(one.dataset.value))")
    assert values == sorted(values)
    assert not live.is_visible("#panel-comparison")  # the same figures, smaller
    live.evaluate(AXE)
    assert serious(live) == []


def test_the_table_fits_and_the_scope_gives_way(kept_page):
    """At 1440 × 900 all seven rows are seen below the scope; closing gives the focus back to the link."""
    live = ready(kept_page)
    live.evaluate("thetascope.act.table(true)")
    until(live, FILLED)
    rested(live)
    sheet, scope = (live.locator(one).bounding_box() for one in ("#panel-table", "#scope"))
    last = live.locator("#panel-table tbody tr").last.bounding_box()
    assert scope["y"] + scope["height"] <= sheet["y"] and sheet["y"] + sheet["height"] <= 900
    assert last["y"] + last["height"] <= sheet["y"] + sheet["height"]
    assert live.evaluate(
        "document.querySelector('#panel-table .wide').scrollWidth - 1 <= "
        "document.querySelector('#panel-table .wide').clientWidth"
    )
    live.click("[data-act=close-table]")
    assert not state(live, "table")
    assert live.evaluate("document.activeElement.dataset.open") == "table"


@pytest.mark.parametrize("width", [1280, 820, 390])
def test_the_table_scrolls_within_its_card(kept_page, width):
    """On narrow pages the card is not wider than the screen; a column left out is gone."""
    live = ready(kept_page, width=width, height=800)
    live.evaluate("thetascope.act.table(true)")
    if width < 720:
        live.click("#tab-observers")
    until(live, FILLED)
    rested(live)
    assert live.is_visible("#panel-table")
    card = live.locator("#panel-table").bounding_box()
    assert card["x"] >= 0 and card["x"] + card["width"] <= width
    live.click("#panel-table .columns-menu summary")
    live.locator("#panel-table .columns-menu input").nth(1).uncheck()
    until(live, "!document.querySelector('#panel-table [data-key=\"rmse:x.x2\"]')")
    live.evaluate("localStorage.removeItem('thetascope.columns.live-comparison')")
    live.evaluate("thetascope.act.table(false)")


def test_the_table_is_downloaded(kept_page):
    """A CSV with a line for each estimate."""
    live = ready(kept_page)
    live.evaluate("thetascope.act.table(true)")
    until(live, FILLED)
    with live.expect_download() as file:
        live.click("#panel-table .link >> text=CSV")
    lines = file.value.path().read_text().split("\n")
    assert lines[0].startswith("observer,estimate,rmse") and any(line.startswith("ekf,theta.theta3,") for line in lines)
