"""A fork and its parent: compared in one table, and one click or Back away from each other."""

from tests.browser.live_helpers import APP, ready, reload, send, state, until


def forked(page):
    """Open the default experiment at 30 s, forked at 21 s with another gain and advanced to 29 s; return the parent's
    id."""
    opened = page("/?experiment=zhao-2012&t=30")
    ready(opened)
    parent = state(opened, "session")
    until(opened, "history.state?.session !== undefined")
    opened.evaluate(f"{APP}.act.fork(21)")
    until(opened, f"{APP}.state.session !== {parent!r} && {APP}.ghost?.rows > 2900 && {APP}.state.origin !== null")
    ready(opened)
    send(opened, "{type: 'set-gain', observer: 'adaptive', gain: 'lambda', value: 0.6}")
    send(opened, "{type: 'add-observer', observer: {label: 'kalman', kind: 'adaptive-kalman'}}")
    send(opened, "{type: 'step', rows: 800}")
    until(opened, f"{APP}.samples.now > 28.9")
    return opened, parent


def test_a_fork_is_compared_with_its_parent(page):
    """The table has the parent's observers under its name, with their figures over the same window."""
    opened, _ = forked(page)
    rows = opened.locator("#panel-comparison tbody tr:has(.who)")
    until(opened, "document.querySelectorAll('#panel-comparison .of-origin').length === 2")
    assert [text.split("\n")[0].split("\t")[0].strip() for text in rows.all_inner_texts()] == [
        "adaptive",
        "kalman",
        "adaptive",
    ]
    until(
        opened,
        f"""(() => {{
      const from = Math.max(0, {APP}.state.t - {APP}.state.window), to = {APP}.state.t;
      const of = (samples) => {{
        const a = samples.window('x.x1', from, to).v, b = samples.window('adaptive.x.x1', from, to).v;
        return Math.sqrt(a.reduce((sum, v, k) => sum + (v - b[k]) ** 2, 0) / a.length);
      }};
      const shown = (row) => Number(document.querySelector(`#panel-comparison ${{row}} td`).textContent);
      return Math.abs(shown('tbody tr') / of({APP}.samples) - 1) < 0.1
        && Math.abs(shown('.of-origin') / of({APP}.ghost) - 1) < 0.1;
    }})()""",
    )
    noise = [
        float(opened.locator(f"#panel-comparison {row} td").nth(2).inner_text())
        for row in ("tbody tr:not(.of-origin)", ".of-origin")
    ]
    assert noise[0] < noise[1]  # what the lower λ is for


def test_back_and_the_legend_lead_to_the_first_session_and_to_the_fork(page):
    """Back, legend and table lead to the first session with control; its legend leads to the fork; reloading keeps
    both."""
    opened, parent = forked(page)
    fork = state(opened, "session")
    opened.evaluate("history.back()")
    until(opened, f"{APP}.state.session === {parent!r} && {APP}.state.connection === 'live'")
    ready(opened)
    assert state(opened, "role") == "control" and abs(state(opened, "t") - 30) < 0.02
    opened.click(".legend .link")
    until(opened, f"{APP}.state.session === {fork!r} && {APP}.state.origin !== null")
    assert state(opened, "parent")["id"] == parent and state(opened, "role") == "control"
    until(opened, f"history.state?.session === {fork!r}")
    reload(opened)
    ready(opened)
    known = opened.evaluate("({entry: history.state, address: location.href, kept: {...sessionStorage}})")
    assert (state(opened, "session"), state(opened, "role")) == (fork, "control"), (parent, known)
    until(opened, f"{APP}.state.origin !== null && document.querySelector('#panel-comparison .origin .link') !== null")
    opened.click("#panel-comparison .origin .link")
    until(opened, f"{APP}.state.session === {parent!r}")
    assert opened.watch.errors == []


def test_the_session_that_is_left_does_not_write_the_address_of_the_next(page):
    """While the page waits for the session that it moves to, the history entry keeps that session."""
    opened, parent = forked(page)
    fork = state(opened, "session")
    held = []
    opened.route(f"**/api/sessions/{parent}", lambda route: held.append(route))
    opened.click("#panel-comparison .origin .link")
    until(opened, f"history.state?.session === {parent!r}")
    send(opened, "{type: 'step', rows: 3}")  # the fork, still shown, writes its address a moment after this
    opened.wait_for_timeout(1000)
    assert state(opened, "session") == fork and opened.evaluate("history.state.session") == parent
    held[0].continue_()
    until(opened, f"{APP}.state.session === {parent!r} && {APP}.state.connection === 'live'")
    assert opened.evaluate("history.state.session") == parent and opened.watch.errors == []
