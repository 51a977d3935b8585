"""Phase planes on the live page: added from the menu, other quantities chosen, removed; nothing serious for axe."""

import pytest

from tests.browser.live_helpers import opened, rested, until
from tests.browser.test_accessibility import AXE, serious

#: A canvas has something of an observer's colour or of ink on it.
DRAWN = """(() => {
  const canvas = document.querySelector('#planes canvas');
  const {data} = canvas.getContext('2d').getImageData(60, 4, canvas.width - 64, canvas.height - 30);
  let seen = 0;
  for (let at = 0; at < data.length; at += 4) if (data[at + 3] > 200 && data[at] < 60) seen += 1;
  return seen > 40;
})()"""


def with_plane(tab, **more):
    live = opened(tab, "/?experiment=zhao-2012&t=30", **more)
    live.evaluate("thetascope.act.pause(); thetascope.store.dispatch({type: 'set', notice: null})")
    live.click(".strips-menu summary")
    live.click(".add-plane")
    live.keyboard.press("Escape")
    until(live, "document.querySelectorAll('#planes canvas').length === 1")
    return live


def test_any_quantity_is_drawn_over_any_other(tab):
    """The first plane is x₂ over x₁; the residual over ŷ is chosen; planes are removed one by one."""
    live = with_plane(tab)
    until(live, DRAWN)
    assert live.evaluate("thetascope.state.planes") == [{"x": "state.x1", "y": "state.x2"}]
    live.locator("#planes .axis-x").select_option("estimated.y")
    live.locator("#planes .axis-y").select_option("residual.y")
    until(live, "thetascope.state.planes[0].x === 'estimated.y' && thetascope.state.planes[0].y === 'residual.y'")
    until(live, DRAWN)
    live.evaluate("thetascope.act.plane(1, {x: 'input.u', y: 'theta.theta1'})")
    until(live, "document.querySelectorAll('#planes canvas').length === 2")
    rested(live)
    scope, planes = (live.locator(one).bounding_box() for one in ("#scope", "#planes"))
    assert scope["y"] + scope["height"] <= planes["y"] and planes["y"] + planes["height"] <= 900
    live.evaluate(AXE)
    assert serious(live, within="#planes") == []
    live.locator("#planes .plain").first.click()
    until(live, "thetascope.state.planes.length === 1")
    live.locator("#planes .plain").first.click()
    until(live, "document.querySelector('#planes').hidden")


@pytest.mark.parametrize("width", [1280, 390])
def test_planes_fit_the_screen(tab, width):
    """Three planes lie beside each other, or below each other on a phone."""
    live = with_plane(tab, width=width, height=800)
    live.evaluate("thetascope.act.plane(1, {x: 'input.u', y: 'theta.theta1'})")
    live.evaluate("thetascope.act.plane(2, {x: 'theta.theta1', y: 'theta.theta2'})")
    until(live, "document.querySelectorAll('#planes canvas').length === 3")
    rested(live)
    for plane in live.locator("#planes canvas").all():
        box = plane.bounding_box()
        assert box["width"] > 120 and box["height"] > 60 and box["x"] >= 0 and box["x"] + box["width"] <= width
