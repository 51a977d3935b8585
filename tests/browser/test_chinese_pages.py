"""A walk through the pages in Chinese: no visible text is an English sentence."""

import re

from tests.browser.live_helpers import opened, rested, until
from thetascope import library
from thetascope.engine.observers import registry
from thetascope.messages.catalogue import languages
from thetascope_schemas.texts.local_text import in_language

SENTENCE = re.compile(r"[A-Za-z][a-z’'-]*[a-z](?:,? [A-Za-z]?[a-z’'-]*[a-z]){2,}")  # three Latin words in a row
READ = """(html) => {
  const root = html ? new DOMParser().parseFromString(html, 'text/html') : document;
  const shown = (element) => html || element.checkVisibility();
  const walk = root.createTreeWalker(root.body, NodeFilter.SHOW_TEXT);
  const found = [];
  for (let node = walk.nextNode(); node; node = walk.nextNode()) {
    const element = node.parentElement;
    const skipped = 'script, style, noscript, code, kbd, math, textarea, pre, .source, [lang=en]';
    if (shown(element) && !element.closest(skipped)) found.push(node.data);
  }
  for (const element of root.querySelectorAll('[title], [aria-label], [placeholder], [alt], [data-title]'))
    if (shown(element))
      for (const name of ['title', 'aria-label', 'placeholder', 'alt', 'data-title'])
        found.push(element.getAttribute(name) ?? '');
  return found.map((text) => text.trim()).filter(Boolean);
}"""


def sources() -> list[str]:
    """Return the citations of the library: titles of papers are cited as they were printed."""
    texts = [one.source for one in (*library.plants().values(), *library.experiments().values())]
    cited = {in_language(text, language) for text in texts for language in languages()}
    cited |= {str(registry.observer(kind).source) for kind in registry.kinds()}
    return sorted(filter(None, cited), key=len, reverse=True)


CITED = sources()


def sentences(texts: list[str]) -> set[str]:
    """Return the texts that hold an English sentence, citations aside."""
    found = set()
    for text in texts:
        rest = text
        for source in CITED:
            rest = rest.replace(source, "")
        if SENTENCE.search(rest):
            found.add(text)
    return found


def english(page, html: str = "") -> set[str]:
    """Return the English sentences that can be read on a page now, or in a document given as text."""
    return sentences(page.evaluate(READ, html))


def chinese(page, path: str, **more):
    """Open a page in a browser set to Chinese."""
    opened = page(path, **more)
    opened.evaluate("localStorage.setItem('language', 'zh')")
    opened.reload()
    until(opened, "document.documentElement.lang === 'zh-CN'")
    return opened


def test_the_live_page_has_no_english_sentence(tab):
    """Panels, what opens from them, every dialog, and the events of a fault."""
    live = opened(tab, "/?experiment=dts200&t=12")
    live.evaluate("thetascope.act.language('zh')")
    until(live, "thetascope.state.language === 'zh'")
    until(live, "Object.values(thetascope.state.checks).some((one) => one.length)")
    channel = live.evaluate("thetascope.state.plant.channels[0]")
    fault = {"channel": channel["name"], "shape": "step", "onset": 0, "size": channel["typical"]}
    live.evaluate("(fault) => thetascope.send({type: 'inject', fault})", fault)
    live.evaluate("thetascope.act.step(600)")
    until(live, "thetascope.state.log.some(({kind}) => kind === 'inject')")
    live.click("#panel-inject .heading .link")
    live.locator("#panel-inject .dots").first.click()
    seen = english(live)
    live.click("#panel-truth .heading .link")
    live.evaluate("for (const one of document.querySelectorAll('#panel-truth details')) one.open = true")
    live.click(".truth-section:last-of-type > .link")
    seen |= english(live)
    for part in (".truth-foot .link", "#panel-truth .heading .link"):
        live.click(part)
    for fold in live.locator("#panel-diagnosis .heading-links button").all():
        fold.click()
        rested(live)
        seen |= english(live)
        fold.click()
    live.locator(".lights").first.click()
    live.wait_for_selector(".checks li")
    seen |= english(live)
    live.keyboard.press("Escape")
    live.click("#panel-observers .heading .link")
    until(live, "document.querySelector('.add-form option:disabled')?.title")
    for kind in live.locator(".add-form > select option:not(:disabled)").evaluate_all(
        "(all) => all.map((one) => one.value)"
    ):
        live.locator(".add-form > select").select_option(kind)
        seen |= english(live)
    live.locator(".add-form .press.clear").click()
    live.evaluate("document.activeElement.blur()")
    for name, ready in {"e": "dialog math", "?": "dialog .keys", "s": "dialog input"}.items():
        live.keyboard.press(name)
        live.wait_for_selector(ready)
        seen |= english(live)
        live.keyboard.press("Escape")
        live.wait_for_selector("dialog[open]", state="detached")
    live.click(".actions button >> nth=1")
    live.wait_for_selector("dialog .links")
    seen |= english(live)
    live.keyboard.press("Escape")
    live.wait_for_selector("dialog[open]", state="detached")
    live.keyboard.press("p")
    for choice in live.locator("[role=tab]:not(:disabled)").all():
        choice.click()
        seen |= english(live)
    assert "\n".join(sorted(seen)) == ""


def test_records_have_no_english_sentence(page):
    """A simulated record with its diagnosis."""
    records = chinese(page, "/records/")
    records.wait_for_selector("#simulate")
    seen = english(records)
    records.click("#simulate")
    until(records, "document.querySelector('.record-name small')?.textContent.includes('取自')")
    records.wait_for_selector("#next:not([aria-disabled])")
    seen |= english(records)
    records.click("#next")
    records.wait_for_selector(".step-2 .verdict")
    records.wait_for_selector("#next")
    seen |= english(records)
    records.click("#next")
    records.wait_for_selector(".step-3 .verdict")
    records.evaluate("for (const one of document.querySelectorAll('details')) one.open = true")
    seen |= english(records)
    assert "\n".join(sorted(seen)) == ""


def test_a_run_and_its_report_have_no_english_sentence(page):
    """The page of a run, folds open and the first figures drawn, then its report;
    a sandwich system and a comparison."""
    runs = chinese(page, "/runs/?experiment=zhou-tan-2012", height=300)
    seen = english(runs)
    for experiment in ("zhou-tan-2012", "zhao-2012-observers"):
        if experiment not in runs.url:
            runs.click(f"a[href*='experiment={experiment}']")
            runs.wait_for_url(f"**experiment={experiment}*")
        runs.click("button.run")
        until(runs, "document.querySelectorAll('figure[data-name]').length > 3", 60)
        runs.evaluate("document.querySelectorAll('details').forEach((one) => (one.open = true))")
        runs.locator("figure[data-name]").first.scroll_into_view_if_needed()
        runs.wait_for_selector("figure .modebar-btn", state="attached")
        seen |= english(runs)
        address = runs.locator("a[href*='/report']").first.get_attribute("href")
        assert address
        seen |= english(runs, runs.evaluate("(address) => fetch(address).then((answer) => answer.text())", address))
    assert "\n".join(sorted(seen)) == ""
