"""The workshop: a plant is typed, checked, saved, found again and opened live; and what all pages share."""

import pytest

from tests.browser.live_helpers import eventually, until
from tests.browser.test_accessibility import AXE, serious
from tests.browser.test_chinese_pages import chinese, english
from tests.test_docs import ROOT, blocks

TANK = blocks(ROOT / "docs" / "plant-format.md", "yaml")[0]
#: Replace the text of the editor as somebody does who pastes another one.
PASTE = """(text) => {
  const content = document.querySelector('.cm-content');
  content.focus();
  getSelection().selectAllChildren(content);
  document.execCommand('selectAll');
  const data = new DataTransfer();
  data.setData('text/plain', text);
  content.dispatchEvent(new ClipboardEvent('paste', {clipboardData: data, bubbles: true, cancelable: true}));
}"""
CHECKED = "!document.querySelector('.verdict.busy')"
READY = f"{CHECKED} && document.querySelector('#open-live')?.getAttribute('aria-disabled') === 'false'"


def paste(shop, text: str) -> None:
    """Paste a text over the present one, and wait until it is checked."""
    until(shop, "document.querySelector('.verdict') && " + CHECKED)
    shop.evaluate(PASTE, text)
    until(shop, CHECKED)


@pytest.fixture
def shop(kept_page):
    """Return the workshop with the docs' example; it is one tab for the tests of this file."""
    opened = kept_page("/workshop/")
    if "/workshop/" not in opened.url:
        opened.goto(opened.url.partition("/#")[0].rstrip("/") + "/workshop/")
    until(opened, "document.querySelector('.cm-content') && document.querySelector('.shop-list .item')")
    return opened


def test_an_error_is_shown_where_it_is_and_corrected_with_one_click(shop):
    """The example of the documentation works as it is pasted; a misspelt function is underlined and replaced."""
    paste(shop, TANK)
    until(shop, READY + " && document.querySelectorAll('.eqs math').length >= 3")
    paste(shop, TANK.replace("sqrt", "sqr"))
    wrong = shop.locator(".wavy")
    assert wrong.first.inner_text() == "sqr" and "sqrt" in shop.locator(".lint").first.inner_text()
    assert shop.get_attribute("#open-live", "aria-disabled") == "true"
    assert shop.locator(".stale").is_visible() and shop.locator(".eqs math").count() >= 3
    for _ in range(wrong.count()):
        shop.click(".lint .press >> nth=0")
        until(shop, CHECKED)
    until(shop, READY + " && !document.querySelector('.lint, .stale:not([hidden])')")
    assert shop.watch.errors == [] and shop.watch.foreign == []


def test_long_equations_are_broken_before_a_term(shop):
    """Every term of the three tanks is inside its card, none is cut at the edge."""
    plants = ROOT / "backend" / "thetascope" / "library" / "plants"
    paste(shop, (plants / "dts200.yaml").read_text(encoding="utf-8"))
    until(shop, CHECKED + " && document.querySelectorAll('.eqs .line.broken').length >= 3")
    cut = """() => {
      const edge = document.querySelector('.eqs').getBoundingClientRect().right + 1;
      const cut = (one) => one.getBoundingClientRect().right > edge;
      return [...document.querySelectorAll('.eqs math')].filter(cut).length;
    }"""
    eventually(lambda: shop.evaluate(cut) == 0, "no term is cut")


def test_a_saved_plant_is_found_again_and_its_deletion_undone(shop):
    """Each save is a version; another load of the page shows the plant; a deleted one comes back."""
    mine = TANK.replace("id: leaky-tank", "id: shop-tank").replace("title: Tank with a pump", "title: Mine")
    paste(shop, mine)
    until(shop, READY)
    shop.keyboard.press("Control+s")
    until(shop, "document.querySelector('.mine .on b')?.textContent === 'Mine'")
    paste(shop, mine + "# changed\n")
    shop.click("#save-plant")
    until(shop, "document.querySelector('.mine .on .sub')?.textContent.includes('version 2')")
    shop.goto(shop.url)
    until(shop, "document.querySelector('.cm-content')?.textContent.includes('# changed')")
    entries = "[...document.querySelectorAll('.mine .entry b')].filter((one) => one.textContent === 'Mine').length"
    shop.hover(".mine .entry.on")
    shop.click(".mine .on .remove")
    until(shop, f"{entries} === 0")
    shop.click(".shop-bar .state .link")
    until(shop, f"{entries} === 1")


def test_versions_and_shapes_of_the_preview_are_chosen_from_menus(shop):
    """An earlier version comes back with its text, an input of the preview gets another shape."""
    first = TANK.replace("id: leaky-tank", "id: versioned").replace("title: Tank with a pump", "title: 水箱")
    for text in (first, first + "# later\n"):
        paste(shop, text)
        until(shop, READY)
        shop.click("#save-plant")
        until(shop, "document.querySelector('.shop-bar .sub').textContent.includes('saved')")
    until(shop, "document.querySelector('.mine .versions')?.options.length === 2")
    shop.select_option(".mine .versions", "1")
    until(shop, "!document.querySelector('.cm-content').textContent.includes('# later')")
    until(shop, READY + " && document.querySelector('.preview-input select')")
    before = shop.locator(".preview-strip .input").first.get_attribute("d")
    shop.select_option(".preview-input select", "sine")
    until(
        shop,
        f"![null, undefined, {before!r}].includes(document.querySelector('.preview-strip .input')?.getAttribute('d'))",
    )
    assert shop.locator(".preview-input select").input_value() == "sine"


def test_the_remedy_of_an_error_stays_in_sight_beside_long_lines(shop):
    """The button is within the editor, also where another line is far wider."""
    paste(shop, TANK.replace("name: h, unit", "name: h，unit") + f"# {'long ' * 80}\n")
    until(shop, "document.querySelector('.lint .press')")
    button, editor = (shop.locator(name).first.bounding_box() for name in (".lint .press", ".editor-card"))
    assert button["x"] + button["width"] <= editor["x"] + editor["width"]
    shop.click(".lint .press")
    until(shop, READY)


def test_a_fault_is_added_by_pointing_at_an_equation(shop):
    """The consequences are in sight before; Escape leaves no trace, and Add leaves the new channel with its bounds."""
    paste(shop, TANK)
    until(shop, READY + " && document.querySelector('.matrix')")
    columns = shop.locator(".matrix thead th").count()
    shop.click("button.eq >> nth=0")
    until(shop, f"document.querySelectorAll('.matrix thead th').length === {columns + 1}")
    assert shop.locator(".new-line").count() >= 3
    shop.keyboard.press("Escape")
    until(shop, f"document.querySelectorAll('.matrix thead th').length === {columns}")
    shop.click("button.eq >> nth=0")
    shop.click(".pattern:has-text('Bias')")
    shop.fill("#fault-name", "draught")
    until(shop, "document.querySelector('.matrix .rowname:last-child, .matrix tbody')?.textContent.includes('draught')")
    shop.fill("#fault-low", "-2")
    shop.fill("#fault-high", "x")
    until(shop, "document.querySelector('#fault-high').ariaInvalid === 'true'")
    shop.fill("#fault-high", "5")
    until(shop, "document.querySelector('.cm-content').textContent.includes('bounds: [-2.0, 5.0]')")
    shop.click("#add-fault")
    assert not shop.locator(".fault-popover").count()
    until(shop, READY + " && document.querySelector('.eqs').textContent.includes('draught')")


def test_a_plant_is_opened_live_with_two_observers(shop):
    """The session has the plant, an input that moves, and the observers that are ticked."""
    paste(shop, TANK)
    until(shop, READY + " && document.querySelectorAll('.ranked input:checked').length === 2")
    assert shop.locator(".matrix td").count() >= 4 and shop.locator(".preview-strip").count() >= 2
    shop.click("#open-live")
    until(shop, "window.thetascope?.state.plant && thetascope.state.observers.length")
    assert shop.evaluate("[thetascope.state.observers.length, thetascope.state.spec.plant.id]") == [2, "leaky-tank"]


def test_without_the_bundle_a_plain_field_has_the_same_checks(page, context):
    """Where set-up could not make the editor, errors are listed below a field, and corrected with one click."""
    context.route("**/vendor/codemirror.js", lambda route: route.abort())
    try:
        opened = page("/workshop/")
        until(opened, READY)
        field = opened.locator(".plain-text")
        field.fill(TANK.replace("sqrt", "sqr"))
        opened.wait_for_selector(".plain-errors .press")
        while opened.locator(".plain-errors .press").count():
            opened.locator(".plain-errors .press").first.click()
            until(opened, CHECKED)
        until(opened, READY)
        assert "sqrt" in field.input_value() and "sqr(" not in field.input_value()
    finally:
        context.unroute("**/vendor/codemirror.js")


def test_the_workshop_is_chinese_and_accessible_on_a_phone(page):
    """No visible sentence is English, axe finds nothing serious, and nothing is wider than the screen."""
    opened = chinese(page, "/workshop/?library=level-loop", width=390, height=844)
    until(opened, READY + " && document.querySelector('.ranked')")
    opened.evaluate("for (const one of document.querySelectorAll('details')) one.open = true")
    assert english(opened) == set()
    opened.evaluate(AXE)
    assert serious(opened) == []
    assert opened.evaluate("document.documentElement.scrollWidth") <= 390


def test_a_damaged_link_is_reported(page):
    """Another plant is shown instead, and the page says that the link was not complete."""
    opened = page("/workshop/#p=broken")
    until(opened, "/link is damaged/.test(document.body.innerText) && document.querySelector('.cm-content')")
    assert opened.watch.errors == []


def test_the_pages_link_to_each_other_and_share_the_language(page, server):
    """All pages are one click away, and a chosen language applies to all."""
    opened = page("/plants/")
    opened.wait_for_url(f"{server}/workshop/**")
    until(opened, "document.querySelector('.top .languages') !== null")
    # clicked by script: after the redirect the browser may show no frames for minutes, and the mouse waits for them
    opened.evaluate("document.querySelector('.top .languages').click()")
    until(opened, "document.querySelector('.pages [aria-current]')?.textContent === '工作台'")
    opened.evaluate("[...document.querySelectorAll('.pages a')].find((a) => a.textContent === '仿真').click()")
    opened.wait_for_url(f"{server}/runs/**")
    until(opened, "document.querySelector('.pages [aria-current]')?.textContent === '仿真'")
    opened.evaluate("[...document.querySelectorAll('.pages a')].find((a) => a.textContent === '实时').click()")
    until(opened, "document.querySelector('#panel-inject h2')?.textContent === '注入故障'")
