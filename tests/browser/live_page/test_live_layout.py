"""The columns of the live page: room, hints at hidden content, and no movement when something opens."""

from itertools import pairwise

import pytest

from tests.browser.live_helpers import FONTS, SET_FONT, opened, rested, until

SIX = [
    ("high", "high-gain"),
    ("second", "adaptive-kalman"),
    ("third", "adaptive-kalman"),
    ("ekf", "joint-ekf"),
    ("ukf", "joint-ukf"),
]
CARDS = """Object.fromEntries([...document.querySelectorAll('.left > .card, .right > .card, #scope')]
  .filter((one) => one.checkVisibility())
  .map((one) => { const {top, bottom, left, right} = one.getBoundingClientRect(); return [one.id, [top, bottom, left,
    right].map(Math.round).join(' ')]; }))"""
#: Lines of a card's list: how many are seen whole, how many in part, how many are there, and what the rim says.
LINES = """(selector) => {
  const all = [...document.querySelectorAll(selector)].filter((one) => one.offsetHeight > 0);
  const list = all[0].closest('.scroll').getBoundingClientRect();
  const whole = all.filter((one) => one.getBoundingClientRect().bottom <= list.bottom + 1.5).length;
  const cut = all.filter((one) => one.getBoundingClientRect().top < list.bottom - 2
    && one.getBoundingClientRect().bottom > list.bottom + 1.5).length;
  return [whole, cut, all.length, all[0].closest('.card').querySelector(':scope > .more-lines').innerText];
}"""
LISTS = {
    "findings": "#panel-diagnosis .scroll > .finding",
    "observers": "#panel-observers .observer",
    "comparison": "#panel-comparison tbody tr",
    "log": "#panel-log li",
    "questions": "#panel-try li",
    "faults": "#panel-inject .faults > .fault",
}


def still(page, path: str, **more):
    live = opened(page, path, **more)
    live.evaluate("thetascope.store.dispatch({type: 'set', notice: null})")
    until(live, "thetascope.state.diagnosis?.calibration")
    rested(live)
    return live


def with_six_observers(live) -> None:
    """Add five observers, unless an earlier test did."""
    if live.evaluate("thetascope.state.observers.length") == 6:
        return
    for label, kind in SIX:
        live.evaluate(
            f"thetascope.send({{type: 'add-observer', observer: {{label: '{label}', kind: '{kind}', options: {{}}}}}})"
        )
    until(live, "document.querySelectorAll('#panel-observers .observer').length === 6")
    until(live, "thetascope.state.observers.every(({label}) => thetascope.state.columns.includes(`${label}.x.x1`))")
    rested(live)


@pytest.mark.parametrize(("width", "height", "whole"), [(1440, 900, 3), (1920, 1080, 3), (1280, 720, 2)])
def test_the_findings_are_visible(kept_page, width, height, whole):
    """Three findings are visible from a laptop's screen on; no list ends with half a line, and each states how many
    follow."""
    live = still(kept_page, "/?experiment=zhao-2012&t=80", width=width, height=height)
    until(live, "document.querySelectorAll('.finding').length === 3")
    rested(live)
    assert live.evaluate(LINES, LISTS["findings"])[0] >= whole
    for name, selector in LISTS.items():
        seen, cut, count, more = live.evaluate(LINES, selector)
        assert cut == 0 and seen >= 1, name
        assert more == ("" if seen == count else f"{count - seen} more ↓"), name
    right = live.locator("#panel-log").bounding_box()
    assert right["y"] + right["height"] <= height


@pytest.mark.parametrize(("width", "height", "least"), [(1440, 900, 5), (1920, 1080, 6), (1280, 720, 3)])
def test_six_observers_take_a_line_each(kept_page, width, height, least):
    """Names and lights are visible or counted; a click on a name opens its gains; two lines of the log remain."""
    live = still(kept_page, "/?experiment=zhao-2012&t=20", width=width, height=height)
    with_six_observers(live)
    seen, cut, count, more = live.evaluate(LINES, LISTS["observers"])
    assert count == 6 and seen >= least and cut == 0 and bool(more) == (seen < 6)
    rows, cut = live.evaluate(LINES, LISTS["comparison"])[:2]
    assert live.evaluate(LINES, LISTS["log"])[0] >= 2 and rows >= 1 and cut == 0
    assert not live.is_visible("#panel-observers .gain input >> nth=0")
    live.click("#panel-observers .unfold >> nth=0")
    assert live.is_visible("#panel-observers .gain input >> nth=0")
    assert live.get_attribute("#panel-observers .unfold >> nth=0", "aria-expanded") == "true"
    live.click("#panel-observers .unfold >> nth=0")


def test_opening_something_moves_no_other_card(tab):
    """Folds of the diagnosis, lights, more settings and measurement faults: every card keeps its place."""
    live = still(tab, "/?experiment=zhao-2012&t=30")
    before = live.evaluate(CARDS)
    links = live.locator("#panel-diagnosis .heading-links button")
    for place in range(2):
        links.nth(place).click()
        fold = live.locator("#panel-diagnosis .fold-out:visible")
        assert fold.bounding_box()["height"] > 80 and live.evaluate(CARDS) == before
        assert live.is_visible(".verdict") and fold.bounding_box()["y"] + fold.bounding_box()["height"] <= 900
    live.keyboard.press("Escape")
    assert (
        live.locator("#panel-diagnosis .fold-out:visible").count() == 0
        and live.evaluate("document.activeElement.textContent") == "Certainty"
    )
    live.click("#panel-observers .lights")
    listed = live.locator("#panel-observers .checks li")
    box = live.locator("#panel-observers .checks").bounding_box()
    assert (
        listed.last.is_visible()
        and live.evaluate(CARDS) == before
        and box["y"] >= 0
        and box["y"] + box["height"] <= 900
    )
    live.keyboard.press("Escape")
    assert not listed.last.is_visible()
    live.click("#panel-inject .dots >> nth=0")
    live.click("#panel-inject .heading .link")
    rested(live)
    assert live.evaluate(CARDS) == before


OVERLAPS = """() => {
  const boxes = (all) => [...document.querySelectorAll(all)].filter((one) => one.checkVisibility())
    .map((one) => [one.className || one.id, one.getBoundingClientRect()]);
  const apart = (a, b) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
  const notices = boxes('.choice:not([hidden]), #notice:not(:empty)');
  const kept = boxes('.logo, .pages a, .connection, .actions button, #timeline .rail, #transport, .strip-plot, '
    + '.legend li, .segments, .menu summary, .heading button');
  return notices.flatMap(([name, box], i) => [...kept, ...notices.slice(i + 1)].filter(([, other]) => !apart(box,
    other))
    .map(([other]) => `${name} / ${other}`));
}"""


@pytest.mark.parametrize(("width", "language"), [(1440, "en"), (1280, "en"), (1280, "zh"), (1920, "zh")])
def test_notices_cover_nothing(kept_page, width, language):
    """In narrow and wide fonts no notice covers the navigation, the connection, the actions, the curves or another
    notice."""
    live = still(kept_page, "/?experiment=zhao-2012&t=30", width=width, height=800)
    live.evaluate(f"thetascope.act.language('{language}')")
    for font in FONTS:
        live.evaluate(SET_FONT, font)
        live.evaluate("thetascope.store.dispatch({type: 'connection', now: 'live'})")
        live.evaluate("thetascope.act.tell('A word that is said for some seconds, and long enough to need its room.')")
        rested(live)
        assert live.is_visible("#notice") and live.evaluate(OVERLAPS) == [], font
        live.evaluate("thetascope.act.look(12)")
        rested(live)
        assert live.is_visible(".choice .run") and live.evaluate(OVERLAPS) == [], font
        live.evaluate("thetascope.act.look(null); thetascope.store.dispatch({type: 'connection', now: 'reconnecting'})")
        live.wait_for_selector("#notice.lost")
        rested(live)
        assert live.evaluate(OVERLAPS) == [], font


#: Buttons and the legend that the notice lies on.
COVERED = """() => {
  const box = document.querySelector('#notice').getBoundingClientRect();
  return [...document.querySelectorAll('button, a[href], input, select, summary, [role=slider], .legend li')]
    .filter((one) => !one.closest('#notice') && one.checkVisibility({opacityProperty: true, visibilityProperty: true}))
    .filter((one) => { const other = one.getBoundingClientRect();
      return other.width > 1 && Math.min(box.right, other.right) - Math.max(box.left, other.left) > 1
        && Math.min(box.bottom, other.bottom) - Math.max(box.top, other.top) > 1; })
    .map((one) => one.id || one.getAttribute('aria-label') || one.textContent || one.className);
}"""


@pytest.mark.parametrize("shown", ["curves", "inject", "observers", "diagnosis"])
def test_a_notice_on_a_phone_covers_no_button(kept_page, shown):
    """On every tab of 390 px, at the top and scrolled, the notice lies on neither the legend nor a button."""
    live = still(kept_page, "/?experiment=zhao-2012&t=30", width=390, height=844)
    live.evaluate("thetascope.act.language('en'); thetascope.act.look(null)")
    live.evaluate(SET_FONT, "")
    live.click(f"#tab-{shown}")
    live.evaluate("thetascope.store.dispatch({type: 'connection', now: 'live'})")
    live.evaluate("thetascope.act.tell('A word that is said for some seconds.')")
    rested(live)
    for down in (0, 60):
        live.evaluate(f"scrollTo({{top: {down}, behavior: 'instant'}})")
        rested(live)
        assert live.is_visible("#notice")
        assert live.evaluate(COVERED) == [], (shown, down)


@pytest.mark.parametrize(("width", "height"), [(1440, 900), (1280, 720)])
def test_notices_cover_no_legend_while_presenting(kept_page, width, height):
    """Between the bar and the legend; also beside the buttons of looking back."""
    live = still(kept_page, "/?experiment=zhao-2012&t=30", width=width, height=height)
    live.evaluate("thetascope.act.language('en'); thetascope.act.look(null); thetascope.act.present(true)")
    live.evaluate("thetascope.store.dispatch({type: 'connection', now: 'live'})")
    live.evaluate("thetascope.act.tell('A word that is said for some seconds.')")
    rested(live)
    assert live.is_visible("#notice") and live.evaluate(COVERED) == []
    live.evaluate("thetascope.act.look(12)")
    rested(live)
    assert live.evaluate(COVERED) == []
    live.evaluate("thetascope.act.look(null); thetascope.act.present(false)")


INSIDE = """((name) => {
  const box = document.querySelector(name).getBoundingClientRect();
  return box.left >= 0 && box.top >= 0 && box.right <= innerWidth && box.bottom <= innerHeight;
})"""
"""Whether an element lies within the window as a whole."""


def test_a_long_notice_is_seen_as_a_whole(page):
    """Why no session could be opened, with the remedy and the button, in a header that is too low for it; at all sizes
    of a window."""
    live = page("/no-page")
    problem = {"title": "The computation was ended", "status": 422, "detail": "words of a reason and its remedy " * 12}
    live.route("**/api/sessions", lambda route: route.fulfill(status=422, json=problem))
    live.goto(live.url.replace("/no-page", "/?experiment=zhao-2012"))
    live.wait_for_selector("#notice button")
    for width, height in ((1440, 900), (1920, 1080), (1280, 720), (390, 844)):
        live.set_viewport_size({"width": width, "height": height})
        for font in FONTS:
            live.evaluate(SET_FONT, font)
            rested(live)
            until(live, f"innerWidth === {width} && ({INSIDE})('#notice')", 30)  # its place follows a moment later


def test_the_hysteresis_fits_on_a_phone(tab):
    """Both drawings, the numbers of the loop and the last operator lie within their card."""
    live = still(tab, "/?experiment=zhou-tan-2012&t=2", width=390, height=844)
    card = live.locator("#hysteresis").bounding_box()
    boxes = [one.bounding_box() for one in live.locator("#hysteresis canvas, #hysteresis figcaption").all()]
    assert len(boxes) == 4 and all(box["y"] + box["height"] <= card["y"] + card["height"] for box in boxes)
    assert all(before["y"] + before["height"] <= after["y"] + 1 for before, after in pairwise(boxes))
    assert live.evaluate(
        "[...document.querySelectorAll('#hysteresis canvas')].every((one) => one.height === "
        "Math.round(one.clientHeight * devicePixelRatio))"
    )
