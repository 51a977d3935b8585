"""Details of the live page: waiting lessons, the present noise, overlapping faults, the log, names in Chinese."""

import pytest

from tests.browser.live_helpers import opened, row, until

PAUSED = "/?experiment=zhao-2012&t=12"


def test_the_model_slider_moves_the_truth_and_shows_the_present_one(tab, page):
    """Its value is the share in per cent; a command of another viewer moves it; the log tells it."""
    live = opened(tab, "/?experiment=dc-motor&t=2")
    field = live.locator(".model input.number")
    field.fill("2")
    field.press("Enter")
    until(live, "thetascope.state.facts.truth.deviation === 0.02")
    live.evaluate("thetascope.send({type: 'set-truth', truth: {deviation: 0.035}})")
    until(live, "document.querySelector('.model input.number').value === '3.5'")
    until(live, "thetascope.state.log.some((event) => event.kind === 'truth')")


def test_the_noise_field_shows_the_present_noise(tab, page):
    """It follows commands, typing and the reset, also in another viewer's page."""
    live = opened(tab, PAUSED)
    field = live.locator(".noise input.number")
    live.evaluate("thetascope.send({type: 'set-noise', output: 'y', std: 0.003, sample_time: 0.01})")
    until(live, "document.querySelector('.noise input.number').value === '0.003'")
    viewer = opened(page, f"/?session={live.evaluate('thetascope.state.session')}")
    assert viewer.locator(".noise input.number").input_value() == "0.003"
    field.fill("0.004")
    field.press("Enter")
    until(viewer, "document.querySelector('.noise input.number').value === '0.004'")
    live.evaluate("thetascope.act.reset()")
    until(live, "document.querySelector('.noise input.number').value === '0.001'")
    field.press("2")  # what one is typing is not taken away
    live.evaluate("thetascope.send({type: 'set-noise', output: 'y', std: 0.005, sample_time: 0.01})")
    until(live, "thetascope.state.noise.y.std === 0.005")
    assert "2" in field.input_value()


def test_a_lesson_waits_in_the_time_of_the_plant(tab):
    """Clear and a later fault are sent as one batch while time runs; the question shows the waiting, also after going
    back."""
    live = opened(tab, "/?experiment=zhao-2012&t=81")
    live.evaluate("thetascope.act.play()")
    until(live, "thetascope.state.playing")
    live.locator(".try .go").nth(1).click()
    until(live, "thetascope.state.faults.some((fault) => fault.subject === 'theta3' && fault.onset > 81)")
    live.evaluate("thetascope.act.pause()")
    until(live, "!thetascope.state.playing")
    cleared, onset = live.evaluate("[thetascope.state.faults[0].end, thetascope.state.faults.at(-1).onset]")
    assert onset - cleared == pytest.approx(8)
    shown = live.evaluate(f"({onset}).toFixed(1)")  # Python rounds a tie the other way
    if live.evaluate("thetascope.state.t") > onset - 1:  # on a very slow machine
        live.evaluate(f"thetascope.act.seek({onset - 1})")
    until(live, f"document.querySelector('.coming:not(:empty)')?.textContent.includes('{shown}')")
    live.evaluate("thetascope.act.step(300)")
    until(live, f"thetascope.state.t > {cleared + 2.5}")
    live.evaluate(f"thetascope.act.seek({cleared + 2})")
    until(live, f"thetascope.state.t < {cleared + 2.1}")
    assert live.evaluate("thetascope.state.faults.at(-1).onset") == onset
    assert live.locator(".coming:not(:empty)").count() == 1 and f"from {shown}" in row(live, "theta3").inner_text()
    live.evaluate("thetascope.act.step(1000)")
    until(live, f"thetascope.state.alarms.some((alarm) => alarm.subject === 'theta3' && alarm.t > {onset})")
    until(live, "document.querySelectorAll('.coming:not(:empty)').length === 0")
    until(live, "/found in/.test(document.querySelector('.verdict').textContent)")


def test_enter_on_the_size_injects(tab):
    """The key of a channel focuses its slider and Enter injects; a typed value and Enter change the fault."""
    live = opened(tab, PAUSED)
    live.keyboard.press("2")
    live.keyboard.press("Enter")
    until(live, "thetascope.state.faults.some((fault) => fault.subject === 'theta2' && fault.active)")
    field = row(live, "theta2").locator("input.number")
    field.fill("0.008")
    field.press("Enter")
    until(
        live,
        "thetascope.state.faults.some((fault) => fault.subject === 'theta2' && fault.active && fault.fault.size "
        "=== 0.008)",
    )
    assert (
        live.evaluate("thetascope.state.faults.filter((fault) => fault.subject === 'theta2' && !fault.ended).length")
        == 1
    )
    field.fill("much")
    field.press("Enter")
    live.evaluate("thetascope.act.step(1)")  # answered after everything that was sent before
    assert live.evaluate("thetascope.state.faults.at(-1).fault.size") == 0.008


def test_overlapping_faults_are_listed_with_their_sum(tab):
    """Before the onset the planned fault is listed, afterwards the active ones and the sum shown on the strip."""
    live = opened(tab, "/?experiment=zhao-2012&t=18")
    press = row(live, "theta3").locator("button.press:not(.quiet-press)")
    assert "from 20.0" in row(live, "theta3").inner_text()
    press.click()
    until(live, "/0\\.02 from 20\\.0/.test(document.querySelector('#fault-theta3 .stack').textContent)")
    live.evaluate("thetascope.act.step(300)")
    until(
        live,
        "/Together with 0\\.02 since 20\\.0.*Total: 0\\.04/.test(document.querySelector('#fault-theta3 "
        ".stack').textContent)",
    )
    assert live.evaluate("thetascope.latest('theta.theta3')") == pytest.approx(0.04)


def test_the_log_is_in_order_and_names_the_quantity(tab):
    """Newest first; a probability is not called a size; later faults state their time; gains have the names of their
    cards."""
    live = opened(tab, "/?experiment=friction-motor&t=2")
    log_lines = live.evaluate(
        """async () => {
      const {lines} = await import(moduleAt('ui/event-words.js'));
      const event = (t, kind, subject, value, text = '') => ({t, row: t, kind, subject, value, text});
      const log = [event(1, 'inject', 'y_speed', {output: 'y_speed', shape: 'dropout', onset: 0, probability: 0.3}),
        event(9, 'inject', 'friction', {shape: 'step', onset: 3, size: 2}),
        event(4, 'fault-begins', 'friction', null), event(6, 'gain', 'ekf', {gain: 'q_theta', value: 3}), event(6.5,
          'gain', 'ekf', {gain: 'q_theta', value: 4}), event(12, 'diverged', '', null, 'the plant escapes')];
      return lines(log, thetascope.state.plant, {q_theta: 'Qθ'}).map(({t, words}) => [t, words]);
    }"""
    )
    assert log_lines == [
        [12, "the plant diverged"],
        [9, "you injected added friction = 2, step, starting at 12.0 s"],
        [6.5, "you set Qθ of ekf to 4"],
        [4, "added friction starts"],
        [1, "you injected measured speed: dropout, probability 0.3"],
    ]
    live.evaluate("thetascope.send({type: 'set-gain', observer: 'ekf', gain: 'q_theta', value: 3})")
    until(live, "document.querySelector('#panel-log').textContent.includes('you set Qθ')")


def test_names_in_chinese_are_consistent(tab):
    """Sentences, findings, notes and menus use the Chinese label of a channel or output, without spaces between
    characters."""
    live = opened(tab, "/?experiment=dts200&t=20")
    live.evaluate("thetascope.act.language('zh')")
    until(live, "document.querySelector('#panel-comparison option')?.textContent.includes('液位')")
    live.evaluate("thetascope.send({type: 'inject', fault: {channel: 'leak1', shape: 'step', onset: 0, size: 0.05}})")
    until(live, "/1 号罐泄漏/.test(document.querySelector('#panel-log').textContent)")
    names = live.evaluate(
        """async () => {
      const {spoken, called} = await import(moduleAt('../common/names.js'));
      const {plant} = thetascope.state;
      const sentence = 'leak1, level1 and clog13 cannot be distinguished with this input';
      return [spoken(sentence, plant), called('y1', plant), called('leak1', plant)];
    }"""
    )
    assert "1 号罐泄漏" in names[0] and "leak1" not in names[0] and names[1:] == ["y₁", "1 号罐泄漏"]
    options = live.locator("#panel-comparison option").all_inner_texts()
    assert not [one for one in options if "leak" in one or "level" in one]


def test_the_proposed_label_follows_the_kind_of_observer(tab):
    """A Kalman observer is not called adaptive; the second of a kind gets a number."""
    live = opened(tab, PAUSED)
    live.click("#panel-observers .heading .link")
    menu, label = live.locator(".add-form > select"), live.locator(".add-form input[type=text]").first
    found = []
    for kind in ("adaptive-kalman", "joint-ekf", "high-gain", "zhao-adaptive"):
        menu.select_option(kind)
        found.append(label.input_value())
    assert found == ["kalman", "ekf", "high-gain", "adaptive-2"]


def test_a_default_gain_follows_the_noise(tab):
    """The default R of a Kalman observer is the variance of the present noise."""
    live = opened(tab, PAUSED)
    live.evaluate("thetascope.send({type: 'add-observer', observer: {label: 'kalman', kind: 'adaptive-kalman'}})")
    shown = (
        "Number(document.querySelector(`.observer[aria-label=kalman] input.number[aria-label^='kalman: R']`)?.value)"
    )
    until(live, f"{shown} === 1e-8")
    live.evaluate("thetascope.send({type: 'set-noise', output: 'y', std: 0.01, sample_time: 0.01})")
    until(live, f"{shown} === 1e-6")


def test_the_loop_is_drawn_and_its_set_point_can_be_moved(tab):
    """The picture has the controller and lights the saturation; the set point and the applied input are curves."""
    live = opened(tab, "/?experiment=loop-sensor&t=100")
    assert "PI" in live.locator("svg.plant").text_content()
    strips = live.evaluate("[...document.querySelectorAll('[data-strip]')].map((one) => one.dataset.strip)")
    assert {"r.r", "u.q"} <= set(strips)
    field = live.locator(".set-point input.number")
    field.fill("45")
    field.press("Enter")
    until(live, "thetascope.state.log.some((event) => event.kind === 'signal')")
    live.evaluate("thetascope.act.step(4)")
    until(live, "thetascope.latest('r.r') === 45 && thetascope.latest('u.q') === 100")
    until(live, "document.querySelector('.plant .limit.on title')?.textContent.includes('limit')")
    assert field.input_value() == "45"
    refused = live.evaluate(
        "thetascope.send({type: 'set-signal', name: 'q', signal: {kind: 'constant', value: 1}}).catch(() => 'refused')"
    )
    assert refused == "refused"
