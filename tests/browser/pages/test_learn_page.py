"""The course in a browser: the overview, and a lesson with right and wrong answers, by keyboard, in both languages."""

import pytest

from tests.browser.live_helpers import APP, eventually, until
from tests.browser.test_accessibility import AXE, serious
from thetascope import library

LESSON = "/?lesson=what-you-cannot-see"


def entered(page, step: int) -> None:
    """Wait until the session of a step is there, before its answer."""
    until(
        page,
        f"{APP}?.state.lesson?.place === {step - 1} && {APP}.state.connection === 'live' && {APP}.state.plant && "
        "document.querySelector('.lesson-card[data-phase=before]')",
    )


def test_a_new_visitor_begins_and_finds_the_place_again(page):
    """The button leads into the first lesson; a right and a wrong answer are told with numbers of the session."""
    learn = page("/learn/")
    learn.wait_for_selector(".learn-card")
    assert learn.inner_text("[aria-current=page]") == "Learn"
    learn.evaluate(AXE)
    assert serious(learn) == []
    learn.click(".learn-go")
    entered(learn, 1)
    learn.keyboard.press("Enter")  # nothing is chosen: it does not run
    assert learn.get_attribute(".lesson-act .run", "aria-disabled") == "true"
    learn.keyboard.press("2")
    learn.keyboard.press("Enter")
    learn.wait_for_selector(".feedback.right")
    gap = learn.evaluate(f"{APP}.latest('x.h1') - {APP}.latest('copy.x.h1')")
    assert f"{gap:.2f} cm" in learn.inner_text(".feedback")
    learn.keyboard.press("Enter")
    entered(learn, 2)
    learn.keyboard.press("1")
    learn.keyboard.press("Enter")
    learn.wait_for_selector(".feedback:not(.right)")
    assert "Not this time" in learn.inner_text(".feedback")
    assert "LOOK HERE FIRST" in learn.inner_text(".why").upper()
    learn.evaluate(AXE)
    assert serious(learn) == []
    learn.reload()
    learn.wait_for_selector(".feedback:not(.right)")
    assert "Stay wrong" in learn.inner_text(".feedback")
    learn.goto(learn.url.split("?")[0] + "learn/")
    learn.wait_for_selector(".learn-card.here")
    assert "Continue lesson 1" in learn.inner_text(".learn-go")
    assert learn.watch.errors == [] and learn.watch.foreign == []


def test_a_gain_is_right_where_the_session_says_so(page):
    """The dial's first value is too slow, another one meets the target; the truth can be hidden."""
    lesson = page(f"{LESSON}&step=3")
    entered(lesson, 3)
    lesson.keyboard.press("PageDown")
    lesson.wait_for_selector(".feedback:not(.right)")
    lesson.click(".lesson-act .quiet")
    entered(lesson, 3)
    lesson.fill(".dial .number", "0.25")
    lesson.keyboard.press("Tab")
    lesson.click(".lesson-act .run")
    lesson.wait_for_selector(".feedback.right")
    assert lesson.evaluate(f"{APP}.strips().find(({{name}}) => name === 'x.h1').truth") == "x.h1"
    lesson.keyboard.press("h")
    assert lesson.evaluate(f"{APP}.strips().find(({{name}}) => name === 'x.h1').truth") is None
    assert lesson.watch.errors == []


def test_a_line_is_drawn_where_the_student_sets_it(page):
    """The dial moves the line on the strip; what counts is the alarms of that line."""
    lesson = page("/?lesson=a-threshold-you-can-defend&step=5")
    entered(lesson, 5)
    line = f"{APP}.strips().find(({{name}}) => name === 'residual.y').line"
    assert lesson.evaluate(line) == 0.05
    assert "alarm line" in lesson.inner_text("#scope")
    lesson.keyboard.press("PageDown")
    lesson.wait_for_selector(".feedback:not(.right)")
    lesson.click(".lesson-act .quiet")
    entered(lesson, 5)
    lesson.fill(".dial .number", "0.096")
    lesson.keyboard.press("Tab")
    until(lesson, f"{line} === 0.096")
    lesson.click(".lesson-act .run")
    lesson.wait_for_selector(".feedback.right")
    lesson.reload()
    lesson.wait_for_selector(".feedback.right")
    assert lesson.evaluate(line) == 0.096
    assert lesson.watch.errors == []


def test_a_student_draws_a_curve_and_points_at_a_place(page):
    """Both by keyboard: a curve is bent until it is right, a site of the picture is chosen; what was drawn stays."""
    lesson = page("/?lesson=the-residual&step=4")
    entered(lesson, 4)
    assert lesson.get_attribute(".lesson-act .run", "aria-disabled") == "true"
    pad = lesson.locator(".sketch-pad")
    pad.focus()
    for key in ("ArrowRight", "End", "Shift+ArrowDown", *(["ArrowLeft", "Shift+ArrowDown"] * 4)):
        pad.press(key)
    assert "after 50 s: -0.16 cm" in pad.get_attribute("aria-valuetext")
    drawn = lesson.evaluate(f"{APP}.state.lesson.sketch.values")
    assert min(drawn) < -0.15 and drawn[0] == 0
    lesson.evaluate(AXE)
    assert serious(lesson) == []
    pad.press("Enter")
    lesson.wait_for_selector(".feedback.right")
    lesson.reload()
    lesson.wait_for_selector(".feedback.right")
    assert lesson.evaluate(f"{APP}.state.lesson.sketch.values") == drawn
    lesson.goto(lesson.url.split("?")[0] + "?lesson=from-residual-to-name&step=3")
    entered(lesson, 3)
    lesson.locator(".plant .site.asked").nth(1).focus()
    lesson.keyboard.press("Enter")
    eventually(lambda: "You point at: the leak" in lesson.inner_text(".predict"), "the card names the place")
    lesson.keyboard.press("p")  # for a projector
    eventually(lambda: lesson.inner_text(".lesson-bar b") == "From residual to name", "the bar names the lesson")
    lesson.keyboard.press("PageDown")
    lesson.wait_for_selector(".feedback.right")
    assert lesson.watch.errors == []


def test_a_lesson_is_chinese_and_fits_a_phone(page):
    """In Chinese on a phone the card comes first, nothing is wider than the screen, and axe finds nothing serious."""
    lesson = page(f"{LESSON}&step=2", width=390, height=844, theme="dark")
    entered(lesson, 2)
    lesson.evaluate(f"{APP}.act.language('zh')")
    eventually(lambda: "上水位" in lesson.inner_text(".ask"), "the question is Chinese")
    assert lesson.evaluate("document.documentElement.scrollWidth") == 390
    lesson.evaluate(AXE)
    assert serious(lesson) == []


#: Labels of strips and words of pictures that do not fit, and symbols of the card without an explanation.
FLAWS = """[
  ...[...document.querySelectorAll('.strip-label small')].filter(
    (one) => one.scrollHeight > one.clientHeight + 2 || one.scrollWidth > one.clientWidth + 1),
  ...[...document.querySelectorAll('.lesson-picture text')].filter((one) => {
    const [box, room] = [one, one.ownerSVGElement].map((part) => part.getBoundingClientRect());
    return box.left < room.left || box.right > room.right || box.top < room.top - 1;
  }),
  ...document.querySelectorAll('[data-symbol]:not(.explained)'),
].map((one) => one.textContent)"""


def test_every_lesson_fits_a_phone_and_explains_its_symbols(page):
    """At 390 pixels nothing is cut or wider than the screen; a symbol of the card has its sentence on focus."""
    lesson = page(f"{LESSON}&step=1", width=390, height=844)
    for name in library.course():
        lesson.goto(lesson.url.split("?")[0] + f"?lesson={name}&step=1")
        entered(lesson, 1)
        eventually(lambda: lesson.evaluate(FLAWS) == [], f"nothing is cut in {name}: {lesson.evaluate(FLAWS)}")
        assert lesson.evaluate("document.documentElement.scrollWidth") == 390, name
    lesson.goto(lesson.url.split("?")[0] + f"{LESSON[1:]}&step=3")
    entered(lesson, 3)
    lesson.focus(".say [data-symbol=ρ]")
    eventually(lambda: "corrects itself" in lesson.inner_text("#explanation"), "the sentence about the gain is shown")
    assert lesson.watch.errors == []


def test_everything_opens_in_live(page):
    """The session of a step goes on in the live page, with its panels."""
    lesson = page(f"{LESSON}&step=2")
    entered(lesson, 2)
    lesson.get_by_role("button", name="Open everything in Live").click()
    lesson.wait_for_selector("#panel-inject .fault")
    until(lesson, f"{APP}.state.lesson === null && {APP}.state.observers[0]?.label === 'copy'")


def test_an_unknown_lesson_is_reported(page):
    """The live page opens, and the notice says which lessons there are."""
    lesson = page("/?lesson=no-such-lesson")
    until(lesson, "/no-such-lesson/.test(document.querySelector('#notice').innerText)")
    assert len(lesson.watch.errors) == 1  # the answer 404


@pytest.mark.parametrize("at", ["/learn/", f"{LESSON}&step=1"])
def test_nothing_is_cut_at_usual_sizes(page, at: str):
    """At 1280×720 and 1920×1080 no part leaves the window sideways, and the run button is in sight."""
    opened = page(at, width=1280, height=720)
    opened.wait_for_selector(".learn-go, .lesson-act .run")
    for width, height in ((1280, 720), (1920, 1080)):
        opened.set_viewport_size({"width": width, "height": height})
        box = opened.locator(".learn-go, .lesson-act .run").first.bounding_box()
        assert box["y"] + box["height"] <= height
        assert opened.evaluate("document.documentElement.scrollWidth") == width
