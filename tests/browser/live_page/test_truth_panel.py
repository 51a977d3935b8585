"""The panel Reality: every difference from the model is set, shown when folded, kept, and taken back."""

import pytest

from tests.browser.live_helpers import APP, opened, reload, rested, until

PATH = "/?experiment=dc-motor&t=2"
TRUTH = f"{APP}.state.facts.truth"
SUMMARY = "(document.querySelector('.truth-summary')?.textContent ?? '')"
#: Label of a field → text, path in the truth, value.
NUMBERS = {
    "True value of R": ("1.3", "parameters.R", 1.3),
    "Process noise of armature current": ("0.01", "process_noise.current", 0.01),
    "Correlation time of the noise of measured current": ("0.05", "outputs.y_current.correlation", 0.05),
    "Sample period of measured speed": ("0.02", "outputs.y_speed.period", 0.02),
    "Share of missing samples of measured speed, in per cent": ("10", "outputs.y_speed.missing", 0.1),
    "Largest delay of the samples of measured speed": ("0.004", "outputs.y_speed.jitter", 0.004),
}
TEXTS = {
    "Expression added to measured current": ("0.01*current", "outputs.y_current.adds"),
    "Expression added to the equation of speed of the shaft": ("-0.1*speed", "dynamics.speed"),
}
INSIDE = """(() => {
  const card = document.querySelector('#panel-truth').getBoundingClientRect();
  const controls = [...document.querySelectorAll('#panel-truth :is(input, button, .unit, .label, p)')]
    .filter((one) => one.checkVisibility());
  const out = controls.filter((one) => { const box = one.getBoundingClientRect();
    return box.left < card.left || box.right > card.right + 0.5; });
  const cut = controls.filter((one) => one.matches('button, p, .truth-sensor .label') && one.scrollWidth
    > one.clientWidth + 1);
  return [...out, ...cut].map((one) => one.ariaLabel || one.textContent);
})()"""


def unfold(live) -> None:
    """Unfold the panel and all its sections."""
    live.click("#panel-truth .heading .link")
    live.evaluate("for (const one of document.querySelectorAll('#panel-truth details')) one.open = true")


def field(live, label: str):
    """Return the field of a label, not its slider."""
    return live.locator(f'#panel-truth input:not([type=range])[aria-label="{label}"]')


def write(live, label: str, text: str) -> None:
    field(live, label).fill(text)
    field(live, label).press("Enter")


def value_at(live, path: str):
    """Return a value of the session's truth; `path` such as outputs.y.period."""
    return live.evaluate(f"(path) => path.split('.').reduce((part, name) => part?.[name], {TRUTH})", path)


def test_every_difference_reaches_the_session_and_is_kept(page):
    """Numbers and texts by keyboard; folded, the summary counts them; loading again, a fork, a link and the spec
    have the same truth; one click takes all of them back."""
    live = opened(page, PATH)
    assert live.evaluate(SUMMARY) == "as the model"
    unfold(live)
    for label, (text, *_) in (NUMBERS | TEXTS).items():
        write(live, label, text)
    until(live, f"{TRUTH}.dynamics.speed")
    wanted = {path: value for _, path, value in NUMBERS.values()} | {path: text for text, path in TEXTS.values()}
    assert {path: value_at(live, path) for path in wanted} == wanted
    live.click("#panel-truth .heading .link")
    assert not live.is_visible(".truth-body")
    assert live.evaluate(SUMMARY).startswith("8 differences: R = 1.3")
    until(live, f"{APP}.state.log.some(({{kind}}) => kind === 'truth')")
    truth = live.evaluate(TRUTH)

    until(live, f"location.hash.startsWith('#s=') && {APP}.state.spec.commands.at(-1).truth.dynamics.speed")
    link = live.evaluate(f"{APP}.act.link()")
    reload(live)
    until(live, f"window.thetascope?.state.facts && {SUMMARY}.startsWith('8 differences')")
    assert live.evaluate(TRUTH) == truth

    first = live.evaluate(f"{APP}.state.session")
    live.evaluate(f"{APP}.act.fork()")
    until(live, f"{APP}.state.session !== '{first}' && {APP}.state.facts && {SUMMARY}.startsWith('8 differences')")
    assert live.evaluate(TRUTH) == truth
    assert live.evaluate(f"{APP}.state.spec.commands.at(-1).truth") == truth  # of which a saved run is made

    live = opened(page, link[link.index("/#") :])
    until(live, f"window.thetascope?.state.facts && {SUMMARY}.startsWith('8 differences')")
    assert live.evaluate(TRUTH) == truth
    unfold(live)
    live.click("text=Back to the model")
    until(live, f"{SUMMARY} === 'as the model' && Object.keys({TRUTH}.parameters).length === 0")
    assert field(live, "True value of R").input_value() == "1"


def test_a_rewind_before_a_change_takes_it_back(tab):
    """The panel shows the truth of the row that is shown."""
    live = opened(tab, PATH)
    unfold(live)
    write(live, "True value of R", "1.3")
    until(live, f"{TRUTH}.parameters.R === 1.3")
    live.evaluate(f"{APP}.send({{type: 'step', rows: 20}})")
    live.evaluate(f"{APP}.act.seek(1)")
    until(live, f"{SUMMARY} === 'as the model'")
    assert field(live, "True value of R").input_value() == "1"


def test_a_refused_value_is_explained_at_its_field(tab):
    """A text and a number: the problem and its remedy; other edits act, and a corrected one is accepted."""
    live = opened(tab, PATH)
    unfold(live)
    speed = "Expression added to the equation of speed of the shaft"
    write(live, speed, "nope*2")
    until(live, "document.querySelector('#panel-truth .truth-text .refused:not(:empty)')")
    words = live.inner_text(f"#{field(live, speed).get_attribute('aria-describedby')}")
    assert "'nope'" in words and "Remedy" in words and field(live, speed).get_attribute("aria-invalid") == "true"
    period = "Sample period of measured speed"
    write(live, period, "0.0123")
    until(live, "document.querySelector('#panel-truth .truth-row .refused:not(:empty)')")
    assert "multiple of the step" in live.inner_text(f"#{field(live, period).get_attribute('aria-describedby')}")
    write(live, "True value of R", "-1")
    assert "Less than 0.001" in live.inner_text(f"#{field(live, 'True value of R').get_attribute('aria-describedby')}")
    write(live, "Process noise of speed of the shaft", "0.5")
    until(live, f"{TRUTH}.process_noise.speed === 0.5")
    assert field(live, speed).input_value() == "nope*2" and live.evaluate(SUMMARY).startswith("1 difference")
    write(live, speed, "-speed/5")
    write(live, period, "0.02")
    until(live, f"{TRUTH}.outputs.y_speed?.period === 0.02 && {TRUTH}.dynamics.speed === '-speed/5'")
    assert field(live, speed).get_attribute("aria-invalid") is None


def test_further_states_act_after_a_new_start(tab):
    """A draft is not sent; what the server refuses is shown at its field; faults stay; Undo leads back, and the model
    is one click away."""
    live = opened(tab, PATH)
    live.evaluate(
        f"{APP}.send({{type: 'inject', fault: {{channel: {APP}.state.plant.channels[0].name, shape: 'step', "
        "onset: 0, size: 0.1}})"
    )
    until(live, f"{APP}.state.faults.length === 5")
    first = live.evaluate(f"{APP}.state.session")
    unfold(live)
    live.click("text=+ further state")
    assert live.evaluate("document.activeElement.ariaLabel") == "Equation of further state 1"
    live.keyboard.type("-nope*z")
    live.keyboard.press("Tab")
    write(live, "Name of further state 1", "sag")
    write(live, "Initial value of further state 1", "2")
    write(live, "Process noise of further state 1", "0.1")
    assert live.evaluate(SUMMARY).startswith("draft, not acting yet") and live.evaluate(f"{TRUTH}.states") == []
    live.click("text=Start again with this reality")
    until(live, "document.querySelector('.truth-state .refused:not(:empty)')")
    assert "'nope'" in live.inner_text(".truth-state .refused:not(:empty)")
    assert live.evaluate(f"{APP}.state.session") == first
    write(live, "Equation of further state 1", "-sag/3")
    live.click("text=Start again with this reality")
    until(live, f"{APP}.state.session !== '{first}' && {APP}.state.facts")
    assert live.evaluate(f"[{APP}.state.faults.length, {APP}.state.spec.truth.process_noise.sag]") == [5, 0.1]
    until(live, f"{APP}.latest('x.sag') === 2 && {SUMMARY}.startsWith('2 differences')")
    assert live.evaluate("document.activeElement.closest('#panel-truth') !== null")
    write(live, "Expression added to the equation of speed of the shaft", "sag")
    until(live, f"{TRUTH}.dynamics.speed === 'sag'")
    second = live.evaluate(f"{APP}.state.session")
    live.click("text=Back to the model")
    until(live, f"{APP}.state.session !== '{second}' && {APP}.state.facts && {SUMMARY} === 'as the model'")
    live.click("#notice button")
    until(live, f"{APP}.state.session === '{second}' && {APP}.state.facts && {SUMMARY}.startsWith('3 differences')")


def test_who_watches_sees_the_truth_and_cannot_change_it(tab, page):
    """Another viewer's page follows, with its fields disabled."""
    live = opened(tab, PATH)
    viewer = opened(page, f"/?session={live.evaluate(f'{APP}.state.session')}")
    unfold(viewer)
    live.evaluate(f"{APP}.send({{type: 'set-truth', truth: {{parameters: {{R: 1.4}}}}}})")
    until(viewer, f"{SUMMARY}.startsWith('1 difference')")
    assert field(viewer, "True value of R").input_value() == "1.4" and field(viewer, "True value of R").is_disabled()
    assert not viewer.is_visible("text=Back to the model")


@pytest.mark.parametrize(("width", "height"), [(1440, 900), (1280, 720), (390, 844)])
@pytest.mark.parametrize("language", ["en", "zh"])
def test_the_panel_keeps_to_its_card(kept_page, width, height, language):
    """Unfolded, with all sections and a draft: no control leaves the card, no label or button is cut, and where there
    are columns, the plant, the scope and the right column keep their places."""
    live = opened(kept_page, "/?experiment=quadruple-tank&t=20", width=width, height=height)
    live.evaluate(f"{APP}.act.language('{language}')")
    if width < 720:
        live.click("#tab-inject")
    rested(live)
    cards = """[...document.querySelectorAll('#panel-plant, #scope, .right > .card')]
      .map((one) => { const {x, y, width} = one.getBoundingClientRect(); return [x, y, width].map(Math.round); })"""
    before = live.evaluate(cards)
    unfold(live)
    live.click("#panel-truth .truth-section:last-of-type > .link")
    rested(live)
    assert live.evaluate(INSIDE) == []
    assert live.evaluate("document.documentElement.scrollWidth <= innerWidth")
    if width > 720:
        assert live.evaluate(cards) == before
    live.click("#panel-truth .truth-foot .link")
    live.click("#panel-truth .heading .link")
    live.evaluate(f"{APP}.act.language('en')")
