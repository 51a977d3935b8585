"""A teacher makes a lesson without code: from what was done in a live session to playing it, and on paper."""

import json
import urllib.request

from tests.browser.live_helpers import APP, eventually, until
from tests.browser.test_accessibility import AXE, serious


def recorded(server: str) -> str:
    """Return a session in which the lower tank has leaked since 20 s."""
    with urllib.request.urlopen(f"{server}/api/course/the-residual") as answer:
        spec = json.load(answer)["experiments"]["healthy"]
    spec["faults"] = [{"channel": "leak", "shape": "step", "onset": 20, "size": 0.02}]
    body = json.dumps({"spec": spec, "play": False, "t": 50}).encode()
    request = urllib.request.Request(f"{server}/api/sessions", body, {"Content-Type": "application/json"})
    with urllib.request.urlopen(request) as answer:
        return json.load(answer)["id"]


def test_a_recording_becomes_a_lesson_that_is_played_and_printed(page, server):
    """Words, two answers and what decides are filled in; it is played, saved, played by a student, and on paper."""
    editor = page(f"/lesson-editor/?session={recorded(server)}")
    editor.wait_for_selector(".happenings .within")
    assert "injected leak" in editor.inner_text(".happenings")
    editor.get_by_label("Lesson", exact=True).fill("Where does the level go?")
    editor.get_by_label("Title", exact=True).fill("A leak")
    editor.get_by_label("Say", exact=True).fill("Something happens at **20 s**.")
    editor.get_by_label("Ask", exact=True).fill("What will the lower level do?")
    eventually(lambda: "A leak" in editor.inner_text(".editor-preview"), "the card shows the title")
    editor.get_by_role("button", name="+ a number that is measured").click()
    editor.get_by_label("Of what").select_option("x.h2")
    for answer, how, limit in (("It falls", "at_most", "9.5"), ("It stays", "at_least", "9.5")):
        editor.get_by_role("button", name="+ answer").click()
        box = editor.locator(".editor-answer").last
        box.locator("input[type=text]").fill(answer)
        box.get_by_label("How it is compared").select_option(how)
        editor.locator(".editor-answer").last.get_by_label("Limit").fill(limit)
    editor.wait_for_selector(".verdict-line.ok")
    assert "each of the 2 answers" in editor.inner_text(".verdict-line")
    eventually(lambda: "this is true from" in editor.inner_text("[data-truth='0']"), "it says since when")
    editor.evaluate(AXE)
    assert serious(editor) == []
    editor.get_by_role("button", name="Right", exact=True).click()
    editor.wait_for_selector(".editor-preview .feedback.right")
    editor.get_by_role("button", name="Save").click()
    editor.get_by_role("link", name="Play").click()
    until(editor, f"{APP}?.state.connection === 'live' && document.querySelector('.lesson-card[data-phase=before]')")
    editor.keyboard.press("1")
    editor.keyboard.press("Enter")
    editor.wait_for_selector(".feedback.right")
    editor.goto(f"{server}/learn/")
    editor.locator(".teach-list li").filter(has_text="Where does the level go?").get_by_text("Worksheet").click()
    until(editor, "document.documentElement.dataset.ready === 'true'")
    editor.get_by_role("button", name="With the answers").click()
    eventually(lambda: "It falls" in editor.inner_text(".boxes .right"), "the right answer is marked")
    editor.evaluate(AXE)
    assert serious(editor) == []
    assert editor.watch.errors == [] and editor.watch.foreign == []
