"""The panels around the scope, with a real session: plant, injection, observers, diagnosis, log."""

import re

import pytest

from tests.browser.live_helpers import opened, rested, row, until

SHAPES = ["step", "ramp", "drift", "exponential", "sine", "pulse-train", "random-walk", "table"]
DISTURBANCES = ["stuck", "freeze", "dropout", "outliers", "noise-burst", "quantisation", "delay"]


PAUSED = "/?experiment=zhao-2012&t=8"


def press(tab, name: str) -> None:
    row(tab, name).locator("button.press:not(.quiet-press)").click()


def test_the_plant_shows_every_fault_site_and_a_click_opens_its_injection(tab):
    """There is a button per channel and output; choosing one focuses its slider, by mouse and by keyboard."""
    live = opened(tab, PAUSED)
    sites = live.locator("svg.plant .site")
    assert sites.count() == live.evaluate(
        "thetascope.state.plant.channels.length + thetascope.state.plant.outputs.length"
    )
    live.locator("svg.plant .site").nth(1).click()
    assert live.evaluate("document.activeElement.closest('.fault').id") == "fault-theta2"
    live.locator("svg.plant .site").nth(0).focus()
    live.keyboard.press("Enter")
    assert live.evaluate("document.activeElement.closest('.fault').id") == "fault-theta1"


def test_an_injected_fault_is_shown_everywhere_and_identified(tab):
    """Inject lights the channel and is logged, an alarm follows, the summary names it; Clear resets all."""
    live = opened(tab, PAUSED)
    press(live, "theta1")
    until(live, "document.querySelectorAll('svg.plant .site')[0].classList.contains('on')")
    until(live, "document.querySelector('#panel-log').textContent.includes('you injected θ₁')")
    live.evaluate("thetascope.act.step(500)")
    until(live, "thetascope.state.alarms.some((alarm) => alarm.subject === 'theta1')")
    until(live, "/identified|found in/.test(document.querySelector('.verdict').textContent)")
    until(live, "/[+−]0\\.0\\d+ ± 0\\.\\d+/.test(document.querySelector('.finding .value').textContent)")
    press(live, "theta1")
    until(live, "!document.querySelectorAll('svg.plant .site')[0].classList.contains('on')")
    assert row(live, "theta1").locator("button.press:not(.quiet-press)").inner_text() == "Inject"
    assert live.watch.errors == [] and live.watch.foreign == []


@pytest.mark.parametrize(("subject", "shapes"), [("theta1", SHAPES), ("y", DISTURBANCES)])
def test_every_shape_can_be_injected_with_its_first_values(tab, subject, shapes):
    """The menu has every shape of the contract; each is accepted with its initial values, and cleared again."""
    live = opened(tab, PAUSED)
    live.click("#panel-inject .heading .link")
    menu = row(live, subject).locator("select.shape")
    assert menu.locator("option").evaluate_all("(all) => all.map((one) => one.value)") == shapes
    button = row(live, subject).locator("button.press:not(.quiet-press)")
    for shape in shapes:
        menu.select_option(shape)
        button.click()
        button.and_(live.locator(".clear")).wait_for()
        last = live.evaluate("thetascope.state.faults.at(-1)")
        assert (last["subject"], last["shape"]) == (subject, shape)
        live.evaluate("thetascope.act.step(2)")
        button.click()
        button.and_(live.locator(":not(.clear)")).wait_for()
        live.evaluate("thetascope.act.step(1)")
        assert row(live, subject).locator(".refused").inner_text() == ""


def test_an_active_fault_is_changed_in_place(tab):
    """Moving the slider of an active fault offers Change; afterwards only the new size is active."""
    live = opened(tab, PAUSED)
    press(live, "theta2")
    row(live, "theta2").locator(".press.clear").wait_for()
    field = row(live, "theta2").locator("input.number")
    field.fill("0.03")
    field.press("Tab")
    row(live, "theta2").locator(".quiet-press").click()
    until(live, "thetascope.state.faults.at(-1).fault.size === 0.03")
    live.evaluate("thetascope.act.step(5)")
    until(live, "Math.abs(thetascope.latest('theta.theta2') - 0.03) < 1e-6")


def test_a_fault_is_changed_by_one_message_while_time_runs(tab):
    """Change sends one batch: time continues, and the old fault ends exactly when the new one begins."""
    live = opened(tab)
    press(live, "theta2")
    row(live, "theta2").locator(".press.clear").wait_for()
    field = row(live, "theta2").locator("input.number")
    field.fill("0.03")
    field.press("Tab")
    live.evaluate("""(() => {
      const {send} = thetascope;
      window.sent = [];
      thetascope.send = (command) => { window.sent.push(command.type); return send(command); };
    })()""")
    row(live, "theta2").locator(".quiet-press").click()
    until(live, "thetascope.state.faults.at(-1).fault.size === 0.03")
    assert live.evaluate("window.sent") == ["batch"] and live.evaluate("thetascope.state.playing")
    old, new = live.evaluate("thetascope.state.faults.slice(-2)")
    assert old["end"] == new["onset"] and old["id"] != new["id"] and new["active"]


def test_the_noise_slider_changes_the_noise(tab):
    """The slider changes the noise of the spec and adds a line to the log."""
    live = opened(tab, PAUSED)
    live.locator(".fault.noise input[type=range]").focus()
    live.keyboard.press("End")
    until(live, "thetascope.state.spec.commands.some((one) => one.command === 'set-noise' && one.std > 0.01)")
    until(live, "document.querySelector('#panel-log').textContent.includes('the noise of y')")


def test_a_gain_follows_its_slider_while_time_runs(tab):
    """Arrow keys on ρ's slider arrive as set-gain; the number beside it agrees with the session."""
    live = opened(tab)
    slider = live.locator("#panel-observers .gain input[type=range]").first
    slider.focus()
    for _ in range(5):
        live.keyboard.press("ArrowRight")
    rho = until(
        live,
        """(() => {
          const {rho} = thetascope.state.observers[0].gains;
          const shown = Number(document.querySelector('#panel-observers .gain input.number').value);
          return rho > 4 && rho === shown ? rho : 0;
        })()""",
    )
    assert 4 < rho < 6


def test_an_observer_is_added_coloured_and_removed(tab):
    """A joint EKF from the menu gets a card and curves in its own colour; the cross removes it."""
    live = opened(tab, PAUSED)
    live.click("#panel-observers .heading .link")
    live.select_option(".add-form > select", "joint-ekf")
    live.click(".add-form button[type=submit]")
    until(live, "thetascope.state.observers.length === 2 && thetascope.state.columns.includes('ekf.theta.theta1')")
    colours = live.locator("#panel-observers .observer .chip").evaluate_all(
        "(all) => all.map((one) => one.style.getPropertyValue('--c'))"
    )
    assert colours == ["var(--o0)", "var(--o1)"]
    live.locator("#panel-observers .observer-head .plain").nth(1).click()
    until(live, "thetascope.state.observers.length === 1")
    assert live.locator("#panel-observers .observer").count() == 1


def test_a_refusal_is_shown_in_the_form(tab):
    """A label that is taken is refused in the form, with the remedy, and nothing is added."""
    live = opened(tab, PAUSED)
    live.click("#panel-observers .heading .link")
    live.fill(".add-form input[type=text]", "adaptive")
    live.click(".add-form button[type=submit]")
    problem = until(live, "document.querySelector('.add-form .refused').textContent")
    assert "label" in problem and "Remedy" in problem
    assert live.evaluate("thetascope.state.observers.length") == 1


def test_kinds_that_do_not_suit_the_plant_cannot_be_chosen(tab):
    """For the two-output motor the single-output observers are disabled, with the reason."""
    live = opened(tab, "/?experiment=dc-motor&t=1")
    live.click("#panel-observers .heading .link")
    until(live, "document.querySelector('.add-form option[value=zhao-adaptive]').disabled")
    assert "output" in live.get_attribute(".add-form option[value=zhao-adaptive]", "title")
    assert live.eval_on_selector(".add-form > select", "(menu) => !menu.selectedOptions[0].disabled")


def test_the_lights_show_the_checks(tab):
    """There is one light per check in the colour of its verdict; a click lists the checks with numbers and sources."""
    live = opened(tab, PAUSED)
    checks = until(live, "thetascope.state.checks.adaptive?.length")
    lights = live.locator("#panel-observers .lights .light")
    assert lights.count() == checks
    live.click("#panel-observers .lights")
    listed = live.locator("#panel-observers .checks li")
    assert listed.count() == checks and re.search(r"\d", listed.nth(2).inner_text())
    held = live.evaluate("thetascope.state.checks.adaptive.filter((one) => one.verdict === 'holds').length")
    assert live.locator("#panel-observers .lights .light.ok").count() == held


def test_gains_that_a_theorem_asks_for_are_taken_with_one_click(tab):
    """With K = (1.2, 1) Theorem 2 fails; the designed K stands in the list, and a click puts it into the observer."""
    live = opened(tab, "/?experiment=shen-hu-2015-noise-free&t=4")
    live.evaluate("thetascope.send({type: 'set-gain', observer: 'linear', gain: 'K', value: [1.2, 1]})")
    live.evaluate("thetascope.act.step(50)")
    until(live, "thetascope.state.checks.linear?.some((one) => one.gains)")
    card = live.locator("#panel-observers .observer[aria-label=linear]")
    card.locator(".lights").click()
    card.locator(".checks button.press").first.click()
    until(live, "thetascope.state.observers.find((one) => one.label === 'linear').gains.K[0] > 1.3")
    live.evaluate("thetascope.act.step(50)")
    until(live, "thetascope.state.checks.linear.every((one) => !one.gains)")


def test_a_question_is_carried_out_with_one_click(tab):
    """The first question lowers λ, and the card shows it."""
    live = opened(tab, PAUSED)
    live.locator("#panel-try .go").first.click()
    until(live, "thetascope.state.observers[0].gains.lambda === 0.6")
    until(live, "[...document.querySelectorAll('#panel-observers input.number')].some((one) => one.value === '0.6')")


def test_the_comparison_is_computed_over_the_window(tab):
    """The RMSE in the table equals that of the columns."""
    live = opened(tab, PAUSED)
    until(
        live,
        """(() => {
      const {t, window: w} = thetascope.state;
      const [a, b] = ['x.x1', 'adaptive.x.x1'].map((name) => thetascope.window(name, Math.max(0, t - w), t).v);
      const rmse = Math.sqrt(a.reduce((sum, value, k) => sum + (value - b[k]) ** 2, 0) / a.length);
      return Math.abs(document.querySelector('#panel-comparison tbody td').textContent / rmse - 1) < 0.051;
        // two digits
    })()""",
    )


def test_an_observer_that_converges_is_marked(tab):
    """Soon after the start the slow observer is marked, with a sentence on bands; long after it no longer is."""
    live = opened(tab, "/?experiment=zhao-2012&t=1")
    until(live, "document.querySelector('#panel-observers .converging:not([hidden])')")
    assert "not the bias" in live.inner_text("#panel-observers .bands-note")
    assert "not the bias" in live.get_attribute(".legend [data-mark=band]", "title")
    live.evaluate("thetascope.act.step(1700)")
    until(
        live, "thetascope.samples.now > 17.9 && !document.querySelector('#panel-observers .converging:not([hidden])')"
    )
    assert not live.is_visible("#panel-observers .bands-note")


def test_a_click_in_the_log_shows_that_moment(tab):
    """The scope shows the time of the event; the session does not go back."""
    live = opened(tab, PAUSED)
    press(live, "theta3")
    until(live, "document.querySelector('#panel-log').textContent.includes('you injected θ₃')")
    rows = live.evaluate("thetascope.state.row")
    live.locator("#panel-log .moment").first.click()
    assert live.evaluate("thetascope.state.selection !== null") and live.evaluate("thetascope.state.row") >= rows


def test_the_longest_sentence_covers_nothing(tab):
    """With a summary of three lines the findings are below it, and no line overlaps another."""
    live = opened(tab, "/?experiment=zhao-2012&t=24")
    until(live, "/found in/.test(document.querySelector('.verdict').textContent)")
    live.evaluate("thetascope.send({type: 'inject', fault: {output: 'y', shape: 'stuck', onset: 0, value: 0.1}})")
    until(live, "/not judged that far yet|y is disturbed/.test(document.querySelector('.verdict').textContent)")
    rested(live)
    inside = live.evaluate(
        "(() => { const box = document.querySelector('.verdict'); return box.scrollHeight <= box.clientHeight + 1; })()"
    )
    below = live.evaluate(
        "document.querySelector('.finding').getBoundingClientRect().top >= "
        "document.querySelector('.verdict').getBoundingClientRect().bottom - 1"
    )
    lines = live.locator(".finding .line").evaluate_all("(all) => all.map((one) => one.clientHeight)")
    assert inside and below and max(lines) < 30


def test_a_fault_has_the_same_badge_everywhere(tab):
    """A channel with a long name has one badge in the plant, in the list and at its strip; sentences use its title."""
    live = opened(tab, "/?experiment=dc-motor&t=1")
    badge = live.locator("#fault-load_torque .badge").inner_text().replace("\n", "")
    assert live.locator("svg.plant .site").nth(1).locator("text").text_content() == badge
    assert live.locator('[data-strip="theta.load_torque"] .sign').inner_text() == badge
    press(live, "load_torque")
    until(live, "document.querySelector('#panel-log').textContent.includes('you injected unknown load torque')")


def test_a_second_fault_does_not_inherit_the_duration_of_the_first(tab):
    """After Inject and Clear the next fault has no end; a typed duration is kept."""
    live = opened(tab, PAUSED)

    def pressed(active: bool) -> dict:
        """Inject or clear, go on for half a second, and return the last fault."""
        press(live, "theta2")
        row(live, "theta2").locator(".press.clear" if active else ".press:not(.clear):not(.quiet-press)").wait_for()
        live.evaluate("thetascope.act.step(50)")
        return until(
            live,
            f"thetascope.state.faults.at(-1).active === {str(active).lower()} && thetascope.state.faults.at(-1)",
        )

    pressed(True)
    first = pressed(False)
    lasted = first["end"] - first["onset"]
    assert lasted > 0
    second = pressed(True)
    live.evaluate("thetascope.act.step(100)")
    last = until(
        live,
        f"thetascope.state.t > {second['onset'] + lasted + 0.5} && thetascope.state.faults.at(-1)",
    )
    assert last["active"] and last["end"] is None and row(live, "theta2").locator(".summary").inner_text() == ""
    pressed(False)
    row(live, "theta2").locator(".dots").click()
    field = row(live, "theta2").locator(".entries input").last
    field.fill("50")
    field.press("Enter")
    pressed(True)
    pressed(False)
    assert "50" in row(live, "theta2").locator(".summary").inner_text()


@pytest.mark.parametrize(("width", "height"), [(1366, 768), (1280, 720), (1440, 900)])
def test_the_form_for_an_observer_can_be_reached_with_a_mouse(kept_page, width, height):
    """With three observers on a usual screen the Add button can be clicked, and Escape closes the form."""
    live = opened(kept_page, "/?experiment=dc-motor&t=2", width=width, height=height)
    live.click("#panel-observers .heading .link")
    hit = live.evaluate("""(() => {
      const button = document.querySelector('.add-form button[type=submit]');
      const {x, y, width, height} = button.getBoundingClientRect();
      return document.elementFromPoint(x + width / 2, y + height / 2) === button;
    })()""")
    assert hit
    live.keyboard.press("Escape")
    assert live.is_hidden(".add-form") and live.evaluate("document.activeElement.textContent") == "+ add"


def test_the_title_counts_the_running_observers(tab):
    """An added observer counts until it is removed."""
    live = opened(tab, PAUSED)
    assert "1 observer" in live.inner_text("#panel-title")
    live.evaluate("thetascope.send({type: 'remove-observer', label: 'adaptive'})")
    until(live, "/0 observers/.test(document.querySelector('#panel-title').textContent)")


def test_looking_back_shows_the_diagnosis_of_that_moment(tab):
    """Before the fault, nothing is found; the card states its time. Back at the present the fault is identified."""
    live = opened(tab, "/?experiment=zhao-2012&t=30")
    verdict = "document.querySelector('.verdict').textContent"
    until(live, f"{verdict}.includes('θ₃')")
    tag = live.locator("#panel-diagnosis .as-of-now")
    assert tag.is_hidden()
    live.evaluate("thetascope.act.look(19)")
    tag.wait_for()
    assert tag.inner_text() == "at 19.0\u202fs"
    assert live.inner_text(".verdict") == "No fault." and live.locator("#panel-diagnosis .finding").count() == 0
    live.evaluate("thetascope.act.look(null)")
    tag.wait_for(state="hidden")
    assert "θ₃" in live.inner_text(".verdict")


def test_no_row_of_the_last_plant_is_left_while_the_next_one_is_awaited(tab):
    """Until the shapes of faults have arrived the panel is empty: it never injects into another plant."""
    live = opened(tab, PAUSED)
    spec = live.evaluate("fetch('/api/experiments/dc-motor?lang=*').then((answer) => answer.json())")
    live.evaluate("""() => {
      const {fetch: ask} = window;
      const held = new Promise((done) => { window.release = done; });
      window.fetch = async (address, options) => {
        if (String(address).includes('/api/catalogue')) await held;
        return ask(address, options);
      };
    }""")
    live.evaluate("thetascope.act.language('zh')")
    live.evaluate("(spec) => thetascope.act.openSpec(spec, {t: 1})", spec)
    until(live, "thetascope.state.plant?.id === 'dc-motor'")
    rested(live)
    assert live.locator("#panel-inject .fault").count() == 0
    live.evaluate("release()")
    live.wait_for_selector("#fault-load_torque")
    assert live.locator("#fault-theta1").count() == 0
