"""The presentation mode: tabs, actions, entering and leaving, and that nothing overlaps, is cut or moves."""

import pytest

from tests.browser.live_helpers import opened, reload, rested, row, until
from tests.browser.test_accessibility import UNFOLD, serious, with_faults

TABS = {"inject": "I", "inputs": "U", "truth": "R", "observers": "O", "comparison": "M", "log": "G", "try": "Y"}
SIZES = [(1920, 1080), (1440, 900), (1280, 720), (1024, 768)]
SHOWN = """[...document.querySelectorAll('.desk > [role=tabpanel]')].filter((one) => one.checkVisibility())
  .map((one) => one.id)"""
PLACES = """[...document.querySelectorAll('.col')]
  .map((column) => [column.className, ...[...column.children].map((one) => one.id)])"""
BOXES = """Object.fromEntries(['#panel-title', '.connection', '#timeline', '#transport', '.marks', '#scope',
  '.strips', '#panel-diagnosis', '.verdict', '#panel-plant', 'svg.plant', '.desk', '.desk-tabs'].map((name) => {
  const {x, y, width, height} = document.querySelector(name).getBoundingClientRect();
  return [name, [x, y, width, height].map(Math.round).join(' ')]; }))"""
#: Controls and parts that overlap or reach out of the window or of their card. Items that a list has scrolled count as
#: far as they are visible.
WRONG = """(() => {
  const seen = (element) => {
    let {left, top, right, bottom} = element.getBoundingClientRect();
    for (let at = element.parentElement; at; at = at.parentElement) {
      if (!at.matches('.scroll, .strips')) continue;
      const box = at.getBoundingClientRect();
      [top, bottom] = [Math.max(top, box.top), Math.min(bottom, box.bottom)];
    }
    return {element, left, top, right, bottom};
  };
  const name = ({element}) => element.id || element.getAttribute('aria-label')
    || element.textContent.trim().slice(0, 30) || element.className;
  const all = (selector) => [...document.querySelectorAll(selector)]
    .filter((one) => one.checkVisibility({opacityProperty: true})).map(seen)
    .filter((box) => box.right - box.left > 1 && box.bottom - box.top > 1);
  const wrong = [];
  const apart = (boxes) => boxes.forEach((a, at) => boxes.slice(at + 1).forEach((b) => {
    const over = Math.min(
      Math.min(a.right, b.right) - Math.max(a.left, b.left), Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top));
    if (over > 1 && !a.element.contains(b.element)) wrong.push(`${name(a)} / ${name(b)}`);
  }));
  const controls = all('button, select, input:not([type=checkbox]), .clock, .connection, .rail, .verdict, .unresolved');
  const cards = all('#scope, #hysteresis, #panel-diagnosis, #panel-plant, .desk');
  apart(controls);
  apart(cards);
  for (const box of [...controls, ...cards]) {
    if (box.left < 0 || box.top < 0 || box.right > innerWidth
      || box.bottom > innerHeight) wrong.push(`${name(box)} leaves the window`);
    const card = box.element.parentElement.closest('.card:not(.desk > .card)')?.getBoundingClientRect();
    if (card && (box.left < card.left || box.right > card.right || box.top < card.top
      || box.bottom > card.bottom)) wrong.push(`${name(box)} leaves its card`);
  }
  for (const {element} of controls) if (element.matches('button') && element.scrollWidth > element.clientWidth + 1
    && !element.matches('.moment, .plain-words')) wrong.push(`${name({element})} is cut`);
  if (document.documentElement.scrollWidth > innerWidth) wrong.push('the page is too wide');
  return wrong;
})()"""


#: Two frames: sizes that follow from sizes are settled then.
DRAWN = "(async () => { await drawn(); await drawn(); await new Promise((done) => setTimeout(done, 20)); })()"


def presented(page, path: str = "/?experiment=zhao-2012&t=24", **more):
    """Return the page in presentation mode, paused, without its first notice."""
    live = opened(page, path, **more)
    live.evaluate(
        "thetascope.act.present(true); thetascope.act.pause(); thetascope.store.dispatch({type: 'set', notice: null})"
    )
    live.wait_for_selector(".desk .fault")
    return live


def test_every_tab_shows_its_panel_and_no_other(tab):
    """By click, arrow and key; the panel is labelled by the tab, and only the chosen tab is in the Tab order."""
    live = presented(tab)
    for name in TABS:
        live.click(f"#desk-{name}")
        assert live.evaluate(SHOWN) == [f"panel-{name}"]
        assert live.get_attribute(f"#panel-{name}", "aria-labelledby") == f"desk-{name}"
        assert live.locator("[role=tab][tabindex='0']").evaluate_all("(all) => all.map((one) => one.id)") == [
            f"desk-{name}"
        ]
    live.keyboard.press("ArrowRight")
    assert live.evaluate(SHOWN) == ["panel-inject"] and live.evaluate("document.activeElement.id") == "desk-inject"
    live.keyboard.press("End")
    assert live.evaluate(SHOWN) == ["panel-try"]
    live.evaluate("document.activeElement.blur()")
    for name, key in TABS.items():
        live.keyboard.press(key.lower())
        assert live.evaluate(SHOWN) == [f"panel-{name}"]
    live.keyboard.press("?")
    assert all(live.locator(f"dialog kbd:text-is('{key}')").count() for key in TABS.values())


def test_the_panels_work_while_presenting(tab):
    """A gain follows its slider, an observer is added in the card, a question is carried out, and all are logged."""
    live = presented(tab)
    live.keyboard.press("o")
    live.locator("#panel-observers .gain input[type=range]").first.focus()
    for _ in range(5):
        live.keyboard.press("ArrowRight")
    until(live, "thetascope.state.observers[0].gains.rho > 4")
    before = live.evaluate(BOXES)
    live.click("#panel-observers .heading .link")
    live.select_option(".add-form > select", "joint-ekf")
    assert live.evaluate(BOXES) == before
    live.click(".add-form button[type=submit]")
    until(
        live,
        "thetascope.state.observers.length === 2 && document.querySelectorAll('#panel-observers .observer').length "
        "=== 2",
    )
    rested(live)
    assert live.evaluate(WRONG) == []
    live.keyboard.press("m")
    assert live.locator("#panel-comparison tbody tr:not(.detector)").count() == 2
    live.keyboard.press("y")
    live.locator("#panel-try .go").first.click()
    until(live, "thetascope.state.observers[0].gains.lambda === 0.6")
    live.click("#desk-log")
    assert "you set λ of adaptive" in live.inner_text("#panel-log")


def test_further_strips_are_shown_to_the_room(tab):
    """Excitation, residual and input are chosen in the menu of strips, and nothing overlaps."""
    live = presented(tab)
    assert (
        live.locator(".strip[data-kind=excitation], .strip[data-kind=residual], .strip[data-kind=input]").count() == 0
    )
    live.click(".strips-menu summary")
    for name in ("excitation", "residual.y", "u.u"):
        live.evaluate(f"thetascope.act.strip('{name}', true)")
    live.keyboard.press("Escape")
    until(live, "document.querySelectorAll('.strip').length === 7")
    rested(live)
    input = live.locator('.strip[data-strip="u.u"]')
    until(live, "Number(document.querySelector('.strip[data-strip=\"u.u\"] .strip-values span').textContent) > 0")
    assert input.is_visible()
    assert live.evaluate(WRONG) == []


def test_inputs_are_moved_in_their_tab(tab):
    """Every input and signal is unfolded in the card; a slider acts; leaving folds the panel again."""
    live = presented(tab)
    live.keyboard.press("u")
    live.locator("#panel-inputs select.shape").first.select_option("constant")
    until(live, "thetascope.state.log.some(({kind}) => kind === 'signal')")
    rested(live)
    assert live.evaluate(WRONG) == []
    live.keyboard.press("p")
    live.wait_for_selector("#panel-inputs:not(.open)")


def test_a_fault_channel_in_the_plant_opens_its_injection(tab):
    """From another tab: the card switches to Inject, and the row is visible and focused; a number key does the same."""
    live = presented(tab, "/?experiment=dts200&t=10", width=1280, height=720)
    whole = """(name) => { const row = document.getElementById(`fault-${name}`).getBoundingClientRect();
      const list = document.querySelector('.faults').getBoundingClientRect(); return row.top >= list.top - 1
        && row.bottom <= list.bottom + 1; }"""
    live.click("#desk-log")
    last = live.evaluate("thetascope.state.plant.channels.at(-1).name")
    live.locator("svg.plant .site:not(.output)").last.click()
    chosen = live.evaluate("document.activeElement.closest('.fault').id").removeprefix("fault-")
    assert live.evaluate(SHOWN) == ["panel-inject"]
    until(live, f"({whole})('{chosen}')")
    assert live.evaluate("thetascope.state.site") == chosen
    live.evaluate(f"thetascope.act.desk('try'); thetascope.act.site('{last}')")
    until(live, f"({whole})('{last}')")
    row(live, last).locator(".press:not(.quiet-press)").click()
    row(live, last).locator(".press.clear").wait_for()
    live.keyboard.press("g")
    live.keyboard.press("1")
    assert (
        live.evaluate("document.activeElement.closest('.fault').id")
        == f"fault-{live.evaluate('thetascope.state.plant.channels[0].name')}"
    )


@pytest.mark.parametrize("way", ["p", "Escape", "button"])
def test_leaving_restores_the_normal_page(tab, way):
    """Panels are in their places; session, window and zoom are unchanged; no tab remains."""
    live = opened(tab, "/?experiment=zhao-2012&t=30")
    live.evaluate("thetascope.act.pause(); thetascope.act.window(10)")
    before = live.evaluate(PLACES)
    kept = """[thetascope.state.session, thetascope.state.window, thetascope.state.row,
      document.querySelector('.observer input.number').value]"""
    same = live.evaluate(kept)
    live.keyboard.press("p")
    live.wait_for_selector("#desk-inject")
    assert live.evaluate(PLACES) != before and live.evaluate(kept) == same
    live.evaluate("thetascope.act.select(12, 15)")
    live.keyboard.press("o")
    if way == "Escape":  # what is zoomed to comes first
        live.keyboard.press("Escape")
        assert live.evaluate("thetascope.state.presentation") and live.evaluate("thetascope.state.selection") is None
    if way == "button":
        live.click(".marks button:has-text('Leave')")
    else:
        live.keyboard.press(way)
    live.wait_for_selector(".beside", state="detached")
    assert live.evaluate(PLACES) == before and live.evaluate(kept) == same
    assert live.evaluate("thetascope.state.selection") == (None if way == "Escape" else [12, 15])
    assert live.locator("[role=tabpanel], [data-off], #desk-inject").count() == 0
    for name in (*TABS, "plant", "diagnosis"):
        assert live.is_visible(f"#panel-{name}")


def test_escape_closes_menus_and_dialogs_first(tab):
    """The list of experiments, the menu of strips, a dialog and a form each take an Escape before the presentation
    ends."""
    live = presented(tab)
    opens = {
        ".chooser-menu": ".experiment",
        ".strips-menu[open]": ".strips-menu summary",
        "dialog[open]": "#panel-plant .link",
        ".add-form": "#panel-observers .heading .link",
    }
    live.click("#desk-observers")
    for what, button in opens.items():
        live.click(button)
        live.wait_for_selector(what)
        live.keyboard.press("Escape")
        live.wait_for_selector(what, state="hidden")
        assert live.evaluate("thetascope.state.presentation"), what
    live.keyboard.press("Escape")
    until(live, "!thetascope.state.presentation")


def test_a_reload_keeps_the_presentation(page):
    """After leaving, a reload does not restore it."""
    live = presented(page)
    until(live, "history.state?.session !== undefined")
    session = live.evaluate("thetascope.state.session")
    reload(live)
    until(
        live,
        f"window.thetascope?.state.session === '{session}' && thetascope.state.presentation && "
        f"document.querySelector('.desk .fault') !== null",
    )
    live.keyboard.press("p")
    reload(live)
    until(live, "window.thetascope?.state.spec !== null && document.querySelector('#panel-inject .fault') !== null")
    assert not live.evaluate("thetascope.state.presentation") and live.is_visible(".pages")


def test_the_bar_shows_view_only_and_a_lost_connection(tab, page, server):
    """ "View only" is always shown, and in another colour a lost connection."""
    live = presented(tab, width=1024, height=768)
    link = live.evaluate("thetascope.act.link({view: true})")
    viewer = opened(page, link.removeprefix(server), width=1024, height=768)
    viewer.evaluate("thetascope.act.present(true)")
    connection = viewer.locator(".connection")
    assert connection.is_visible() and connection.inner_text() == "view only · live · 2 viewers"
    assert viewer.locator("#desk-try").is_disabled()  # the questions are for who controls the session
    viewer.evaluate("thetascope.store.dispatch({type: 'connection', now: 'reconnecting'})")
    assert connection.inner_text().startswith("view only · connection lost") and connection.is_visible()
    assert (
        viewer.locator(".connection .dot").evaluate("(dot) => getComputedStyle(dot).backgroundColor")
        == "rgb(194, 65, 12)"
    )


@pytest.mark.parametrize(
    ("number", "experiment"),
    list(enumerate(["zhao-2012", "zhou-tan-2012", "dts200", "quadruple-tank", "zhao-2012-observers"])),
)
def test_nothing_overlaps_or_is_cut(tab, number, experiment):
    """On every tab, at four sizes, in either language: controls and cards are complete; from 900 px two rows each are
    visible.

    The language alternates along sizes and experiments, so every pair of size, language and tab occurs.
    """
    live = presented(tab, f"/?experiment={experiment}&t=2")
    live.evaluate(
        "thetascope.send({type: 'inject', fault: {channel: thetascope.state.plant.channels[0].name, shape: 'step', "
        "onset: 0, size: 1e-3}})"
    )
    inside = """(selector) => { const all = [...document.querySelectorAll(selector)];
      const list = all[0].closest('.scroll').getBoundingClientRect();
      return all.filter((one) => one.getBoundingClientRect().bottom <= list.bottom + 1).length; }"""
    wrong = {}
    for place, (width, height) in enumerate(SIZES):
        live.set_viewport_size({"width": width, "height": height})
        language = ("zh", "en")[(place + number) % 2]
        live.evaluate(f"thetascope.act.language('{language}')")
        for name in TABS:
            live.evaluate(f"thetascope.act.desk('{name}')")
            live.evaluate(DRAWN)
            found = live.evaluate(WRONG)
            if found:
                wrong[f"{width} {language} {name}"] = found
            if name in ("inject", "observers"):
                many = live.evaluate(inside, ".fault:not([hidden])" if name == "inject" else ".observer")
                needed = min(2, live.locator(".observer").count() if name == "observers" else 2)
                assert many >= needed or height < 900, (width, name, many)
    assert wrong == {}


@pytest.mark.parametrize(("width", "height"), [(1440, 900), (1024, 768)])
def test_nothing_moves(tab, width, height):
    """Faults, alarms, summaries of one and three lines, and an unfolded list: every part keeps its place."""
    live = presented(tab, "/?experiment=zhao-2012&t=10", width=width, height=height)
    until(live, "/No fault/.test(document.querySelector('.verdict').textContent)")
    before = live.evaluate(BOXES)
    live.evaluate("thetascope.send({type: 'inject', fault: {channel: 'theta1', shape: 'step', onset: 0, size: 0.01}})")
    live.evaluate("thetascope.send({type: 'inject', fault: {channel: 'theta3', shape: 'step', onset: 0, size: 0.02}})")
    assert live.evaluate(BOXES) == before
    live.evaluate("thetascope.act.step(1000)")
    until(live, "thetascope.state.alarms.length >= 2")
    assert live.evaluate(BOXES) == before
    live.evaluate("thetascope.send({type: 'inject', fault: {output: 'y', shape: 'stuck', onset: 0, value: 0.1}})")
    until(live, "/y is disturbed/.test(document.querySelector('.verdict').textContent)")
    assert live.evaluate(BOXES) == before
    live.locator("#panel-diagnosis .link").first.click()
    assert live.is_visible("#panel-diagnosis .fold-out") and live.is_hidden("#panel-plant")
    open_ = live.evaluate(BOXES)
    assert [open_[name] for name in (".desk", "#scope", ".verdict")] == [
        before[name] for name in (".desk", "#scope", ".verdict")
    ]
    live.locator("#panel-diagnosis .link").first.click()
    assert live.evaluate(BOXES) == before


@pytest.mark.parametrize(
    ("path", "theme", "language"),
    [("/?experiment=zhao-2012&t=12", "light", "en"), ("/?experiment=zhou-tan-2012&t=2", "dark", "zh")],
)
def test_axe_finds_nothing_serious(tab, path, theme, language):
    """The whole page, then every tab's panel, as it is and unfolded, while presenting."""
    live = with_faults(tab, path, width=1280, height=720, theme=theme)
    live.evaluate(f"thetascope.act.language('{language}'); thetascope.act.present(true)")
    found = {"as it opens": serious(live)}
    for name in TABS:
        live.click(f"#desk-{name}")
        found[name] = serious(live, within=".desk")
    live.evaluate(UNFOLD)
    for name in ("inject", "observers"):
        live.click(f"#desk-{name}")
        found[f"{name}, unfolded"] = serious(live, within=".desk")
    assert {name: what for name, what in found.items() if what} == {}
