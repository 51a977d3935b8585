"""The diagnosis on the live page: findings in the summary, on the strips, in the plant and in the log."""

import re

import pytest

from tests.browser.live_helpers import opened, until

VERDICT = "document.querySelector('.verdict').textContent"
PAUSED = "/?experiment=zhao-2012&t=8"


def started(page, path: str = PAUSED, **more):
    """Return the live page at the time of its link, with the detector's state; tests step it, and never play."""
    live = opened(page, path, **more)
    until(live, "thetascope.state.diagnosis?.calibration")
    return live


def inject(live, fault: str) -> None:
    live.evaluate(f"thetascope.send({{type: 'inject', fault: {{onset: 0, {fault}}}}})")


def site(live, subject: str) -> str:
    """Return the classes of a fault channel in the plant's picture."""
    place = live.evaluate(
        f"[...thetascope.state.plant.channels.filter((c) => c.kind !== 'sensor'), "
        f"...thetascope.state.plant.channels.filter((c) => c.kind === 'sensor')].findIndex((c) => c.name === "
        f"'{subject}')"
    )
    return live.locator("svg.plant .site:not(.output)").nth(place).get_attribute("class")


def test_a_sensor_fault_is_summarised(tab):
    """The summary has size, interval, onset and delay; the channel has the ring, the log names it, θ̂ settles within 10
    %."""
    live = started(tab)
    inject(live, "channel: 'theta3', shape: 'step', size: 0.02")
    live.evaluate("thetascope.act.step(1000)")
    summary = until(live, f"/found in/.test({VERDICT}) && {VERDICT}")
    size, half, since, delay = map(
        float, re.search(r"\+([\d.]+) ± ([\d.]+) since ([\d.]+).s, found in ([\d.]+).s", summary).groups()
    )
    assert summary.startswith("θ₃ sensor fault") and abs(size - 0.02) <= 2 * half and half < 0.002
    assert since == pytest.approx(8, abs=0.6) and delay < 2
    until(live, "Math.abs(thetascope.latest('adaptive.theta.theta3') - 0.02) < 0.002")
    assert "found" in site(live, "theta3") and "on" in site(live, "theta3").split()
    assert live.evaluate("thetascope.state.log.some((event) => event.kind === 'alarm' && event.subject === 'theta3')")
    assert "alarm: θ₃, +0.0" in live.locator("#panel-log").inner_text()
    assert live.watch.errors == [] and live.watch.foreign == []


def test_an_actuator_fault_is_identified_and_clears(tab):
    """θ₁ is found and its estimate settles; after Clear the alarm and the ring end, and the finding remains as over."""
    live = started(tab)
    inject(live, "channel: 'theta1', shape: 'step', size: 0.01")
    live.evaluate("thetascope.act.step(3000)")
    until(live, "thetascope.state.alarms.some((alarm) => alarm.subject === 'theta1' && alarm.over === null)")
    until(live, "thetascope.state.t >= 38")
    mean = live.evaluate("thetascope.range('adaptive.theta.theta1', thetascope.state.t - 12, thetascope.state.t).mean")
    assert mean == pytest.approx(0.01, abs=0.001)
    live.evaluate("thetascope.send({type: 'clear'})")
    live.evaluate("thetascope.act.step(500)")
    until(live, "thetascope.state.alarms.every((alarm) => alarm.over !== null)")
    until(live, "document.querySelector('.finding.past') !== null")
    assert "found" not in site(live, "theta1").split()
    assert "cleared" in live.locator(".finding.past").first.inner_text()
    assert "alarm cleared: θ₁" in live.locator("#panel-log").inner_text()


def test_faults_that_the_input_does_not_distinguish_are_both_named(tab):
    """With constant φ θ₁ and θ₂ enter alike: summary, findings and channels show both, and the strips are marked."""
    live = started(tab)
    for name in ("phi1", "phi2", "phi3"):
        live.evaluate(
            f"thetascope.send({{type: 'set-signal', name: '{name}', signal: {{kind: 'constant', value: 1}}}})"
        )
    inject(live, "channel: 'theta2', shape: 'step', size: 0.015")
    live.evaluate("thetascope.act.step(1500)")
    said = until(live, f"/does not distinguish them/.test({VERDICT}) && {VERDICT}")
    assert "θ₁ or θ₂" in said
    assert (
        live.locator(".finding.either .badge").count() == 2 and live.locator(".finding.either .badge.lit").count() == 1
    )
    assert "perhaps" in site(live, "theta1") and "perhaps" in site(live, "theta2")
    assert "found in" in live.locator(".finding.either").inner_text()  # named as one of two is found
    until(live, "document.querySelectorAll('.unresolved:not([hidden])').length >= 2")
    assert "θ₁ or θ₂, not distinguishable" in live.locator("#panel-log").inner_text()


def test_an_unexplained_change_is_attributed_to_the_sensor(tab):
    """A stuck measurement is not explained by the model: the summary says so, and the residual is flagged."""
    live = started(tab)
    inject(live, "output: 'y', shape: 'stuck', value: 0.11")
    live.evaluate("thetascope.act.step(1500)")
    said = until(live, f"/explains y/.test({VERDICT}) && {VERDICT}")
    assert "sensor" in said
    assert "found" in live.locator("svg.plant .site.output").get_attribute("class").split()
    until(live, "[...document.querySelectorAll('.finding')].some((one) => /suspect the sensor/.test(one.textContent))")
    marked = live.evaluate("""(() => {
      const alarm = thetascope.state.alarms.find((one) => !one.explained);
      return [alarm.subject, alarm.subjects.length];
    })()""")
    assert marked == ["y", 0]


def test_detectability_and_certainty_are_shown(tab):
    """The folds show the excitation and its requirement, the resolution of every channel, the rate, and declared and
    estimated noise."""
    live = started(tab)
    diagnosis = live.evaluate("thetascope.state.diagnosis")
    see, sure = live.locator("#panel-diagnosis .heading-links button").all()
    see.click()
    assert live.locator("#panel-diagnosis .seen tbody tr").count() == len(diagnosis["resolution"]) == 3
    level = live.locator(".level").get_attribute("aria-label")
    assert f"{diagnosis['excitation']['level'] ** 0.5:.2g} times" in level and "10 required" in level
    sure.click()
    assert live.locator("#panel-diagnosis .seen").is_hidden()
    words = live.locator(".fold-out:not([hidden])").inner_text()
    assert "one false alarm in 100 h" in words and f"{diagnosis['calibration']['thresholds']['glr']:.3g}" in words
    assert "0.001 declared" in words and f"{diagnosis['calibration']['seeds']} fault-free simulations" in words


def test_rank_and_condition_along_the_run(tab):
    """Detectability shows the structural rank of states and faults, and rank and condition in every window."""
    live = started(tab)
    live.click("#panel-diagnosis button:text-is('Detectability')")
    live.click(".trajectory button")
    live.wait_for_selector(".trajectory tbody tr:nth-child(4)")
    rows = live.locator(".trajectory tbody tr").all_inner_texts()
    assert all("5 / 5" in row and float(row.split()[-1]) > 1 for row in rows)
    assert "rank: 5 of 5" in live.inner_text(".trajectory p >> nth=0") and live.watch.errors == []


def test_a_proposed_input_is_applied(tab):
    """With its own input held constant the motor's faults are not distinguished; Apply sends the proposed input."""
    live = started(tab, "/?experiment=dc-motor&t=2")
    live.evaluate("thetascope.send({type: 'set-signal', name: 'voltage', signal: {kind: 'constant', value: 12}})")
    live.evaluate("thetascope.act.step(500)")
    live.locator("#panel-diagnosis .heading-links button").first.click()
    live.click(".proposal button")
    live.wait_for_selector(".proposal .press:not(.quiet-press)")
    assert "voltage" in live.locator(".proposal").inner_text()
    live.click(".proposal .press:not(.quiet-press)")
    until(live, "thetascope.state.spec.commands.filter((one) => one.command === 'set-signal').length === 2")
    kind = live.evaluate("thetascope.state.spec.commands.at(-1).signal.kind")
    assert kind in ("pulse", "sine", "prbs", "steps")
    until(live, "/Applied/.test(document.querySelector('.proposal').textContent)")


def test_faults_below_the_noise_are_called_unresolvable(tab):
    """At the literal noise of the paper the page says that θ₁ and θ₂ cannot be resolved, also at their strips."""
    live = opened(tab, "/?experiment=zhao-2012-variance-as-printed&t=30")
    until(live, "/cannot be resolved at this noise level/.test(document.querySelector('.hint')?.textContent)")
    assert live.locator(".hint").inner_text() == "θ₁ and θ₂ cannot be resolved at this noise level."
    marks = live.evaluate(
        "[...document.querySelectorAll('.strip[data-kind=theta]')].map((strip) => "
        "!strip.querySelector('.unresolved').hidden)"
    )
    assert marks == [True, True, False]
    live.click(".hint button")
    assert live.locator("#panel-diagnosis .seen tbody tr", has_text="below the noise").count() == 2


def test_a_fault_that_is_not_found_is_listed_inside_its_card(tab):
    """The line of a tiny fault lies in the Diagnosis card, not at the mark of the same name on a strip."""
    live = started(tab)
    inject(live, "channel: 'theta2', shape: 'step', size: 0.0005")
    line = live.wait_for_selector(".finding.undetected").bounding_box()
    card = live.locator("#panel-diagnosis").bounding_box()
    assert card["x"] <= line["x"] and line["x"] + line["width"] <= card["x"] + card["width"]
    assert card["y"] <= line["y"] and line["y"] + line["height"] <= card["y"] + card["height"]


def test_a_found_fault_that_ends_is_never_called_unfound(tab):
    """From Clear to the end of the alarm no text calls the fault not found; the next fault does not light its badge."""
    live = started(tab)
    inject(live, "channel: 'theta3', shape: 'step', size: 0.02")
    live.evaluate("thetascope.act.step(300)")
    until(live, f"/found in/.test({VERDICT})")
    live.evaluate(f"""(() => {{
      window.said = [];
      new MutationObserver(() => window.said.push({VERDICT})).observe(document.querySelector('.verdict'),
        {{childList: true, characterData: true, subtree: true}});
    }})()""")
    live.keyboard.press("c")
    until(live, "thetascope.state.faults.every((fault) => fault.ended || !fault.active)")
    live.evaluate("thetascope.act.step(500)")
    until(live, f"/over/.test({VERDICT})")
    assert [one for one in live.evaluate("window.said") if "Not found" in one or "not found" in one] == []
    inject(live, "channel: 'theta3', shape: 'step', size: 0.0005")
    until(live, "document.querySelector('.finding.undetected .lit') !== null")
    assert live.locator(".finding.past .lit").count() == 0
