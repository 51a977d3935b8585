"""A class in the browser: a teacher and two students, from the opening of the room to the reveal."""

from collections.abc import Callable, Iterator

import pytest

from tests.browser.conftest import visit
from tests.browser.live_helpers import until
from tests.browser.test_accessibility import AXE, serious


@pytest.fixture
def device(browser, server) -> Iterator[Callable]:
    """Yield a function that opens a page on a device of its own."""
    contexts = []

    def opened(path: str, width: int = 390, height: int = 844):
        contexts.append(browser.new_context())
        return visit(contexts[-1], server, path, width, height, "light")

    yield opened
    for context in contexts:
        context.close()


def accessible(page) -> None:
    page.evaluate(AXE)
    assert serious(page) == []


def fits(page) -> bool:
    return page.evaluate("document.querySelector('#main').scrollHeight <= document.querySelector('#main').clientHeight")


def choose(page, words: str) -> None:
    """Choose an answer by its words; its input lies under them."""
    page.locator(".seat-option", has_text=words).first.click()


def voted(wall, ada, bob) -> None:
    """Let the class vote on a step of a lesson, and run it; a reload keeps a choice that is not sent yet."""
    wall.click("[data-keep=follow]")
    wall.wait_for_selector(".lesson-links")
    with wall.context.expect_page() as opening:
        wall.click("[data-keep=lesson-what-you-cannot-see]")
    lesson = opening.value
    lesson.set_default_timeout(180_000)
    for phone in (ada, bob):
        phone.wait_for_selector(".seat-option")
    assert fits(ada)
    accessible(ada)
    choose(ada, "Closer")
    ada.reload()  # the choice that is not sent yet is kept
    ada.wait_for_selector(".seat-option input:checked")
    ada.click("[data-keep=act]")
    choose(bob, "Right: the pump")
    bob.click("[data-keep=act]")
    until(lesson, "document.querySelector('.votes-line')?.textContent.startsWith('2 of 2')")
    lesson.keyboard.press("v")
    until(lesson, "document.querySelectorAll('.vote').length === 3")
    until(lesson, "document.querySelector('.lesson-card[data-phase=before]')")  # its session is there
    lesson.keyboard.press("Enter")
    ada.wait_for_selector(".seat-result.right")
    bob.wait_for_selector(".seat-result:not(.right)")
    until(wall, "document.querySelectorAll('.tile .answer-mark.right').length === 1")
    accessible(wall)
    lesson.close()


def found(wall, ada, bob) -> None:
    """Let the class look for hidden faults, up to the reveal and a replay."""
    wall.bring_to_front()
    wall.click("[data-keep=next]")
    wall.select_option("#setup", "motor")
    wall.select_option("#minutes", "600")
    wall.click("[data-keep=own]")
    for phone in (ada, bob):
        phone.wait_for_selector(".records canvas")
    choose(ada, "actuator gain loss")
    ada.wait_for_selector("#since")
    assert fits(ada)
    accessible(ada)
    ada.click("[data-keep=act]")
    choose(bob, "It cannot be told yet")
    choose(bob, "actuator gain loss")
    choose(bob, "friction increase")
    bob.click("[data-keep=act]")
    until(wall, "document.querySelector('.big-count')?.textContent.startsWith('2 of 2')")
    assert wall.query_selector(".tile .answer-mark") is None
    bob.reload()
    until(bob, "document.querySelectorAll('.seat-option input:checked').length === 2")
    wall.click("[data-keep=next]")
    for phone in (ada, bob):
        phone.wait_for_selector(".seat-table")
        assert fits(phone)
    until(wall, "document.querySelectorAll('.tile .answer-mark').length === 2")
    wall.focus(".tile-open")
    wall.keyboard.press("Enter")
    wall.wait_for_selector(".replay canvas")
    accessible(wall)
    accessible(ada)


def test_a_class_from_the_opening_of_the_room_to_the_reveal(device):
    """Two students join, vote on a step of the teacher's lesson, then find hidden faults; a reload keeps the place."""
    wall = device("/classroom/", 1440, 900)
    wall.wait_for_selector(".opening")
    accessible(wall)
    wall.click("[data-keep=open]")
    code = wall.inner_text(".room-code")
    ada, bob = device(f"/join/{code}"), device("/join")
    bob.fill("#code", code.lower())
    bob.click("[data-keep=act]")
    for phone in (ada, bob):
        phone.wait_for_selector(".seat-big")
    accessible(ada)
    ada.fill("#name", "<b>Ada</b>")
    ada.click(".seat-name button")
    until(wall, "[...document.querySelectorAll('.tile b')].some((one) => one.textContent === '<b>Ada</b>')")
    voted(wall, ada, bob)
    found(wall, ada, bob)
    wall.once("dialog", lambda dialog: dialog.accept())
    wall.click("[data-keep=close]")
    ada.wait_for_selector("#code")
    for page in (wall, ada, bob):
        assert page.watch.errors == [] and page.watch.foreign == []
