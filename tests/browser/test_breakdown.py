"""The live page after a divergence of the plant, of the only observer or of one of several, and how to continue."""

import re

from tests.browser.live_helpers import opened, until

VERDICT = "document.querySelector('.verdict').textContent"


def test_a_diverged_plant_is_not_called_healthy(tab):
    """Summary and notice state the time; the button goes back before it, and time can run again."""
    live = opened(tab, "/?experiment=reduced-order-mimo&t=2")
    for speed in ("null", "0.5"):
        live.evaluate(f"thetascope.act.speed({speed})")
        live.evaluate("thetascope.act.play()")
        said = until(live, f"/plant diverged at 2\\.52/.test({VERDICT}) && {VERDICT}")
        assert "Go back" in said and live.locator(".hint").count() == 0
        until(live, "/diverged at 2\\.52/.test(document.querySelector('#notice').textContent)")
        live.click("#notice button")
        until(live, "thetascope.state.t < 2.2 && thetascope.state.broken === null")
        until(live, f"!/broke/.test({VERDICT})")
    assert live.watch.errors == []


def test_the_only_observer_is_restarted(tab, page, server):
    """The summary reports its divergence; its card restarts it with the same gains, colour and name, and the link has
    the same numbers."""
    live = opened(tab, "/?experiment=zhao-2012-as-printed&t=1")
    until(live, f"/adaptive diverged at 0\\.70.*nothing is estimated/.test({VERDICT})")
    live.evaluate("thetascope.send({type: 'set-gain', observer: 'adaptive', gain: 'rho', value: 2})")
    live.click(".fallen button")
    until(live, "thetascope.state.observers[0]?.since === 1.01 || thetascope.state.observers[0]?.since === 1")
    live.evaluate("thetascope.act.step(20)")
    until(live, "thetascope.samples.now > 1.19 && Number.isFinite(thetascope.latest('adaptive.x.x1'))")
    until(live, "document.querySelector('.fallen').hidden")
    assert "you restarted adaptive" in live.inner_text("#panel-log") and "adaptive removed" not in live.inner_text(
        "#panel-log"
    )
    observer = live.evaluate("thetascope.state.observers[0]")
    assert (observer["label"], observer["colour"], observer["gains"]["rho"], observer["diverged"]) == (
        "adaptive",
        "var(--o0)",
        2,
        None,
    )
    assert not re.search("diverged", live.evaluate(VERDICT))
    link = live.evaluate("thetascope.act.link()")
    again = opened(page, link.removeprefix(server))
    until(again, "thetascope.samples.now > 1.19")
    assert again.evaluate("thetascope.latest('adaptive.x.x2')") == live.evaluate("thetascope.latest('adaptive.x.x2')")
    assert live.watch.errors == []


def test_a_restarted_observer_keeps_its_colour_among_others(tab):
    """Although a lower colour number is free it keeps its own; the lights of the others open while time is paused."""
    live = opened(tab, "/?experiment=zhao-2012-observers&t=3")
    live.evaluate("thetascope.send({type: 'remove-observer', label: 'adaptive'})")
    until(live, "thetascope.state.observers.length === 3")
    live.evaluate(
        "thetascope.act.together([{type: 'remove-observer', label: 'ekf'}, {type: 'add-observer', observer: "
        "thetascope.state.observers.find((one) => one.label === 'ekf').config}])"
    )
    until(live, "thetascope.state.observers.length === 3 && thetascope.state.observers.at(-1).label === 'ekf'")
    assert live.evaluate("Object.fromEntries(thetascope.state.observers.map((one) => [one.label, one.place]))") == {
        "kalman": 1,
        "ukf": 3,
        "ekf": 2,
    }
    until(live, "thetascope.state.checks.kalman?.length")
    live.evaluate("thetascope.send({type: 'set-gain', observer: 'kalman', gain: 'lambda', value: 1})")
    lights = live.locator(".observer[aria-label=kalman] .lights")
    for _ in range(2):
        lights.click()
        assert live.locator(".observer[aria-label=kalman] .checks li").count() == live.evaluate(
            "thetascope.state.checks.kalman.length"
        )
        lights.click()
        assert live.locator(".observer[aria-label=kalman] .checks li").count() == 0


def test_a_fault_that_begins_while_the_last_alarm_is_on_is_not_called_found(tab):
    """The summary has the onset of the alarm and of the new fault, and no time to find it."""
    live = opened(tab, "/?experiment=zhao-2012&t=25")
    until(live, f"/found in/.test({VERDICT})")
    live.evaluate(
        "thetascope.act.together([{type: 'clear'}, {type: 'inject', fault: {channel: 'theta3', shape: 'step', "
        "onset: 0, size: 0.02}}])"
    )
    live.evaluate("thetascope.act.step(60)")
    summary = until(live, f"/began at .* while this alarm was still on/.test({VERDICT}) && {VERDICT}")
    assert "since 20.0" in summary and "began at 25.0" in summary and "found in" not in live.inner_text(".finding")
    until(live, "document.querySelector('#panel-comparison .detector td').title === 'its alarm was already on'")
