"""A real server on a free port and a real browser. A missing browser is an error with its remedy, never a skip."""

import os
import re
import shutil
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "microsoft-edge")
MAC = Path("/Applications/Google Chrome.app/Contents/MacOS/Google Chrome")
ARGUMENTS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
REMEDY = "install Chromium or Chrome (Debian: apt-get install chromium), or run: python -m playwright install chromium"


def installed_browser() -> str | None:
    """Return a Chromium on the path, or the one that THETASCOPE_BROWSER names."""
    named = os.environ.get("THETASCOPE_BROWSER")
    found = named or next(filter(None, map(shutil.which, NAMES)), None)
    return found or (str(MAC) if MAC.exists() else None)


def install_browser() -> str | None:
    """Install Debian's Chromium if this process may."""
    if os.name != "posix" or os.geteuid() != 0 or not shutil.which("apt-get"):
        return None
    for command in (["apt-get", "update", "-qq"], ["apt-get", "install", "-qq", "-y", "chromium"]):
        quiet = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=quiet)
        if done.returncode:
            pytest.fail(f"no browser, and {' '.join(command)} failed: {done.stderr[-400:]}\n{REMEDY}", pytrace=False)
    return installed_browser()


@pytest.fixture(scope="session")
def browser() -> Iterator:
    """Yield an installed Chromium, else Playwright's own, else one from apt; without one fail with the remedy."""
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        pytest.fail("playwright is not installed; run make test, or: pip install playwright", pytrace=False)
    with sync_playwright() as playwright:
        own = playwright.chromium.executable_path
        path = installed_browser() or (own if Path(own).exists() else install_browser())
        if path is None:
            pytest.fail(f"no browser to test the page with; {REMEDY}", pytrace=False)
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


@pytest.fixture
def page(browser, server):
    """Yield a function that opens pages: page("/?experiment=…", width=390, theme="dark"); .watch has their faults."""
    contexts = []

    def open_page(path: str = "/", width: int = 1440, height: int = 900, theme: str = "light"):
        context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=theme)
        contexts.append(context)
        opened = context.new_page()
        opened.set_default_timeout(30_000)
        opened.watch = Watch(opened, server)
        opened.goto(server + path)
        return opened

    yield open_page
    for context in contexts:
        context.close()
