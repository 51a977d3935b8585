"""Helpers for tests of pages: wait until the page shows something, read the state of a live session, send commands."""

import time
from collections.abc import Callable

from playwright.sync_api import Error

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


#: Look inside the page until the expression is true: polls from outside cost three processes time.
WAITS = """(async () => {
  const end = performance.now() + %d;
  for (;;) {
    const value = await (%s
    );
    if (value || performance.now() > end) return value;
    await new Promise((done) => setTimeout(done, 15));
  }
})()"""


def until(page, expression: str, seconds: float = 180.0):
    """Return the value of an expression on the page as soon as it is true, also if the page is loaded again meanwhile.

    Playwright's own `wait_for_function` evaluates text, which the page's content policy forbids. The limit is for a
    page that hangs; it is long because a busy machine is slow.
    """
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        try:
            value = page.evaluate(WAITS % (1000 * left, expression))
        except Error as error:
            if "context was destroyed" not in error.message and "navigation" not in error.message:
                raise
            page.wait_for_load_state()
            continue
        if value:
            return value
    raise AssertionError(f"it never came true: {expression}\non the page: {page.evaluate(SITUATION)}")


def eventually(condition: Callable[[], object], words: str, seconds: float = 60.0) -> None:
    """Repeat what a person does until the condition holds, say a hover over a page whose layout still moves."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"it never came true: {words}"
        time.sleep(0.03)


#: The session is live, and the panels are filled.
OPENED = f"""{APP}?.state.spec && {APP}.latest('t') > 0 && document.querySelector('#panel-inject .fault')
  && document.querySelector('#panel-observers .gain input, #panel-observers .soft') && true"""


def opened(page, path: str = "/", **more):
    """Return the live page with its session running and its panels filled."""
    live = page(path, **more)
    until(live, OPENED)
    return live


def ready(page, rows: int = 2) -> None:
    """Wait until the session has at least this many rows and the panels have their final size."""
    rest = "document.querySelector('#panel-inject .fault')"
    until(
        page, f"{APP}?.state.connection === 'live' && {APP}.samples.rows >= Math.max({rows}, {APP}.state.row) && {rest}"
    )


#: The page asks for no further frame, and has drawn two since: axes have come to rest, sizes follow from sizes.
RESTED = """(async () => {
  const end = performance.now() + 180_000;
  await drawn();
  for (let calm = 0; calm < 2 && performance.now() < end; await drawn()) calm = window.framesAsked ? 0 : calm + 1;
})()"""


def rested(page) -> None:
    """Wait until a page that is paused does not move any more."""
    page.evaluate(RESTED)


def reload(page) -> None:
    """Load a page again by its own script, as a command of the browser may overtake the page's last entry of the
    history, and then loads the one before."""
    with page.expect_navigation():
        page.evaluate("void location.reload()")


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
