"""The pictures of the documentation, taken from the product: `THETASCOPE_PICTURES=1 make test` writes docs/images.

Without that variable they are taken as well, and only looked at.
"""

import io
import os
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from matplotlib import image

from tests.browser.live_helpers import ready, rested, send, until
from tests.browser.pages.test_learn_page import entered
from tests.browser.pages.test_workshop_page import READY

DOCS = Path(__file__).parents[2] / "docs"
DRAWN = "[data-drawn] .plot .scatterlayer path.js-line"


def live(page) -> bytes:
    """A session in which a sensor fault has been found."""
    opened = page("/?experiment=zhao-2012&t=27.8", width=1440, height=900)
    ready(opened)
    send(opened, "{type: 'pause'}")
    until(opened, "document.querySelector('#panel-diagnosis').innerText.includes('0.0')")
    until(opened, "!document.querySelector('#notice').checkVisibility()")  # that it was opened from a link
    rested(opened)
    return opened.screenshot()


def parameters(page) -> bytes:
    """The figure of the faults and their estimates on the page of runs."""
    opened = page("/runs/?experiment=zhao-2012", width=1440, height=900)
    opened.wait_for_selector("h1")
    opened.click("button.run")
    figure = opened.locator("#figure-parameters")
    figure.wait_for()
    figure.scroll_into_view_if_needed()
    opened.wait_for_selector(f"#figure-parameters{DRAWN}", state="attached")
    return figure.screenshot()


def lesson(page) -> bytes:
    """A step of the first lesson, before the answer."""
    opened = page("/?lesson=what-you-cannot-see&step=2", width=1440, height=900)
    entered(opened, 2)
    rested(opened)
    return opened.screenshot()


def workshop(page) -> bytes:
    """A plant in the Workshop, with its cards."""
    opened = page("/workshop/?library=two-tanks", width=1440, height=900)
    until(opened, f"{READY} && !document.querySelector('.busy')")
    return opened.screenshot()


PICTURES: dict[str, Callable[..., bytes]] = {
    "live": live,
    "parameters": parameters,
    "lesson": lesson,
    "workshop": workshop,
}


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_shows_the_product(page, name: str):
    """It is not blank, and the page has no error while it is taken."""
    data = PICTURES[name](page)
    if os.environ.get("THETASCOPE_PICTURES"):
        (DOCS / "images" / f"{name}.png").write_bytes(data)
    pixels = image.imread(io.BytesIO(data))[..., :3]
    shades = np.unique((pixels.reshape(-1, 3) * 15).astype(int), axis=0)
    assert pixels.shape[0] > 300 and pixels.shape[1] > 600 and len(shades) > 40


def test_every_picture_is_taken_here_and_shown_somewhere():
    """No picture of docs/images is older than this list, and each stands on a page."""
    taken = {path.stem for path in (DOCS / "images").glob("*.png")}
    pages = [DOCS.parent / "README.md", *DOCS.rglob("*.md")]
    shown = {name for page in pages for name in re.findall(r"images/(\w+)\.png", page.read_text(encoding="utf-8"))}
    assert taken == shown == set(PICTURES)
