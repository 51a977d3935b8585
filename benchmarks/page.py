"""Measure the live page in a browser: script time of one update of the scope, and Plotly's for the same curves.

python -m benchmarks page        (THETASCOPE_BROWSER names the browser; by default an installed one is used)
"""

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from benchmarks.measure import Figure
from benchmarks.service import service
from tools.browser import find

SCRIPT = Path(__file__).with_suffix(".js")


OTHERS = {"a": "adaptive-kalman", "b": "adaptive-kalman", "c": "joint-ekf", "d": "joint-ukf", "e": "high-gain"}
DRAWING = """async () => {
  const {scope} = thetascope, times = [];
  for (let k = 0; k < 300; k += 1) {
    await new Promise(requestAnimationFrame);
    scope.still = ''; // or nothing is drawn again, since nothing has changed
    const began = performance.now();
    scope.draw(began);
    times.push((performance.now() - began) / 1000);
  }
  return times;
}"""


def drawn(page) -> list[float]:
    """Return the script time in s of frames of the live page with six observers and all bands drawn."""
    page.goto(page.url.partition("?")[0] + "?experiment=zhao-2012&t=20")
    page.wait_for_function("() => window.thetascope?.state.spec && thetascope.samples.now > 19.9")
    for label, kind in OTHERS.items():
        page.evaluate(
            "(observer) => thetascope.send({type: 'add-observer', observer})",
            {"label": label, "kind": kind, "options": {}},
        )
    page.evaluate("thetascope.send({type: 'step', rows: 2000})")
    page.wait_for_function("() => thetascope.samples.now > 39.9")
    page.wait_for_timeout(1500)
    return page.evaluate(DRAWING)


def figures() -> Iterator[Figure]:
    """Yield the script time per update, and Plotly's relative to it, in one page."""
    from playwright.sync_api import sync_playwright

    path = os.environ.get("THETASCOPE_BROWSER") or find()
    with (
        tempfile.TemporaryDirectory() as folder,
        service(Path(folder)) as (address, _),
        sync_playwright() as playwright,
    ):
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1440, "height": 900})
        page.goto(f"{address}/?experiment=zhao-2012&t=1")
        page.wait_for_selector(".strip canvas")
        measured = page.evaluate(SCRIPT.read_text(encoding="utf-8"), {"updates": 300})
        whole = drawn(page)
        browser.close()
    own = measured["own"]
    middle = sorted(own)[len(own) // 2]
    yield Figure.of("page: script time of an update, 4 strips of 3 curves of 10 000 points", own, "≤ 2 ms", "ms")
    yield Figure.of("page: the same of the live page itself, 7 strips of 6 observers, all bands", whole, "", "ms")
    yield Figure.of("page: Plotly.react of the same / update", [time / middle for time in measured["react"]])
    yield Figure.of(
        "page: updates drawn a second, by a browser without graphics card", [measured["frames"]], "60 with one"
    )
