"""A real server on a free port and a real browser. A missing browser is an error with its remedy, never a skip."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from tools import browser as browser_tool

try:
    import fcntl
except ImportError:  # Windows: every worker has a server of its own
    fcntl = None

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


def answers(address: str) -> bool:
    """Return whether the service at an address is up."""
    try:
        urllib.request.urlopen(f"{address}/api/health", timeout=10).close()
    except OSError:
        return False
    return True


def started(folder: Path) -> tuple[str, int]:
    """Start a service with an empty store; return its address and the id of its process."""
    port = free_port()
    environment = {
        **os.environ,
        "THETASCOPE_DATA": str(folder),
        "THETASCOPE_PORT": str(port),
        "THETASCOPE_HOST": "127.0.0.1",
        "THETASCOPE_IDLE": "60",
        "THETASCOPE_BACKLOG": "1M",  # a session is too long for late viewers, who get a part of it, earlier
    }
    code = "from thetascope.server.app import serve; from thetascope.settings import load; serve(load())"
    with (folder / "log").open("w") as log:
        process = subprocess.Popen([sys.executable, "-c", code], cwd=ROOT, env=environment, stdout=log, stderr=log)
    address = f"http://127.0.0.1:{port}"
    end = time.monotonic() + 180  # a busy machine is slow
    while not answers(address):
        if process.poll() is not None or time.monotonic() > end:
            process.kill()
            pytest.fail(f"the server did not start: {(folder / 'log').read_text()[-2000:]}")
        time.sleep(0.1)
    return address, process.pid


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep the other workers of this run out."""
    with (folder / "lock").open("w") as lock:
        if fcntl:
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


@pytest.fixture(scope="session")
def server(tmp_path_factory, request) -> Iterator[str]:
    """Yield the address of a server that the workers of this run share, so that each kernel is compiled once.

    The first worker starts it, and the last one to leave stops it by its process id.
    """
    base = tmp_path_factory.getbasetemp()
    own = tmp_path_factory.mktemp("served")
    shared = base.parent if fcntl and hasattr(request.config, "workerinput") else own
    users, running = shared / "server-users", shared / "server.json"
    with locked(shared):
        if not (running.exists() and answers(json.loads(running.read_text())[0])):
            running.write_text(json.dumps(started(own)))
        users.mkdir(exist_ok=True)
        (users / own.parent.name).touch()
    address, pid = json.loads(running.read_text())
    yield address
    with locked(shared):
        (users / own.parent.name).unlink()
        if not any(users.iterdir()):
            running.unlink()
            os.kill(pid, signal.SIGTERM)


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


#: How many frames the page has asked for that are not drawn yet, and the addresses of modules beside live/main.js.
#: Without a graphics card a curve that moves sixty times a second takes most of a core: the page is drawn up to fifteen
#: times. Tests wait for frames of the browser, `drawn`.
INSIGHT = """(() => {
  const ask = window.requestAnimationFrame.bind(window);
  let last = -Infinity;
  window.drawn = () => new Promise((done) => { ask(() => setTimeout(done)); });
  window.framesAsked = 0;
  window.requestAnimationFrame = (draw) => {
    window.framesAsked += 1;
    return setTimeout(() => ask((now) => {
      last = performance.now();
      window.framesAsked -= 1;
      draw(now);
    }), Math.max(0, last + 66 - performance.now()));
  };
  window.moduleAt = (path) => new URL(path, document.querySelector('script[type=module]').src);
})()"""


#: Somebody who was here before: the sentences for the first minute are hidden.
KNOWN = "try { localStorage.setItem('thetascope.hints', 'off'); } catch {}"


def visit(context, server: str, path: str, width: int, height: int, theme: str, hints: bool = False):
    """Return a new page of a context at a path of the server, with .watch of the errors on it.

    It prefers reduced motion: axes jump instead of gliding, so that nothing depends on the time of a frame.
    """
    opened = context.new_page()
    opened.set_default_timeout(180_000)
    opened.set_viewport_size({"width": width, "height": height})
    opened.emulate_media(color_scheme=theme, reduced_motion="reduce")
    opened.watch = Watch(opened, server)
    opened.add_init_script(INSIGHT)
    if not hints:
        opened.add_init_script(KNOWN)
    opened.goto(server + path)
    return opened


def forget(page, server: str) -> None:
    """Delete everything that pages of the server have stored in the page's context."""
    kinds = {"origin": server, "storageTypes": "cookies,local_storage,indexeddb,service_workers"}
    page.context.new_cdp_session(page).send("Storage.clearDataForOrigin", kinds)


#: A session that nobody watches would play on for a minute.
PAUSE = """async () => {
  const {state, send} = window.thetascope ?? {};
  const wait = new Promise((done) => setTimeout(done, 1000));
  if (state?.playing && state.role === 'control') await Promise.race([send({type: 'pause'}).catch(() => {}), wait]);
}"""


def leave(page, server: str) -> None:
    """Pause the session of a page, delete what it has stored, and close it."""
    page.evaluate(PAUSE)
    forget(page, server)
    page.close()


#: Open an address of the live page as Back and Forward do, and show nothing that a new page would not show.
RENEW = """async ([path, theme]) => {
  const {act, state, store} = thetascope;
  for (const dialog of document.querySelectorAll('dialog[open]')) dialog.close();
  document.activeElement.blur();
  document.adoptedStyleSheets = [];
  if (state.presentation) act.present(false);
  if (state.language !== 'en') await act.language('en');
  document.querySelector('#tab-curves').click();
  const shown = document.querySelector('#panel-inject .heading [aria-expanded=true]');
  if (shown) shown.click();
  document.querySelector('#panel-truth.open .heading .link')?.click();
  sessionStorage.clear();
  localStorage.clear();
  localStorage.setItem('thetascope.hints', 'off');
  act.theme(theme);
  const {session} = store.state;
  store.dispatch({type: 'set', notice: null, desk: 'inject'});
  history.pushState(null, '', path);
  dispatchEvent(new PopStateEvent('popstate'));
  const end = performance.now() + 180_000;
  while (thetascope.state.session === session && thetascope.state.connection !== 'failed' && performance.now() < end)
    await new Promise((done) => setTimeout(done, 10));
  scrollTo(0, 0);
}"""


class Tab:
    """A tab in which one live page after the other is opened, without loading the page again."""

    def __init__(self, context, server: str):
        self.context, self.server = context, server
        self.page: Any = None

    def __call__(self, path: str = "/", width: int = 1440, height: int = 900, theme: str = "light"):
        """Open the live page at a path, with a session of its own and empty storage."""
        if self.page is None:
            self.page = visit(self.context, self.server, path, width, height, theme)
            return self.page
        self.page.bring_to_front()
        self.page.set_viewport_size({"width": width, "height": height})
        self.page.emulate_media(color_scheme=theme)
        self.page.evaluate(RENEW, [path, theme])
        self.page.watch.errors.clear()
        self.page.watch.foreign.clear()
        return self.page


@pytest.fixture(scope="module")
def module_tab(context, server) -> Iterator[Tab]:
    """Yield the tab that the tests of a module share."""
    shared = Tab(context, server)
    yield shared
    if shared.page:
        shared.page.close()


@pytest.fixture
def tab(module_tab) -> Iterator[Tab]:
    """Yield a function like `page` for one live page: it begins a session in the tab that the module's tests share.

    It takes a third of the time of loading the page. Not for tests that load it again or go back, or count listeners.
    """
    yield module_tab
    if module_tab.page:
        module_tab.page.evaluate(PAUSE)
        module_tab.page.evaluate("localStorage.clear()")


@pytest.fixture
def page(context, server) -> Iterator:
    """Yield a function that opens pages: page("/?experiment=…", width=390, theme="dark").

    The first page of a test has empty storage; each further one is another tab, whose sessions are its own.
    """
    tabs = []

    def open_page(path: str = "/", width: int = 1440, height: int = 900, theme: str = "light", hints: bool = False):
        tabs.append(visit(context, server, path, width, height, theme, hints))
        return tabs[-1]

    yield open_page
    for opened in tabs[::-1]:
        leave(opened, server)


@pytest.fixture(scope="module")
def kept_page(context, server) -> Iterator:
    """Yield a function that opens a page as `page` does, or returns the one that the module has open at that path.

    For tests that only look: they leave the session and the view as they were. Size and theme are those asked for.
    """
    kept: dict[str, Any] = {}

    def open_or_keep(path: str = "/", width: int = 1440, height: int = 900, theme: str = "light"):
        if path not in kept:
            kept[path] = visit(context, server, path, width, height, theme)
        kept[path].bring_to_front()
        kept[path].set_viewport_size({"width": width, "height": height})
        kept[path].emulate_media(color_scheme=theme)
        return kept[path]

    yield open_or_keep
    for opened in kept.values():
        leave(opened, server)
