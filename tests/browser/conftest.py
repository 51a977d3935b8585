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
    "--process-per-site",  # tabs of a context share a process and the scripts that it has compiled
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


@pytest.fixture(scope="session")
def context(browser) -> Iterator:
    """Yield the context that tests share: the second page to open finds scripts and fonts in its cache."""
    shared = browser.new_context()
    yield shared
    shared.close()


def visit(context, server: str, path: str, width: int, height: int, theme: str):
    """Return a new page of a context at a path of the server, with .watch of the errors on it."""
    opened = context.new_page()
    opened.set_default_timeout(60_000)
    opened.set_viewport_size({"width": width, "height": height})
    opened.emulate_media(color_scheme=theme)
    opened.watch = Watch(opened, server)
    opened.goto(server + path)
    return opened


def forget(page, server: str) -> None:
    """Delete everything that pages of the server have stored in the page's context."""
    kinds = {"origin": server, "storageTypes": "cookies,local_storage,indexeddb,service_workers"}
    page.context.new_cdp_session(page).send("Storage.clearDataForOrigin", kinds)


@pytest.fixture
def page(browser, context, server) -> Iterator:
    """Yield a function that opens pages: page("/?experiment=…", width=390, theme="dark").

    The first page of a test is a new tab with empty storage; each further one is another person's browser.
    """
    tabs, others = [], []

    def open_page(path: str = "/", width: int = 1440, height: int = 900, theme: str = "light"):
        if tabs:
            others.append(browser.new_context())
        opened = visit(others[-1] if others else context, server, path, width, height, theme)
        tabs.append(opened)
        return opened

    yield open_page
    if tabs:
        forget(tabs[0], server)
        tabs[0].close()
    for other in others:
        other.close()


@pytest.fixture(scope="module")
def kept_page(context, server) -> Iterator:
    """Yield a function that opens a page as `page` does, or returns the one that the module has open at that path.

    For tests that only look: they leave the session and the view as they were. The window gets the size asked for.
    """
    kept: dict[tuple[str, str], Any] = {}

    def open_or_keep(path: str = "/", width: int = 1440, height: int = 900, theme: str = "light"):
        if (path, theme) not in kept:
            kept[path, theme] = visit(context, server, path, width, height, theme)
        kept[path, theme].set_viewport_size({"width": width, "height": height})
        kept[path, theme].bring_to_front()
        return kept[path, theme]

    yield open_or_keep
    for opened in kept.values():
        forget(opened, server)
        opened.close()
