"""The live page and its session: links, going back, forks, lost connections, read-only viewers, and its end."""

import base64
import zlib

import pytest

from tests.browser.live_helpers import APP, last_row, ready, reload, send, state, until

PAUSED = "/?experiment=zhao-2012&t=12"


def changed(opened) -> None:
    """Return a paused session to which commands were given."""
    send(opened, "{type: 'inject', fault: {channel: 'theta1', shape: 'step', onset: 0, size: 0.012}}")
    send(opened, "{type: 'step', rows: 150}")
    send(opened, "{type: 'set-gain', observer: 'adaptive', gain: 'rho', value: 6}")
    send(opened, "{type: 'add-observer', observer: {label: 'ekf', kind: 'joint-ekf'}}")
    send(opened, "{type: 'step', rows: 200}")
    until(opened, f"{APP}.samples.now > 15.495 && {APP}.samples.has('ekf.x.x1')")


def test_the_address_is_short_while_nothing_was_changed(page):
    """Playing and pausing keep ?experiment and the time in the address, which reopens the session there, paused."""
    opened = page(PAUSED)
    ready(opened)
    until(opened, "/^\\?experiment=zhao-2012&t=\\d+/.test(location.search) && location.hash === ''")
    assert not state(opened, "playing")
    assert abs(last_row(opened)["now"] - 12) < 0.02


def test_a_link_gives_the_same_numbers_in_another_browser(tab, page, server):
    """With a fault, a gain and a new observer the link opens at the same time with all values equal."""
    opened = tab(PAUSED)
    ready(opened)
    changed(opened)
    link = opened.evaluate(f"{APP}.act.link()")
    assert "#s=" in link and len(link) < 2000
    until(opened, f"location.href === {link!r}")
    other = page(link.removeprefix(server))
    ready(other, rows=1500)
    assert last_row(other) == last_row(opened)
    assert [one["label"] for one in state(other, "observers")] == ["adaptive", "ekf"]


def test_loading_the_page_again_keeps_the_session_and_its_control(page):
    """A reload joins the same session, with control; its phase planes and the full comparison are open again."""
    opened = page(PAUSED)
    ready(opened)
    changed(opened)
    opened.evaluate(f"{APP}.act.plane(0, {{x: 'input.u', y: 'theta.theta1'}}); {APP}.act.table(true)")
    session = state(opened, "session")
    until(opened, f"location.hash.startsWith('#s=') && location.href === await {APP}.act.link()")
    reload(opened)
    ready(opened)
    assert state(opened, "session") == session and state(opened, "role") == "control"
    until(
        opened,
        "document.querySelectorAll('#planes canvas').length === 1 && !document.querySelector('#panel-table').hidden",
    )
    assert state(opened, "planes") == [{"x": "input.u", "y": "theta.theta1"}]
    send(opened, "{type: 'clear'}")


def test_an_address_that_changes_while_the_page_is_loaded_again_does_not_lose_the_session(page):
    """The old page still runs while the new one is fetched; the same session is joined all the same."""
    opened = page(PAUSED)
    ready(opened)
    session = state(opened, "session")
    until(opened, "history.state?.session !== undefined")
    held = []
    opened.route("**/?experiment=zhao-2012**", lambda route: held.append(route))
    opened.evaluate(f"""() => {{
      setTimeout(() => location.reload());
      setTimeout(() => {APP}.send({{type: 'step', rows: 200}}), 300);
    }}""")  # as nothing can be asked of a page that is being left
    opened.wait_for_timeout(2000)
    with opened.expect_navigation():
        held[0].continue_()
    ready(opened)
    assert (state(opened, "session"), state(opened, "role")) == (session, "control")


def packed(text: str) -> str:
    """Return data packed as the fragment of an address."""
    made = zlib.compressobj(wbits=-15)
    return base64.urlsafe_b64encode(made.compress(text.encode()) + made.flush()).decode().rstrip("=")


@pytest.mark.parametrize(
    "fragment", ["nZDBcoMw", packed("null"), packed("[]"), packed('{"spec": 3}'), packed('{"changed": {}}')]
)
def test_a_damaged_link_is_answered_with_a_notice(tab, fragment):
    """A truncated link, or one with other content, leads to a notice with a remedy."""
    opened = tab(f"/#s={fragment}")
    opened.wait_for_selector("#notice button")
    assert "damaged" in opened.inner_text("#notice")
    opened.click("#notice button")
    ready(opened)


def test_a_read_only_viewer_sees_everything_and_changes_nothing(tab, page):
    """The link shows the same samples; its buttons are disabled, and the server refuses its commands."""
    opened = tab(PAUSED)
    ready(opened)
    watcher = page(f"/?session={state(opened, 'session')}")
    ready(watcher)
    assert state(watcher, "role") == "view" and last_row(watcher) == last_row(opened)
    assert watcher.is_disabled(".play") and watcher.is_disabled("[data-act=start]")
    refused = watcher.evaluate(
        """async () => {
      const {connect} = await import(moduleAt('net/socket.js'));
      let hello;
      const greeted = new Promise((done) => { hello = done; });
      const socket = connect({session: thetascope.state.session, token: null, onMessage: (message) =>
        message.type === 'hello' && hello(), onFrame() {}, onConnection() {}});
      await greeted;
      return socket.send({type: 'play'}).then(() => 'done', (error) => error.name);
    }"""
    )
    assert refused == "Refused" and not state(opened, "playing")


def test_looking_back_discards_nothing(tab):
    """A click on the timeline shows the past; Continue from here goes back; Undo restores the discarded part."""
    opened = tab("/?experiment=zhao-2012&t=30")
    ready(opened)
    before = last_row(opened)
    rail = opened.locator(".rail").bounding_box()
    opened.mouse.click(rail["x"] + rail["width"] * 0.1, rail["y"] + 12)
    opened.wait_for_selector(".choice .run")
    assert abs(state(opened, "looking") - 10) < 0.5 and last_row(opened) == before
    opened.click(".choice .run")
    until(opened, f"{APP}.samples.now < 11 && {APP}.state.epoch > 0")
    until(opened, f"{APP}.state.alarms.length === 0")
    opened.click("#notice button")
    until(opened, f"{APP}.samples.now > 29")
    ready(opened)
    assert last_row(opened) == before
    assert opened.locator("#notice button").count() == 0  # what was taken is not offered again


def test_undo_is_not_offered_with_other_viewers(tab, page):
    """Undo starts another session, so with a second viewer the page only states the time."""
    opened = tab("/?experiment=zhao-2012&t=30")
    ready(opened)
    watcher = page(f"/?session={state(opened, 'session')}")
    ready(watcher)
    until(opened, f"{APP}.state.viewers === 2")
    opened.evaluate(f"{APP}.act.seek(10)")
    opened.wait_for_selector("#notice:has-text('Back at 10')")
    assert opened.locator("#notice button").count() == 0


def test_a_fork_is_a_second_session_with_its_parents_curves(tab, page):
    """It starts at that time; the first session stays, and its curves are shown for comparison."""
    opened = tab("/?experiment=zhao-2012&t=30")
    ready(opened)
    parent, before = state(opened, "session"), last_row(opened)
    opened.evaluate(f"{APP}.act.look(10)")
    opened.click(".choice .quiet")
    until(opened, f"{APP}.state.session !== {parent!r} && {APP}.ghost?.rows > 2900")
    ready(opened)
    assert abs(last_row(opened)["now"] - 10) < 0.02 and state(opened, "parent")["id"] == parent
    send(opened, "{type: 'inject', fault: {channel: 'theta2', shape: 'step', onset: 0, size: 0.02}}")
    send(opened, "{type: 'step', rows: 500}")
    until(opened, f"{APP}.samples.now > 14.9")
    own, ghost = opened.evaluate(f"[{APP}.at('theta.theta2', 14), {APP}.ghost.at('theta.theta2', 14)]")
    assert own == pytest.approx(0.02) and ghost == 0
    watcher = page(f"/?session={parent}")
    ready(watcher)
    assert last_row(watcher) == before


def test_a_lost_connection_is_survived_without_a_gap(tab):
    """The connection is lost while time runs; it is restored, and no row is missing or different."""
    opened = tab(PAUSED)
    ready(opened)
    opened.evaluate(f"{APP}.act.play()")
    until(opened, f"{APP}.samples.now > 13")
    opened.evaluate(
        f"void {APP}.subscribe((state) => state.connection, (now) => {{ window.lost ||= now === 'reconnecting'; }})"
    )
    opened.evaluate(f"{APP}.drop()")
    until(opened, f"window.lost && {APP}.state.connection === 'live' && {APP}.samples.now > 15")
    opened.evaluate(f"{APP}.act.pause()")
    until(opened, f"!{APP}.state.playing && {APP}.samples.rows === {APP}.state.row")
    different = opened.evaluate(f"""fetch(`/api/sessions/${{{APP}.state.session}}/data`)
      .then((answer) => answer.json()).then(({{columns}}) => {{
      const own = {APP}.window('adaptive.x.x1', 0, 1e9).v;
      return [own.length, own.filter((value, i) => value !== Math.fround(columns['adaptive.x.x1'][i])).length,
        columns.t.length];
    }})""")
    assert different[1] == 0 and different[0] == different[2] > 1500


def test_a_viewer_of_a_long_session_sees_all_of_it(tab, page):
    """Rows that the server does not send to a late viewer are fetched with fewer points: the curves have no hole."""
    opened = tab("/?experiment=zhao-2012&t=400")
    until(opened, f"{APP}?.samples.rows >= 40_000")
    watcher = page(f"/?session={state(opened, 'session')}")
    until(watcher, f"{APP}?.samples.rows >= 40_000 && !{APP}.samples.held")
    assert watcher.evaluate("performance.getEntriesByType('resource').some(({name}) => name.includes('/data?'))")
    holes = watcher.evaluate(f"{APP}.window('x.x1', 0, 1e9).v.filter((value) => value !== value).length")
    assert holes == 0


def test_an_ended_session_can_be_continued(tab):
    """The page reports the end and starts another session at the same time."""
    opened = tab(PAUSED)
    ready(opened)
    changed(opened)
    before = last_row(opened)
    until(opened, f"JSON.parse(sessionStorage['thetascope.sessions'] ?? '[]').at(-1)?.id === {APP}.state.session")
    opened.evaluate("""(() => {
      const {id, token} = JSON.parse(sessionStorage['thetascope.sessions']).at(-1);
      return fetch(`/api/sessions/${id}`, {method: 'DELETE', headers: {'X-Control-Token': token}});
    })()""")
    until(opened, f"{APP}.state.connection === 'ended'")
    opened.click("#notice button >> nth=0")
    until(opened, f"{APP}.state.connection === 'live'")
    ready(opened, rows=1500)
    assert last_row(opened) == before


def test_an_unknown_experiment_is_answered_with_a_notice(tab):
    """The notice names the nearest experiment and offers a new session."""
    opened = tab("/?experiment=zhao-2021")
    opened.wait_for_selector("#notice button")
    assert "zhao-2012" in opened.inner_text("#notice")


def test_an_observer_keeps_its_colour(tab):
    """Colours are assigned in order, kept when other observers are removed, and assigned again."""
    opened = tab(PAUSED)
    ready(opened)
    for label in ("one", "two"):
        send(opened, f"{{type: 'add-observer', observer: {{label: {label!r}, kind: 'zhao-adaptive'}}}}")
    until(opened, f"{APP}.state.observers.length === 3")
    send(opened, "{type: 'remove-observer', label: 'one'}")
    until(opened, f"{APP}.state.observers.length === 2")
    send(opened, "{type: 'add-observer', observer: {label: 'three', kind: 'zhao-adaptive'}}")
    until(opened, f"{APP}.state.observers.length === 3")
    assert {one["label"]: one["colour"] for one in state(opened, "observers")} == {
        "adaptive": "var(--o0)",
        "two": "var(--o2)",
        "three": "var(--o1)",
    }


def test_rows_that_were_not_sent_are_fetched_in_order(tab):
    """With two gaps, a refused request and new frames in between, every row is present and correct afterwards."""
    opened = tab("/?experiment=zhao-2012&t=30")
    ready(opened, rows=3000)
    wrong, tries = opened.evaluate(
        """async () => {
      const {Arrivals} = await import(moduleAt('net/missed-rows.js'));
      const {Samples} = await import(moduleAt('state/samples.js'));
      const {state, samples: whole} = thetascope;
      const samples = new Samples(state.record);
      samples.setColumns(whole.sent);
      samples.epoch = 7;
      const arrivals = new Arrivals(samples, state.session, () => {});
      const frame = (first, count) => ({epoch: 7, first, count, columns: whole.sent.length,
        data: Float32Array.from(whole.sent.flatMap((name) => Array.from({length: count}, (_, i) => whole.value(name,
          first + i))))});
      const asked = window.fetch;
      let tries = 0;
      window.fetch = (address, ...more) => (String(address).includes('/data?') && (tries += 1) === 1
        ? Promise.resolve(new Response('{}', {status: 503,
          headers: {'content-type': 'application/json'}})) : asked(address, ...more));
      arrivals.frame(frame(0, 100));
      const first = arrivals.jump({first: 100, row: 900});
      arrivals.frame(frame(900, 100));
      arrivals.jump({first: 1000, row: 2500});
      arrivals.frame(frame(2500, 100));
      await first;
      window.fetch = asked;
      let wrong = 0;
      for (const name of whole.sent) for (let row = 0; row < 2600; row += 1) if (!Object.is(samples.value(name, row),
        whole.value(name, row))) wrong += 1;
      return [wrong, tries];
    }"""
    )
    assert wrong == 0 and tries == 3


def test_the_newest_choice_of_a_session_wins(tab):
    """A session that was asked for earlier and is answered later is ended, and never replaces the newer one."""
    opened = tab(PAUSED)
    ready(opened)
    ends = opened.evaluate("""async () => {
      const {fetch: ask} = window;
      const posts = [], deleted = [];
      let answer;
      const held = new Promise((done) => { answer = done; });
      window.fetch = async (address, options) => {
        if (options?.method === 'DELETE') deleted.push(String(address));
        if (options?.method !== 'POST' || !String(address).endsWith('/api/sessions')) return ask(address, options);
        posts.push(ask(address, options));
        if (posts.length === 1) await held;
        return posts.at(posts.length === 1 ? 0 : -1);
      };
      const spec = thetascope.state.spec;
      const first = thetascope.act.openSpec(spec, {t: 3});
      await thetascope.act.openSpec(spec, {t: 5});
      const second = thetascope.state.session;
      answer();
      await first;
      window.fetch = ask;
      return [thetascope.state.session === second, deleted.length];
    }""")
    assert ends == [True, 1]
    ready(opened)
    assert abs(state(opened, "t") - 5) < 0.02
