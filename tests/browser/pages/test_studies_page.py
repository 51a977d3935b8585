"""The page of studies: one is made in the form, its curves grow, a point opens its run."""

from tests.browser.live_helpers import until
from tests.browser.test_accessibility import AXE, serious
from tests.browser.test_chinese_pages import english


def test_a_study_is_made_in_the_form_and_its_runs_open(page):
    """From Runs: choose what varies, run; curves, tables and both languages; a row opens its run."""
    studies = page("/runs/")
    studies.click("a[href='/studies/']")
    studies.wait_for_selector(".study-form h2")
    studies.select_option(".study-form select", "friction-motor")
    until(studies, "[...document.querySelectorAll('#study-paths option')].some((one) => one.value.includes('ekf'))")
    studies.fill(".study-factor input:first-child", "faults.friction.size")
    studies.fill(".study-factor input:nth-child(2)", "3 9")
    studies.fill(".study-form input[type=number]", "2")
    studies.click(".study-form .run")
    until(studies, "document.querySelector('.study-progress b')?.textContent === '8'")
    until(studies, "document.querySelectorAll('[data-card][data-drawn]').length === 4")
    assert "study=" in studies.url
    assert "friction" in studies.inner_text(".study-sizes .study-under")
    assert "0 of 4" in studies.inner_text(".study-roc .study-under")
    for place, ready in ((2, ".study-confusion td"), (3, ".study-bar-line"), (5, ".study-scroll tbody tr")):
        studies.click(f".study-tabs button:nth-child({place})")
        studies.wait_for_selector(ready)
    studies.evaluate(AXE)
    assert serious(studies) == []
    studies.click(".languages")
    until(
        studies, "[...document.querySelectorAll('.study-form option')].some((one) => one.textContent.includes('摩擦'))"
    )
    studies.click(".study-tabs button:nth-child(3)")
    studies.wait_for_selector(".study-bar-line")
    own = studies.eval_on_selector_all("option[value^='my:']", "all => all.map((one) => one.textContent)")
    assert english(studies) - set(own) == set()
    studies.set_viewport_size({"width": 390, "height": 844})
    assert studies.evaluate("document.documentElement.scrollWidth <= innerWidth")
    studies.set_viewport_size({"width": 1280, "height": 720})
    studies.click(".study-tabs button:nth-child(5)")
    studies.click(".study-scroll tbody tr:first-child button")
    studies.wait_for_url("**/runs/?run=*")
    studies.click("a[href^='/studies/?run=']")
    until(studies, "document.querySelectorAll('#study-paths option').length > 3")
    assert studies.eval_on_selector(".study-form select", "one => one.value") == ""  # the run's own experiment
    assert studies.watch.errors == [] and studies.watch.foreign == []


def test_a_wrong_study_says_what_is_wrong(page):
    """The refusal names the path while one types; an unknown study shows the list."""
    studies = page("/studies/?study=0123456789abcdef0123456789abcdef")
    until(studies, "document.querySelector('.study-progress .alarm')?.textContent.includes('0123456789abcdef')")
    studies.fill(".study-factor input:first-child", "noise.nothing.standard")
    studies.fill(".study-factor input:nth-child(2)", "1 2")
    until(studies, "document.querySelector('.study-form .alarm')?.textContent.includes('standard')")
