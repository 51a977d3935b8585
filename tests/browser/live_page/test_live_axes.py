"""Strips of the live page: axes, outliers, bands, looking back, and exported figures."""

import re
from itertools import pairwise

import pytest

from tests.browser.live_helpers import APP, eventually, ready, rested, state, until

PAUSED = "/?experiment=zhao-2012&t=30"
FOUR = "/?experiment=zhao-2012-observers&t=30"
TANKS = "/?experiment=dts200&t=40"


def settled(tab, path: str, **more):
    """Return the page as it opens, paused, when its axes have come to rest."""
    opened = tab(path, **more)
    ready(opened)
    opened.mouse.move(0, 0)
    rested(opened)
    return opened


def beside(opened, strip: str) -> list[str]:
    return opened.locator(f'[data-strip="{strip}"] .strip-values span').all_inner_texts()


def test_looking_back_shows_that_time(tab):
    """Values and line are those of that time; the clock shows the present, also while the pointer is on the curves."""
    opened = settled(tab, "/?experiment=zhao-2012&t=40")
    opened.evaluate(f"{APP}.act.look(12)")
    until(opened, "document.querySelector('[data-strip=\"theta.theta3\"] .truth').textContent.startsWith('0.0000')")
    truth, estimate = beside(opened, "theta.theta3")
    assert float(truth) == 0 and abs(float(estimate.replace("−", "-"))) < 0.002
    line = opened.locator(".cursor.looked")
    plot = opened.locator('[data-strip="theta.theta3"] canvas').bounding_box()
    left, width = opened.evaluate(f"[{APP}.scope.place.left, {APP}.scope.place.width]")
    assert line.bounding_box()["x"] == pytest.approx(plot["x"] + left + width * 12 / 30, abs=2)
    assert line.inner_text() == "12.0 s" and opened.inner_text(".clock .digits") == "40.0"
    opened.mouse.move(plot["x"] + left + width * 25 / 30, plot["y"] + 20)
    until(opened, "document.querySelector('[data-strip=\"theta.theta3\"] .truth').textContent.startsWith('0.0200')")
    assert opened.inner_text(".clock .digits") == "40.0"


def test_noise_is_never_cut_and_outliers_are_marked(tab):
    """After the start only outliers of x̂₂ leave its axis, each with an arrow at its time; one press shows all."""
    opened = settled(tab, "/?experiment=zhao-2012&t=60")
    low, high = opened.evaluate(f"{APP}.scope.rows.get('x.x2').range.target")
    seen = opened.evaluate(f"{APP}.range('adaptive.x.x2', 42, 60)")
    assert low <= seen["min"] and seen["max"] <= high
    opened.evaluate(f"{APP}.act.select(5, 35)")
    rested(opened)
    arrows = opened.evaluate(f"{APP}.scope.rows.get('x.x2').strip.leaving.map(({{from, to, up}}) => [from, to, up])")
    assert arrows and all(19.5 < start <= end < 22.5 for start, end, _ in arrows)
    show = opened.locator('[data-strip="x.x2"] .all')
    assert show.is_visible() and show.get_attribute("aria-pressed") == "false"
    show.click()
    rested(opened)
    low, high = opened.evaluate(f"{APP}.scope.rows.get('x.x2').range.target")
    seen = opened.evaluate(f"{APP}.range('adaptive.x.x2', 5, 35)")
    assert low <= seen["min"] and seen["max"] <= high and show.get_attribute("aria-pressed") == "true"
    assert state(opened, "selection") == [5, 35], "the press is no zoom"
    box = opened.locator('[data-strip="x.x2"] canvas').bounding_box()
    opened.mouse.dblclick(box["x"] + 20, box["y"] + 20)
    assert show.get_attribute("aria-pressed") == "false" and state(opened, "selection") == [5, 35]


def test_every_band_is_drawn_and_a_name_selects_one(tab):
    """With four observers all bands are drawn on every θ strip; a click or key on a name keeps one, and the legend says
    which."""
    opened = settled(tab, FOUR)
    labels = opened.evaluate(f"{APP}.state.observers.map(({{label}}) => label)")
    assert opened.evaluate(f"[...{APP}.scope.bands()]") == labels
    assert (
        opened.inner_text(".legend [data-mark=band]") == "±2σ of noise" and opened.locator(".bands .key").count() == 4
    )
    name = opened.locator(".legend .name:text-is('ekf')")
    name.focus()
    opened.keyboard.press("Enter")
    until(opened, f"{APP}.state.band === 'ekf'")
    assert opened.evaluate(f"[...{APP}.scope.bands()]") == ["ekf"] and "±2σ of noise, ekf" in opened.inner_text(
        ".legend [data-mark=band]"
    )
    assert (
        name.get_attribute("aria-pressed") == "true" and opened.evaluate("document.activeElement.textContent") == "ekf"
    )
    opened.click(".legend [data-mark=band] .link")
    assert opened.evaluate(f"[...{APP}.scope.bands()]") == labels


@pytest.mark.parametrize(
    ("path", "width", "height"),
    [(PAUSED, 1280, 800), ("/?experiment=dc-motor&t=2", 1440, 900), (TANKS, 1280, 720), (FOUR, 1440, 900)],
)
def test_the_legend_is_complete(tab, path, width, height):
    """With many observers, too, on at most two lines."""
    opened = settled(tab, path, width=width, height=height)
    marks = opened.evaluate(
        "[...document.querySelectorAll('.legend li')].map((one) => [one.innerText.trim(), one.offsetTop])"
    )
    words = [text for text, _ in marks]
    assert all(words) and {"true", "fault active", "alarm"} <= set(words) and any("±2σ" in text for text in words)
    assert len({top // 12 for _, top in marks}) <= 2
    assert set(opened.evaluate(f"{APP}.state.observers.map(({{label}}) => label)")) <= set(words)


def test_all_strips_of_the_tanks_are_visible_on_a_small_screen(tab):
    """At 1280×720 eleven strips fit: none is cut, none overlaps, nothing needs scrolling."""
    opened = settled(tab, "/?experiment=dts200&t=700", width=1280, height=720)
    boxes = opened.evaluate(
        "[...document.querySelectorAll('.strip')].map((one) => { const {top, bottom} = "
        "one.querySelector('canvas').getBoundingClientRect(); return [top, bottom]; })"
    )
    assert len(boxes) == 11 and all(after[0] - before[1] >= 3 for before, after in pairwise(boxes))
    until(
        opened, "document.querySelector('.strips').scrollHeight <= document.querySelector('.strips').clientHeight + 1"
    )
    labels = opened.evaluate(
        "[...document.querySelectorAll('.strip')].map((one) => "
        "one.querySelector('.strip-label').getBoundingClientRect().bottom - one.getBoundingClientRect().bottom)"
    )
    assert max(labels) <= 1


def test_a_strip_without_values_gives_the_reason(tab):
    """If no observer has an excitation yet, its strip says why."""
    opened = settled(tab, "/?experiment=friction-motor&t=10")
    until(
        opened,
        "/shorter than the window of 12 s/.test(document.querySelector('[data-strip=excitation] "
        ".unresolved').innerText)",
    )


def test_marks_are_explained(tab):
    """The pointer on an alarm or the timeline shows an explanation; the help lists every mark in both languages."""
    opened = settled(tab, PAUSED)
    t = opened.evaluate(f"{APP}.state.alarms[0].t")
    canvas = opened.locator('[data-strip="theta.theta3"] canvas')

    def explained(share: float, down: float) -> str | None:
        """Point at a share of the strip's width anew, since the layout may still move; return the explanation."""
        box = canvas.bounding_box()
        left, width = opened.evaluate(f"[{APP}.scope.place.left, {APP}.scope.place.width]")
        opened.mouse.move(box["x"] + left + width * share, box["y"] + down)
        return canvas.get_attribute("title")

    eventually(lambda: "an alarm that names this channel" in (explained(t / 30, 5) or ""), "the mark is explained")
    eventually(lambda: explained(0.5, 40) == "", "the explanation goes")
    rail = opened.locator(".rail").bounding_box()
    opened.mouse.move(rail["x"] + rail["width"] * t / 100, rail["y"] + 10)
    eventually(lambda: "alarm: θ₃" in (opened.get_attribute(".rail", "title") or ""), "the alarm is explained")
    for language, words in (("en", "the interval"), ("zh", "区间")):
        opened.evaluate(f"{APP}.act.language('{language}')")
        opened.keyboard.press("?")
        opened.wait_for_selector(".marks-list tr")
        assert opened.locator(".marks-list tr").count() == 14 and words in opened.inner_text(".marks-list")
        opened.keyboard.press("Escape")


def test_a_figure_has_its_marks_and_their_legend(tab):
    """The exported scope contains alarms, threshold, tint and bands, each with its legend."""
    opened = settled(tab, PAUSED)
    svg = opened.evaluate(f"{APP}.act.figure({{strip: null, format: 'svg'}}).then((blob) => blob.text())")
    for words in ("alarm", "fault active", "±2σ of noise, adaptive", "required excitation"):
        assert words in svg, words
    assert "▼" in svg and len(re.findall(r"stroke-dasharray", svg)) >= 4
