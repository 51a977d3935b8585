"""The scope of the live page: its curves, axes, window, zoom, readout and figures, on any screen."""

import re

import pytest

from tests.browser.live_helpers import APP, ready, rested, send, state, until

PAUSED = "/?experiment=zhao-2012&t=30"
SPAN = f"{APP}.span()"


def coloured(page, strip: str, colour: str) -> int:
    """Return how many pixels of a strip's canvas have a colour of the style sheet."""
    return page.evaluate(
        """([strip, name]) => {
      const canvas = document.querySelector(`[data-strip="${strip}"] canvas`);
      const probe = Object.assign(document.createElement('canvas'), {width: canvas.width,
        height: canvas.height}).getContext('2d', {willReadFrequently: true});
      probe.fillStyle = getComputedStyle(document.documentElement).getPropertyValue(name);
      probe.fillRect(0, 0, 1, 1);
      const want = probe.getImageData(0, 0, 1, 1).data;
      probe.clearRect(0, 0, 1, 1);
      probe.drawImage(canvas, 0, 0);
      const {data} = probe.getImageData(0, 0, canvas.width, canvas.height);
      let count = 0;
      for (let i = 0; i < data.length; i += 4) {
        if (data[i + 3] > 200 && [0, 1, 2].every((c) => Math.abs(data[i + c] - want[c]) < 24)) count += 1;
      }
      return count;
    }""",
        [strip, colour],
    )


def looked_at(kept_page, **more):
    """Return the paused page as it opens: nothing zoomed, no pointer on the curves."""
    opened = kept_page(PAUSED, **more)
    ready(opened)
    opened.mouse.move(0, 0)
    opened.evaluate(f"{APP}.act.select(null); {APP}.act.window(30)")
    return opened


def test_the_first_load_shows_a_fault_being_found(page):
    """An empty address plays; a fault begins, an alarm names it, and its estimate comes within 10 %."""
    opened = page("/")
    until(opened, f"{APP}?.state.playing")
    opened.evaluate(f"{APP}.act.pause()")
    opened.evaluate(f"{APP}.act.step(1500)")
    until(opened, f"{APP}.state.alarms.some(({{subject}}) => subject === 'theta3')")
    until(opened, f"Math.abs({APP}.latest('adaptive.theta.theta3') - 0.02) < 0.002")
    rested(opened)
    assert coloured(opened, "theta.theta3", "--o0") > 100 and coloured(opened, "theta.theta3", "--alarm") > 10
    assert opened.watch.errors == [] and opened.watch.foreign == []


def test_every_kind_of_strip_is_shown_with_its_values(kept_page):
    """Faults, states, residual and excitation have a strip each; the numbers beside them are the newest samples."""
    opened = looked_at(kept_page)
    kinds = opened.evaluate("[...document.querySelectorAll('.strip')].map((strip) => strip.dataset.kind)")
    assert kinds == ["theta"] * 3 + ["state"] * 2 + ["residual", "excitation"]
    until(opened, "document.querySelector('[data-strip=\"theta.theta3\"] .strip-values').textContent !== ''")
    shown = opened.inner_text('[data-strip="theta.theta3"] .strip-values').split()
    wanted = opened.evaluate(f"['theta.theta3', 'adaptive.theta.theta3'].map((name) => {APP}.latest(name))")
    assert [float(text.replace("−", "-")) for text in shown] == pytest.approx(wanted, abs=6e-4)


def test_the_window_is_as_long_as_chosen(kept_page):
    """Buttons set the length of the time axis; the last one shows the whole session."""
    opened = looked_at(kept_page)
    for words, length in (("10 s", 10), ("100 s", 100), ("all", 30), ("30 s", 30)):
        opened.click(f".segments button:text-is('{words}')")
        t0, t1 = opened.evaluate(SPAN)
        assert t1 - t0 == pytest.approx(length, abs=0.1)


def test_dragging_zooms_and_a_double_click_returns(kept_page):
    """A drag over any strip shows that span on all; the values are those at its right edge."""
    opened = looked_at(kept_page)
    box = opened.locator('[data-strip="x.x1"] canvas').bounding_box()
    opened.mouse.move(box["x"] + 150, box["y"] + 20)
    opened.mouse.down()
    opened.mouse.move(box["x"] + 300, box["y"] + 25, steps=4)
    opened.mouse.up()
    t0, t1 = opened.evaluate(SPAN)
    assert 3 < t0 < t1 < 20
    opened.mouse.dblclick(box["x"] + 150, box["y"] + 20)
    assert state(opened, "selection") is None


def test_the_pointer_reads_all_strips_at_its_time(kept_page):
    """The time is shown under the pointer, and beside every strip the values at that time."""
    opened = looked_at(kept_page)
    box = opened.locator('[data-strip="theta.theta3"] canvas').bounding_box()
    opened.mouse.move(box["x"] + box["width"] * 0.9, box["y"] + 20)
    until(opened, f"{APP}.state.cursor !== null")
    shown = "document.querySelector('.cursor-time')?.textContent"
    until(opened, f"Math.abs(parseFloat({shown}) - {APP}.state.cursor) < 0.06")
    value = "parseFloat(document.querySelector('[data-strip=\"x.x1\"] .strip-values').innerText.replace('−', '-'))"
    until(opened, f"Math.abs({value} - {APP}.at('x.x1', {APP}.state.cursor)) < 6e-4")
    cursor = state(opened, "cursor")
    assert float(opened.inner_text(".cursor-time").removesuffix(" s")) == pytest.approx(cursor, abs=0.06)
    shown = opened.inner_text('[data-strip="x.x1"] .strip-values').split()[0]
    assert float(shown) == pytest.approx(opened.evaluate(f"{APP}.at('x.x1', {cursor})"), abs=6e-4)


def test_an_axis_contains_the_truth_and_ignores_outliers(kept_page):
    """The truth lies within its axis, also in a new session; the start of an observer does not set the range."""
    opened = looked_at(kept_page)
    rested(opened)
    low, high = opened.evaluate(f"[{APP}.scope.rows.get('x.x1').range.low, {APP}.scope.rows.get('x.x1').range.high]")
    seen = opened.evaluate(f"{APP}.range('x.x1', 0, 30)")
    assert low <= seen["min"] and seen["max"] <= high
    estimate = opened.evaluate(f"{APP}.range('adaptive.x.x1', 0, 30)")
    assert estimate["min"] < low, "the observer's start is off the axis, or this experiment no longer tests it"


def test_strips_can_be_chosen(tab):
    """The menu hides and shows strips; a fault on a hidden channel shows its strip."""
    opened = tab("/?experiment=dts200&t=20")
    ready(opened)
    assert opened.locator('[data-strip="theta.leak3"]').count() == 0
    send(opened, "{type: 'inject', fault: {channel: 'leak3', shape: 'step', onset: 0, size: 0.05}}")
    opened.wait_for_selector('[data-strip="theta.leak3"]')
    opened.click(".strips-menu summary")
    opened.click(".strips-menu label:has-text('leak in tank 3')")
    opened.wait_for_selector('[data-strip="theta.leak3"]', state="detached")


def test_twelve_strips_and_more_scroll_inside_the_scope(tab):
    """With every strip of the three-tank plant none is squeezed, and the page does not grow."""
    opened = tab("/?experiment=dts200&t=20")
    ready(opened)
    opened.evaluate(f"{APP}.strips().forEach(({{name}}) => {APP}.act.strip(name, true))")
    rested(opened)
    heights = opened.evaluate("[...document.querySelectorAll('.strip')].map((strip) => strip.clientHeight)")
    assert len(heights) >= 17 and min(heights) >= 40
    assert opened.evaluate(
        "document.querySelector('.strips').scrollHeight > document.querySelector('.strips').clientHeight"
    )
    assert opened.evaluate("document.documentElement.scrollHeight <= innerHeight")


def test_a_strip_opens_as_a_figure_and_is_saved(kept_page):
    """A strip opens in Plotly with its curves; the scope is exported as SVG; no other host is contacted."""
    opened = looked_at(kept_page)
    opened.hover('[data-strip="theta.theta3"]')
    opened.click('[data-strip="theta.theta3"] .open')
    opened.wait_for_selector(".figure-dialog .js-line", state="attached")
    svg = opened.evaluate(f"{APP}.act.figure({{strip: null, format: 'svg'}}).then((blob) => blob.text())")
    assert svg.startswith("<svg") and len(re.findall(r"js-line", svg)) >= 12
    assert opened.watch.errors == [] and opened.watch.foreign == []


def test_the_sandwich_plant_shows_its_hysteresis(tab, kept_page):
    """The loop and seven operators with their zones in words are drawn for the sandwich plant only."""
    opened = tab("/?experiment=zhou-tan-2012&t=2")
    ready(opened)
    until(opened, "/[1-9].*memory/.test(document.querySelector('#hysteresis .num').textContent)")
    zones = [int(digit) for digit in re.findall(r"\d+", opened.inner_text("#hysteresis .num"))]
    assert sum(zones) == 7
    other = looked_at(kept_page)
    assert not other.locator("#hysteresis").is_visible()


@pytest.mark.parametrize("width", [390, 820, 1180, 1440, 1920])
def test_nothing_is_wider_than_the_screen(kept_page, width):
    """At every width the page scrolls vertically only, and the play button and a strip are visible."""
    opened = looked_at(kept_page, width=width, height=844)
    rested(opened)
    assert opened.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert opened.locator(".play").is_visible() and opened.locator(".strip canvas").first.is_visible()


def test_a_fault_injected_while_paused_is_shown_immediately(tab):
    """It is shown as active everywhere, and after Clear nowhere."""
    opened = tab("/?experiment=zhao-2012&t=15")
    ready(opened)
    lit = "document.querySelectorAll('svg.plant .site.on').length"
    opened.wait_for_selector("svg.plant .site")
    assert coloured(opened, "theta.theta1", "--fault-line") == 0
    send(opened, "{type: 'inject', fault: {channel: 'theta1', shape: 'step', onset: 0, size: 0.012}}")
    until(
        opened,
        f"{lit} === 1 && {APP}.state.faults.at(-1).active && document.querySelectorAll('.finding "
        f".badge.lit').length === 1",
    )
    rested(opened)
    assert not state(opened, "playing") and coloured(opened, "theta.theta1", "--fault-line") > 30
    assert "fault-on" in opened.get_attribute('[data-strip="theta.theta1"]', "class")
    send(opened, "{type: 'clear', channel: 'theta1'}")
    until(
        opened,
        f"{lit} === 0 && !{APP}.state.faults.some(({{active}}) => active) && "
        f"document.querySelectorAll('.finding').length === 0",
    )
