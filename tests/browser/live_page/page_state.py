"""What the tests of the live page share: waiting, and reading from the page's own app object."""

import time

APP = "window.thetascope"


def until(page, expression: str, seconds: float = 20.0) -> None:
    """Wait until an expression is true on the page (whose content policy forbids Playwright's own waiting by eval)."""
    end = time.monotonic() + seconds
    while not page.evaluate(expression):
        assert time.monotonic() < end, f"it never came true: {expression}"
        page.wait_for_timeout(50)


def ready(page, rows: int = 2) -> None:
    """Wait until a session is there, with so many rows and all that came before them, and the panels that make room for themselves."""
    until(page, f"{APP}?.state.connection === 'live' && {APP}.samples.rows >= Math.max({rows}, {APP}.state.row)")
    until(page, "document.querySelector('#panel-inject .fault') !== null")


def state(page, field: str):
    return page.evaluate(f"{APP}.state.{field}")


def last_row(page) -> dict:
    """The newest value of every column, and its time."""
    return page.evaluate(
        f"Object.fromEntries([['now', {APP}.samples.now], ...{APP}.state.columns.map((name) => [name, {APP}.latest(name)])])"
    )


def send(page, command: str) -> dict:
    """Send a command, written in JavaScript; the Ack, or an error with the refusal."""
    return page.evaluate(f"{APP}.send({command})")
