"""The sign-in link and the sign-in page in a browser, of a service that other machines can reach."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

import axe_playwright_python
import pytest

from tests.api.conftest import process
from tests.browser.conftest import Watch
from tests.browser.live_helpers import until
from thetascope.access.gate import FILE
from thetascope.access.key_file import KeyFile

AXE = (Path(axe_playwright_python.__file__).parent / "axe.min.js").read_text() + ";0"
PHONE, DESK = {"width": 320, "height": 640}, {"width": 1280, "height": 800}


@dataclass
class Guarded:
    """A service that asks for its key, and the key's file."""

    address: str
    key: str
    file: KeyFile


@pytest.fixture(scope="module")
def guarded(tmp_path_factory) -> Iterator[Guarded]:
    data = tmp_path_factory.mktemp("guarded")
    with process(data, host="0.0.0.0") as (started, address):
        key = started.stdout.readline().rpartition(" ")[2].strip()
        yield Guarded(address, key, KeyFile(data / FILE))


@pytest.fixture
def visitor(browser, guarded):
    """Return a function that opens an address in a browser that was never here."""
    contexts = []

    def open_one(path: str, **options):
        contexts.append(browser.new_context(**{"viewport": DESK, **options}))
        page = contexts[-1].new_page()
        page.set_default_timeout(180_000)
        page.watch = Watch(page, guarded.address)
        page.goto(guarded.address + path)
        return page

    yield open_one
    for context in contexts:
        context.close()


def test_the_link_opens_the_live_page_and_a_new_key_leads_back_to_it(visitor, guarded):
    """The key leaves the address and scripts cannot read the cookie; after a change of the key the page asks for it,
    and the session goes on."""
    page = visitor(f"/?key={guarded.key}#here")
    until(page, "window.thetascope?.state.connection === 'live'")
    assert "key" not in urlsplit(page.url).query and not page.evaluate("document.cookie")
    assert page.evaluate("fetch('/api/runs').then((answer) => answer.status)") == 200
    assert page.watch.errors == page.watch.foreign == []
    until(page, "history.state?.session")  # the address keeps the session from here on
    session = page.evaluate("thetascope.state.session")
    key = guarded.key = guarded.file.renew()
    page.wait_for_url("**/sign-in?*")
    page.get_by_label("Access key").fill(key)
    page.get_by_role("button", name="Sign in").click()
    until(page, "window.thetascope?.state.connection === 'live'")
    assert urlsplit(page.url).path == "/" and page.evaluate("thetascope.state.session") == session
    assert page.evaluate("thetascope.state.role") == "control"


def test_the_form_works_without_scripts_on_a_phone(visitor, guarded):
    """A page that needs the key leads to the form, a wrong key back to it, the right one to the page."""
    page = visitor("/workshop/?plant=contois", java_script_enabled=False, viewport=PHONE, color_scheme="dark")
    assert urlsplit(page.url).path == "/sign-in"
    page.get_by_label("Access key").fill("wrong")
    page.get_by_label("Access key").press("Enter")
    page.get_by_role("alert").wait_for()
    page.get_by_label("Access key").fill(guarded.key)
    page.get_by_label("Access key").press("Enter")
    page.wait_for_url("**/workshop/?plant=contois")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("path", ["/sign-in?lang=zh", "/?key=wrong"])
def test_the_page_is_accessible_and_fits_a_phone(visitor, path, scheme):
    """No serious violation, no sideways scrolling, the cursor in the field, and no request but the page itself."""
    page = visitor(path, viewport=PHONE, color_scheme=scheme)
    page.evaluate(AXE)
    violations = page.evaluate("axe.run(document, {resultTypes: ['violations']}).then((found) => found.violations)")
    assert [one["id"] for one in violations if one["impact"] in ("serious", "critical")] == []
    assert page.evaluate("document.documentElement.scrollWidth") <= PHONE["width"]
    assert page.evaluate("document.activeElement.id") == "key"
    assert page.watch.errors == page.watch.foreign == []
