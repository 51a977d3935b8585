"""Helpers for tests of pages: wait until the page shows something, read the state of a live session, send commands."""

import time

APP = "window.thetascope"
#: Narrow, wide, and with Chinese characters of the same font; the content policy forbids style elements.
FONTS = ("", "DejaVu Sans", "Noto Sans CJK SC")
SET_FONT = """(font) => {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(font ? `body * {font-family: '${font}' !important}` : '');
  document.adoptedStyleSheets = [sheet];
}"""
#: The part of a page that explains why a wait failed.
SITUATION = """(() => {
  const live = window.thetascope?.state;
  return live ? {t: live.t, connection: live.connection, playing: live.playing, notice: live.notice,
    verdict: document.querySelector('.verdict')?.textContent} : document.body.innerText.slice(0, 400);
})()"""


def until(page, expression: str, seconds: float = 60.0):
    """Return the value of an expression on the page as soon as it is true.

    Playwright's own `wait_for_function` evaluates text, which the page's content policy forbids. The limit is for a
    page that hangs; it is long because a busy machine is slow.
    """
    end = time.monotonic() + seconds
    while not (value := page.evaluate(expression)):
        assert time.monotonic() < end, f"it never came true: {expression}\non the page: {page.evaluate(SITUATION)}"
        page.wait_for_timeout(50)
    return value


def opened(page, path: str = "/", **more):
    """Return the live page with its session running and its panels filled."""
    live = page(path, **more)
    until(live, f"{APP}?.state.spec !== null && {APP}.latest('t') > 0")
    live.wait_for_selector("#panel-inject .fault", state="attached")
    live.wait_for_selector("#panel-observers .gain input, #panel-observers .soft", state="attached")
    return live


def ready(page, rows: int = 2) -> None:
    """Wait until the session has at least this many rows and the panels have their final size."""
    until(page, f"{APP}?.state.connection === 'live' && {APP}.samples.rows >= Math.max({rows}, {APP}.state.row)")
    until(page, "document.querySelector('#panel-inject .fault') !== null")


def row(page, name: str):
    """Return the row of the inject panel for a channel or output."""
    return page.locator(f"#fault-{name}")


def state(page, field: str):
    """Return a field of the page's state."""
    return page.evaluate(f"{APP}.state.{field}")


def last_row(page) -> dict:
    """Return the newest value of every column, and its time as "now"."""
    values = f"{APP}.state.columns.map((name) => [name, {APP}.latest(name)])"
    return page.evaluate(f"Object.fromEntries([['now', {APP}.samples.now], ...{values}])")


def send(page, command: str) -> dict:
    """Send a command, written in JavaScript, and return its acknowledgement; a refusal is an error."""
    return page.evaluate(f"{APP}.send({command})")
