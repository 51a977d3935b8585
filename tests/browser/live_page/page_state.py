"""Helpers for tests of the live page: waiting, and reading the page's own app object."""

import time

APP = "window.thetascope"


def until(page, expression: str, seconds: float = 20.0) -> None:
    """Wait until an expression is true on the page, whose content policy forbids Playwright's own waiting by eval."""
    end = time.monotonic() + seconds
    while not page.evaluate(expression):
        assert time.monotonic() < end, f"it never came true: {expression}"
        page.wait_for_timeout(50)


def ready(page, rows: int = 2) -> None:
    """Wait for a session with a number of rows and all earlier ones, and for the panels that adapt their height."""
    until(page, f"{APP}?.state.connection === 'live' && {APP}.samples.rows >= Math.max({rows}, {APP}.state.row)")
    until(page, "document.querySelector('#panel-inject .fault') !== null")


def state(page, field: str):
    return page.evaluate(f"{APP}.state.{field}")


def last_row(page) -> dict:
    """Return the newest value of every column, and its time."""
    return page.evaluate(
        f"Object.fromEntries([['now', {APP}.samples.now], ...{APP}.state.columns.map((name) => [name, "
        f"{APP}.latest(name)])])"
    )


def send(page, command: str) -> dict:
    """Send a command written in JavaScript; return the Ack, or fail with the refusal."""
    return page.evaluate(f"{APP}.send({command})")
