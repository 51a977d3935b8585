"""An own plant from its first typing error to a figure for a paper, by the pages alone."""

import pytest

from tests.browser.conftest import forget, visit
from tests.browser.live_helpers import APP, OPENED, until
from tests.browser.pages.test_workshop_page import READY, paste

MOTOR = """id: bench-motor
title: 电机
states:
  - {name: i, unit: A, initial: 0.3}
  - {name: w, unit: rad/s, initial: 20}
inputs:
  - {name: v, unit: V, default: 12, bounds: [0, 24]}
outputs:
  - {name: y_i, unit: A, expression: i}
  - {name: y_w, unit: rad/s, expression: w}
parameters:
  - {name: R, value: 1.2, unit: Ω}
  - {name: L, value: 0.01, unit: H}
  - {name: K, value: 0.5, unit: V·s/rad}
  - {name: J, value: 0.02, unit: kg·m²}
  - {name: b, value: 0.01, unit: N·m·s/rad}
dynamics:
  i: (v - R*i - K*w)/L
  w: (K*i - b*w)/J
channels:
  - {name: friction, title: 摩擦, kind: process, enters: {w: -w/J}, unit: N·m·s/rad, typical: 0.005}
  - {name: hot, title: 绕组, kind: process, enters: {i: -i/L}, unit: Ω, typical: 0.2}
"""
ROWS = "document.querySelectorAll('tr[data-run]')"


@pytest.fixture
def elsewhere(browser):
    """Yield a second browser, which shares nothing with the first."""
    other = browser.new_context(accept_downloads=True)
    yield other
    other.close()


def test_an_own_plant_becomes_a_figure_in_another_browser(page, server, elsewhere):
    """A typing error is corrected where it is, two observers run live, an input is moved, and runs are compared."""
    shop = page("/workshop/")
    until(shop, "document.querySelector('.cm-content')")
    paste(shop, MOTOR.replace("outputs:", "outputs"))
    assert "colon is missing" in shop.locator(".lint").inner_text()
    shop.click(".lint .press")
    until(shop, READY)
    shop.click("#save-plant")
    until(shop, "document.querySelector('.shop-bar .sub').textContent.includes('version 1')")
    until(shop, "document.querySelectorAll('.ranked input:checked').length === 2 && " + READY)
    shop.click("#open-live")
    until(shop, OPENED)
    assert shop.evaluate(f"{APP}.state.observers.length") == 2
    if shop.locator("#panel-inputs:not(.open)").count():
        shop.click("#panel-inputs .heading .link")
    shop.locator("#panel-inputs select.shape").first.select_option("pulse")
    until(shop, f"{APP}.state.spec.commands.some(({{signal}}) => signal?.kind === 'pulse')")
    until(shop, f"{APP}.state.t > 0.2")
    saved = shop.evaluate(f"{APP}.act.save().then(({{id}}) => id)")

    other = visit(elsewhere, server, "/workshop/?plant=bench-motor", 1440, 900, "light")
    until(other, READY + " && document.querySelectorAll('.ranked input:checked').length === 2")
    assert other.locator(".mine .on").inner_text().startswith("电机")
    for shape in ("square", "sine"):
        other.goto(f"{server}/workshop/?plant=bench-motor")
        until(other, READY + " && document.querySelector('.preview-input select') && document.querySelector('.ranked')")
        other.select_option(".preview-input select", shape)
        until(other, READY + " && !document.querySelector('.preview-card .busy')")
        other.click("#run-plant")
        other.wait_for_url("**/runs/**run=**")
        until(other, "document.querySelector('.js-plotly-plot .main-svg')")
    other.goto(f"{server}/runs/?q=bench-motor")
    until(other, f"{ROWS}.length >= 3 && document.querySelector('[data-run=\"{saved}\"]')")
    assert "own experiment on" in other.inner_text(".runs-card")
    for box in other.locator("tr[data-run] input[type=checkbox]").all()[:3]:
        box.check()
    other.keyboard.press("c")
    until(
        other, "document.querySelector('.compare-measures td') && document.querySelector('.js-plotly-plot .main-svg')"
    )
    other.click(".notebook-bar .run")
    until(other, "document.querySelector('.paper-dialog')?.dataset.state === 'drawn'")
    with other.expect_download() as download:
        other.click(".paper-dialog footer .run")
    content = download.value.path().read_bytes()
    assert content.startswith(b"%PDF") and b"/FontFile2" in content and b"/Type3" not in content
    assert shop.watch.errors == [] and other.watch.errors == []
    forget(other, server)
