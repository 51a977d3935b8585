"""The pages of the papers in a browser: numbers are measured, evidence is replayed, figures are drawn."""

from tests.browser.live_helpers import until
from tests.browser.test_accessibility import AXE, serious
from tests.browser.test_chinese_pages import english


def test_a_paper_is_read_and_its_evidence_replayed(page):
    """From Learn to a paper: numbers agree, the escape is replayed with its figure, then the paper in Chinese."""
    papers = page("/learn/")
    papers.click("a[href='/learn/papers/']")
    papers.wait_for_selector(".papers-equations math")
    until(papers, "document.querySelectorAll('#numbers .papers-agrees').length === 10")
    assert papers.locator("#numbers .alarm").count() == 0
    papers.click(".papers-errata li:first-child button")
    until(papers, "document.querySelector('.papers-evidence [data-figure=escape]')?.dataset.drawn === ''")
    assert "0.7 s" in papers.inner_text(".papers-evidence li")
    papers.evaluate("document.querySelector('#figures').scrollIntoView()")
    until(papers, "document.querySelector('#figures [data-figure=states]').dataset.drawn === ''")
    until(papers, "document.querySelector('#checks .checks') !== null")
    papers.evaluate(AXE)
    assert serious(papers) == []
    papers.click(".languages")
    until(papers, "document.querySelector('h1').textContent === '一类非线性系统的自适应观测器设计'")
    until(papers, "document.querySelectorAll('#numbers .papers-agrees').length === 10")
    assert english(papers) == set()
    assert papers.watch.errors == [] and papers.watch.foreign == []


def test_every_paper_fits_a_phone(page):
    """All four at 390 px in the dark: no scrolling sideways, numbers agree; a paper that is not there says so."""
    papers = page("/learn/papers/?paper=shen-hu-2015", width=390, height=844, theme="dark")
    for id in ("shen-hu-2015", "reduced-order-mimo", "zhou-tan-2012"):
        papers.goto(papers.url.split("?")[0] + f"?paper={id}")
        until(papers, "document.querySelectorAll('#numbers td:nth-child(3) span').length > 3")
        assert papers.locator("#numbers .alarm").count() == 0, id
        assert papers.evaluate("document.documentElement.scrollWidth <= innerWidth"), id
    papers.evaluate(AXE)
    assert serious(papers) == []
    papers.goto(papers.url.split("?")[0] + "?paper=none")
    papers.wait_for_selector("main .alarm")
    assert "none" in papers.inner_text("main .alarm")
