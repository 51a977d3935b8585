"""Helpers for tests of the live page: wait for the session, read its state."""

import time

#: Narrow, wide, and with Chinese characters of the same font; the content policy forbids style elements.
FONTS = ("", "DejaVu Sans", "Noto Sans CJK SC")
SET_FONT = """(font) => {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(font ? `body * {font-family: '${font}' !important}` : '');
  document.adoptedStyleSheets = [sheet];
}"""


def until(page, expression: str, seconds: float = 20.0):
    """Wait until an expression is true on the page, whose content policy forbids Playwright's own waiting by eval."""
    end = time.monotonic() + seconds
    while not (found := page.evaluate(expression)):
        assert time.monotonic() < end, f"it never came true: {expression}"
        page.wait_for_timeout(50)
    return found


def opened(page, path: str = "/", **more):
    """Return the live page with its session running and its panels filled."""
    made = page(path, **more)
    until(made, "window.thetascope?.state.spec !== null && thetascope.latest('t') > 0")
    made.wait_for_selector("#panel-inject .fault", state="attached")
    made.wait_for_selector("#panel-observers .gain input, #panel-observers .soft", state="attached")
    return made


def row(page, name: str):
    """Return the row of the inject panel for a channel or output."""
    return page.locator(f"#fault-{name}")
