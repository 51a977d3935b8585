"""A real server on a free port and a real browser. A missing browser is an error with its remedy, never a skip."""

import os
import re
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tools import browser as browser_tool

ROOT = Path(__file__).parents[2]
ARGUMENTS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-features=PreloadTopChromeWebUI",  # Chromium's own menus, a process for every context
    "--disable-sync",
]
REMEDY = "install Chromium or Chrome (Debian: apt-get install chromium), or run: python -m playwright install chromium"


@pytest.fixture(scope="session")
def browser() -> Iterator:
    """Yield an installed Chromium, else Playwright's own, else one from apt; without one fail with the remedy."""
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        pytest.fail("playwright is not installed; run make test, or: pip install playwright", pytrace=False)
    path = browser_tool.find() or browser_tool.fetch()
    if path is None:
        pytest.fail(f"no browser to test the page with; {REMEDY}", pytrace=False)
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=path, args=ARGUMENTS)
        yield opened
        opened.close()


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@pytest.fixture(scope="session")
def server(tmp_path_factory) -> Iterator[str]:
    """Yield the address of a server with an empty store; it is stopped by its process id."""
    port, folder = free_port(), tmp_path_factory.mktemp("served")
    environment = {
        **os.environ,
        "THETASCOPE_DATA": str(folder),
        "THETASCOPE_PORT": str(port),
        "THETASCOPE_HOST": "127.0.0.1",
        "THETASCOPE_IDLE": "60",
    }
    code = "from thetascope.server.app import serve; from thetascope.settings import load; serve(load())"
    with (folder / "log").open("w") as log:
        process = subprocess.Popen([sys.executable, "-c", code], cwd=ROOT, env=environment, stdout=log, stderr=log)
    address = f"http://127.0.0.1:{port}"
    try:
        for _ in range(300):
            try:
                urllib.request.urlopen(f"{address}/api/health", timeout=2).close()
                break
            except OSError:
                if process.poll() is not None:
                    break
                time.sleep(0.1)
        else:
            process.terminate()
        if process.poll() is not None:
            pytest.fail(f"the server did not start: {(folder / 'log').read_text()[-2000:]}")
        yield address
    finally:
        process.terminate()
        process.wait(20)


class Watch:
    """Faults of a page: console errors, exceptions, requests to other hosts."""

    def __init__(self, page, address: str):
        self.errors: list[str] = []
        self.foreign: list[str] = []
        page.on(
            "console",
            lambda message: self.errors.append(message.text) if message.type in ("error", "warning") else None,
        )
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        allowed = re.compile(rf"{re.escape(address)}/|data:|blob:")
        page.on("request", lambda request: None if allowed.match(request.url) else self.foreign.append(request.url))


def opener(browser, server: str, contexts: list):
    """Return a function that opens a page in a context of its own and adds the context to a list."""

    def open_page(path: str = "/", width: int = 1440, height: int = 900, theme: str = "light"):
        context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=theme)
        contexts.append(context)
        opened = context.new_page()
        opened.set_default_timeout(60_000)
        opened.watch = Watch(opened, server)
        opened.goto(server + path)
        return opened

    return open_page


@pytest.fixture
def page(browser, server) -> Iterator:
    """Yield a function that opens pages: page("/?experiment=…", width=390, theme="dark"); .watch has their faults."""
    contexts: list = []
    yield opener(browser, server, contexts)
    for context in contexts:
        context.close()


@pytest.fixture(scope="module")
def kept_page(browser, server) -> Iterator:
    """Yield a function that opens a page as `page` does, or returns the one that the module has open at that path.

    For tests that only look: they leave the session and the view as they were. The window gets the size asked for.
    """
    contexts: list = []
    open_page = opener(browser, server, contexts)
    pages: dict[tuple[str, str], Any] = {}

    def open_or_keep(path: str = "/", width: int = 1440, height: int = 900, theme: str = "light"):
        kept = pages.get((path, theme))
        if kept is None:
            kept = pages[path, theme] = open_page(path, width, height, theme)
        kept.set_viewport_size({"width": width, "height": height})
        return kept

    yield open_or_keep
    for context in contexts:
        context.close()
