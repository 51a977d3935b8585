"""The page /runs/ as a notebook: find, choose, name, delete and bring back runs."""

import pytest

from tests.browser.live_helpers import until
from tests.browser.test_accessibility import AXE, serious

ROW = ".runs-table tr[data-run]"
SHORT = {"horizon": 2.0, "evaluate": 0.01}


@pytest.fixture(scope="module")
def ids(server, context) -> list[str]:
    """Return the ids of two short runs."""
    changes = (SHORT, SHORT | {"seed": 3, "observers.adaptive.gains.lambda": 8})
    requests = [{"experiment": "zhao-2012", "set": one} for one in changes]
    answers = [context.request.post(f"{server}/api/runs?wait=60", data=one) for one in requests]
    return [answer.json()["id"] for answer in answers]


def listed(page, id: str, **more):
    """Return the notebook once a run is in it and done."""
    opened = page("/runs/", **more)
    until(opened, f"document.querySelector('[data-run=\"{id}\"] input:enabled')")
    return opened


def test_runs_are_found_named_deleted_and_brought_back(page, ids):
    """With the keyboard and the tray; deleting asks, and Undo brings back the name, too."""
    plain, quick = ids
    opened = listed(page, quick)
    row = opened.locator(f"[data-run='{quick}']")
    assert "λ 4 → 8" in row.inner_text() and "seed 1 → 3" in row.inner_text()
    opened.keyboard.press("/")
    opened.keyboard.type("lambda = 8")
    until(opened, f"document.querySelectorAll('{ROW}').length === 1 && location.search.includes('lambda')")
    row.locator(".dots3").click()
    opened.fill("dialog input[name=name]", "quick")
    opened.fill("dialog input[name=tags]", "fig. 4")
    opened.click("dialog .run")
    until(opened, f"document.querySelector('[data-run=\"{quick}\"] a').textContent === 'quick'")
    assert opened.locator(".shelf button", has_text="fig. 4").count() == 1
    row.locator("input").check()
    opened.click(".tray [data-key=delete]")
    assert "quick" in opened.locator("dialog").inner_text()
    opened.click("dialog .run")
    opened.locator(".notice").get_by_text("Deleted 1 run.").wait_for()
    until(opened, f"!document.querySelector('[data-run=\"{quick}\"]')")
    opened.click(".notice .b")
    until(opened, f"document.querySelector('[data-run=\"{quick}\"] a')?.textContent === 'quick'")
    row.locator(".c-name a").click()
    opened.wait_for_url(f"**experiment=zhao-2012*run={quick}")
    opened.wait_for_selector("h1")
    assert opened.watch.errors == []


@pytest.mark.parametrize(("width", "theme", "language"), [(1280, "dark", "en"), (390, "light", "zh")])
def test_axe_finds_nothing_serious_in_the_notebook(page, ids, width, theme, language):
    """With a chosen run, and on a phone, where the card chooses; nothing is wider than the window."""
    opened = listed(page, ids[1], width=width, height=844, theme=theme)
    if language == "zh":
        opened.click(".top .languages")
        until(opened, "document.documentElement.lang === 'zh-CN' && document.querySelector('[data-run] input:enabled')")
    row = opened.locator(f"[data-run='{ids[1]}']")
    (row.locator(".c-changes") if width < 720 else row.locator("input")).click()
    opened.locator(".tray:not([hidden])").first.wait_for()
    opened.evaluate(AXE)
    assert serious(opened) == []
    assert opened.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert opened.watch.errors == []


def test_two_chosen_runs_are_compared(page, ids):
    """The key C opens curves, settings, measures, notes, differences and a figure for a paper; axe is clean."""
    opened = listed(page, ids[1], theme="dark")
    for id in ids:
        opened.locator(f"[data-run='{id}'] input").check()
    opened.keyboard.press("c")
    opened.wait_for_selector(".compare-curves .plot .js-line", state="attached")
    assert [row.split() for row in opened.locator("tbody").first.inner_text().splitlines()] == [
        ["seed", "1", "3"],
        ["λ", "4", "8"],
    ]
    opened.click(".compare-measures thead button >> nth=0")
    assert opened.locator(".compare-measures [aria-sort=ascending]").count() == 1
    values = [float(text) for text in opened.locator(".compare-measures tbody td:nth-child(2)").all_inner_texts()]
    assert values == sorted(values)
    opened.click(".compare-measures .columns-menu summary")
    opened.locator(".compare-measures .menu-list input").first.uncheck()
    until(opened, "!document.querySelector('.compare-measures thead button').textContent.includes('RMSE of x₁')")
    opened.fill(".compare-notes textarea", "ask for λ = 2")
    opened.click("text=less the first")
    opened.wait_for_selector(".plot[data-drawn*=less]")
    assert opened.locator(".plot .legendtext").count() == 1
    opened.get_by_text("kept with the comparison").wait_for()
    opened.click(".notebook-bar .run")
    until(opened, "document.querySelector('.paper-dialog')?.dataset.state === 'drawn'")
    opened.fill(".paper-dialog [aria-label='Width in cm']", "12.7")
    until(opened, "document.querySelector('.paper-dialog .ruler').textContent.includes('12.7')")
    assert f"{ids[0][:16]},{ids[1][:16]} less-the-first" in opened.inner_text(".paper-dialog form code")
    opened.evaluate(AXE)
    assert serious(opened) == []
    opened.click(".paper-dialog header button")
    opened.reload()
    opened.wait_for_selector(".plot[data-drawn*=less]")
    assert opened.input_value(".compare-notes textarea") == "ask for λ = 2"
    assert "RMSE of x₁" not in opened.inner_text(".compare-measures thead")
    opened.evaluate(AXE)
    assert serious(opened) == [] and opened.watch.errors == []
    opened.set_viewport_size({"width": 390, "height": 844})
    until(opened, "document.documentElement.scrollWidth <= innerWidth")
