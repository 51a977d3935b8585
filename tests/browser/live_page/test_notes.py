"""Notes and bookmarks on the timeline of the live page."""

from tests.browser.live_helpers import APP, ready, reload, rested, send, state, until

NOTES = f"{APP}.state.spec.notes"
FLAGS = "[...document.querySelectorAll('.flag')].map((one) => one.getAttribute('aria-label'))"
HOSTILE = "<img src=x onerror=alert(1)> look here"


FIELD = "document.activeElement.matches('.note-card input')"
CLOSED = "document.querySelector('.note-card').hidden"


def written(opened, key: str, text: str) -> None:
    """Press a key, and write a note in the field that it opens."""
    opened.keyboard.press(key)
    until(opened, FIELD)
    opened.keyboard.type(text)
    opened.keyboard.press("Enter")


def watched(page, opened):
    """Return the page of a viewer: it has the notes of the session, and no way to change them."""
    link = opened.evaluate(f"{APP}.act.link({{view: true}})")
    guest = page(link[link.index("/?") :])
    until(guest, f"{FLAGS}.length === 2 && document.querySelectorAll('.log .note').length === 2")
    guest.keyboard.press("n")
    until(guest, f"{APP}.state.notice?.message.code === 'page.notice.view-only'")
    assert guest.evaluate("document.querySelector('#transport [data-act=note]').disabled")
    assert not guest.locator(".log .note .control-only").first.is_visible()
    return guest


def test_a_note_is_set_read_changed_removed_and_brought_back_by_keyboard(page):
    """N, a text and Enter set a flag; Enter on a flag changes it, Delete removes it, with Undo.

    They survive a reload; who only watches sees them, and has no way to change them.
    """
    opened = page("/?experiment=zhao-2012&t=12")
    ready(opened)
    written(opened, "n", HOSTILE)
    until(opened, f"{NOTES}.length === 1 && {CLOSED} && {FLAGS}.join() === 'Note at 12.0 s: {HOSTILE}'")
    assert opened.evaluate("document.querySelectorAll('.bar img, #panel-log img').length") == 0

    opened.evaluate(f"{APP}.act.look(5)")
    opened.locator("#transport [data-act=note]").click()
    until(opened, FIELD)
    opened.locator("#panel-diagnosis h2").click()  # leaving the field keeps the note: a bookmark, without a text
    until(opened, f"{NOTES}.length === 2 && {CLOSED} && {FLAGS}[0] === 'Bookmark at 5.0 s'")
    opened.keyboard.press("n")
    until(opened, FIELD)
    opened.keyboard.press("Escape")  # gives the new one up
    until(opened, f"{CLOSED} && {FLAGS}.length === 2")
    opened.evaluate(f"{APP}.act.look(null)")

    opened.locator(".flag >> nth=1").focus()
    until(opened, "document.querySelector('.note-card p')?.textContent.endsWith('look here')")
    opened.keyboard.press("ArrowLeft")
    until(opened, "document.activeElement.ariaLabel === 'Bookmark at 5.0 s'")
    written(opened, "Enter", "the estimate has settled")
    until(opened, "document.activeElement.ariaLabel === 'Note at 5.0 s: the estimate has settled'")
    opened.keyboard.press(" ")
    until(opened, f"{APP}.state.looking === 5")
    opened.keyboard.press("Delete")
    until(opened, f"{NOTES}.length === 1 && document.activeElement.matches('.flag')")
    until(opened, "document.querySelector('#notice')?.textContent.includes('5.0 s')")
    opened.locator("#notice button").click()
    until(opened, f"{NOTES}.length === 2 && {NOTES}[0].text === 'the estimate has settled'")

    guest = watched(page, opened)
    until(opened, f"location.href === await {APP}.act.link()")
    reload(opened)
    ready(opened)
    until(opened, f"{FLAGS}.length === 2 && document.querySelectorAll('.log .note').length === 2")
    opened.set_viewport_size({"width": 390, "height": 844})
    rested(opened)
    opened.locator(".flag >> nth=0").click()
    until(opened, f"{APP}.state.looking === 5 && document.querySelector('.note-card').checkVisibility()")
    opened.locator(".note-acts button >> nth=1").click()
    until(opened, f"{NOTES}.length === 1")
    run = opened.evaluate(f"(async () => (await {APP}.act.save()).id)()")
    send(opened, "{type: 'seek', t: 6}")  # what comes after it is discarded, with its notes
    until(opened, f"{FLAGS}.length === 0")
    assert state(opened, "role") == "control"
    saved = page(f"/runs/?run={run}")
    until(saved, "document.querySelector('.own-notes')?.textContent.endsWith('look here')")
    saved.get_by_role("button", name="Open in Live").click()
    ready(saved)
    until(saved, f"{FLAGS}.length === 1")
    assert opened.watch.errors == guest.watch.errors == saved.watch.errors == []
