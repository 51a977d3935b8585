"""The page /runs/: choose an experiment, run it, see its figures; any screen, keyboard, and errors."""

import json
import re

import pytest

from tests.browser.live_helpers import until

DRAWN = "figure[data-drawn] .plot .scatterlayer path.js-line"


#: Only the figures near the window are drawn, and each takes the browser a third of a second.
SMALL = {"width": 1440, "height": 800}


def run(page) -> None:
    page.click("button.run")
    page.wait_for_selector(DRAWN, state="attached")


def drawn(kept_page, experiment: str = "shen-hu-2015", **more):
    """Return the page of an experiment that was run, at a size: the run and its figures are made once."""
    shown = kept_page(f"/runs/?experiment={experiment}", **more)
    shown.wait_for_selector("h1")
    if not shown.locator(DRAWN).count():
        run(shown)
    return shown


def chosen(kept_page):
    """Return the page of an experiment that was not run."""
    shown = kept_page("/runs/?experiment=zhao-2012-variance-as-printed")
    shown.wait_for_selector("h1")
    return shown


def test_zhao_2012_runs_and_shows_its_figures(kept_page):
    """Figures with curves, comparison and assumptions appear, without errors or requests to another host."""
    opened = drawn(kept_page, "zhao-2012")
    opened.wait_for_selector(".side .checks")
    assert opened.locator("figure").count() >= 5
    assert opened.locator(".side table tbody tr").count() >= 2
    assert "errata" in opened.inner_text(".side").lower()
    assert opened.watch.errors == [] and opened.watch.foreign == []


def test_a_run_shows_its_diagnosis(kept_page):
    """The page of runs has the summary, a line per finding, the detector first, and its numbers."""
    run = drawn(kept_page, "zhao-2012")
    assert "3 faults, all identified" in run.locator(".verdicts .verdict").inner_text()
    assert run.locator(".verdicts .finding.found").count() == 3
    first = run.locator(".measures tbody tr").first.inner_text().split()
    assert first[:5] == ["detector", "3", "0", "0", "0"]
    summary = run.evaluate(
        "fetch('/api/runs/' + new URLSearchParams(location.search).get('run')).then((a) => a.json()).then((a) => "
        "a.summary)"
    )
    adaptive = next(one for one in summary["comparison"]["observers"] if one["label"] == "adaptive")
    row = run.locator(".measures tbody tr", has_text="adaptive").first.inner_text().split()
    assert [int(n) for n in row[1:5]] == [
        adaptive[name] for name in ("found", "missed", "false_alarms", "isolation_errors")
    ]
    run.evaluate("document.querySelectorAll('.verdicts details').forEach((one) => { one.open = true; })")
    text = run.locator(".verdicts").inner_text()
    assert (
        "one false alarm in 100 h" in text
        and f"{summary['diagnosis']['detector']['calibration']['thresholds']['glr']:.3g}" in text
    )
    assert run.locator(".verdicts .group").count() == len(adaptive["rmse"]) and "distinguishable" in text
    for width in (1180, 1440):  # three columns leave the findings little room: no digit may be cut off
        run.set_viewport_size({"width": width, "height": 900})
        widths = run.locator(".finding .amount").evaluate_all(
            "(all) => all.map((one) => [one.clientWidth, one.firstChild.getBoundingClientRect().width])"
        )
        assert all(room >= needed - 1 for room, needed in widths)
    assert run.watch.errors == [] and run.watch.foreign == []


def test_the_library_is_listed_and_a_choice_opens(page):
    """Every experiment is a link that sets the address; Back leads to the previous one."""
    opened = page("/runs/?new")
    links = opened.locator(".chooser li a:not([href^='/workshop/'])")  # plants of other tests are listed, too
    links.first.wait_for()
    listed = opened.evaluate(
        "fetch('/api/experiments').then((answer) => answer.json()).then((all) => all.experiments.length)"
    )
    assert links.count() == listed > 0
    opened.click(".chooser li a[href*='shen-hu-2015-noise-free']")
    opened.wait_for_url("**/runs/?experiment=shen-hu-2015-noise-free")
    assert opened.locator(".chooser a[aria-current]").count() == 1
    opened.evaluate("history.back()")
    opened.wait_for_selector(".chooser li:first-child a[aria-current]")
    assert "noise-free" not in opened.url


def test_a_link_reopens_choice_changes_and_result(page, server):
    """The address contains seed, noise and run; a new page shows the same without running."""
    opened = page("/runs/?experiment=zhao-2012&set=horizon%3D10", **SMALL)
    opened.fill("#field-seed", "5")
    opened.fill("#field-noise-y-std", "0.002")
    run(opened)
    opened.wait_for_url("**run=*")
    address = opened.url.removeprefix(server)
    assert "set=seed%3D5" in address and "set=noise.y.std%3D0.002" in address
    posts = []
    again = page("/runs/", **SMALL)
    again.on("request", lambda request: posts.append(request.url) if request.method == "POST" else None)
    again.goto(server + address)
    again.wait_for_selector(DRAWN, state="attached")
    assert again.input_value("#field-seed") == "5" and posts == []
    spec = again.evaluate(f"fetch('/api/runs/{address.split('run=')[1]}').then((answer) => answer.json())")["spec"]
    assert spec["seed"] == 5 and spec["noise"]["y"]["std"] == 0.002


def test_a_refused_value_is_explained_at_its_field(kept_page):
    """Problem and remedy are below the field, which is marked and focused; a correction clears them."""
    opened = chosen(kept_page)
    opened.fill("#field-noise-y-std", "-1")
    opened.click("button.run")
    opened.wait_for_selector("#field-noise-y-std[aria-invalid=true]")
    assert "Remedy" in opened.inner_text("#field-noise-y-std-error")
    assert opened.evaluate("document.activeElement.id") == "field-noise-y-std"
    opened.fill("#field-noise-y-std", "0.001")
    opened.wait_for_selector("#field-noise-y-std:not([aria-invalid])")
    assert opened.inner_text("#field-noise-y-std-error") == ""


def test_a_value_that_has_no_field_is_refused_above_the_button(page):
    """A wrong path is named together with the nearest correct one."""
    opened = page("/runs/?experiment=zhao-2012&set=noize.y.std%3D0")
    opened.wait_for_selector("h1")
    opened.click("button.run")
    trouble = opened.wait_for_selector(".head .problem")
    assert "noize" in trouble.inner_text() and "noise" in trouble.inner_text()


def test_an_unknown_experiment_is_answered_with_a_notice(page):
    """The page says that the experiment does not exist, and lists the library."""
    opened = page("/runs/?experiment=zhao-2021")
    assert "zhao-2012" in opened.wait_for_selector(".head .problem").inner_text()
    assert opened.locator(".chooser li a").count() > 0


def test_a_long_run_shows_progress_and_can_be_cancelled(page):
    """A run of minutes shows its progress; Cancel ends it, and the page reports it."""
    opened = page("/runs/?experiment=zhao-2012-observers&set=horizon%3D15000&set=evaluate%3D1.5&set=record%3D1.5")
    opened.wait_for_selector("h1")
    opened.click("button.run")
    until(opened, "/^[1-9]\\d* %$/.test(document.querySelector('.status').textContent)")
    opened.click("button:text-is('Cancel')")
    until(opened, "document.querySelector('.status').textContent.includes('cancelled')")
    assert opened.is_enabled("button.run")


def test_a_lost_connection_is_reported_and_survived(page):
    """While the server does not respond the page says so and waits; then the run appears."""
    opened = page("/runs/?experiment=shen-hu-2015", **SMALL)
    opened.wait_for_selector("h1")
    opened.route("**/api/**", lambda route: route.abort("connectionrefused"))
    opened.click("button.run")
    opened.wait_for_selector(".connection.lost")
    opened.unroute("**/api/**")
    opened.wait_for_selector(DRAWN, state="attached")
    assert opened.locator(".connection.lost").count() == 0


def test_everything_is_reached_by_keyboard(page):
    """Tab and Enter alone reach the button and start the run."""
    opened = page("/runs/?experiment=shen-hu-2015")
    opened.wait_for_selector("h1")
    for _ in range(80):
        opened.keyboard.press("Tab")
        if opened.evaluate("document.activeElement.id") == "field-seed":
            break
    assert opened.evaluate("document.activeElement.id") == "field-seed"
    opened.keyboard.press("Control+A")
    opened.keyboard.type("3")
    opened.keyboard.press("Enter")
    opened.wait_for_url(re.compile(r"seed%3D3.*run="))


@pytest.mark.parametrize("width", [390, 820, 1180, 1920])
def test_nothing_is_wider_than_the_screen(kept_page, width):
    """At every width the page scrolls vertically only, and the run button is visible."""
    opened = drawn(kept_page, width=width, height=844)
    until(opened, f"document.querySelector('{DRAWN}').closest('.plot').clientWidth <= innerWidth")
    assert opened.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert opened.locator("button.run").is_visible()


def test_light_and_dark_follow_the_system_and_the_button(page):
    """A dark system gives a dark page and dark figures; the button changes both, and the choice is kept."""
    opened = page("/runs/?experiment=shen-hu-2015", theme="dark", **SMALL)
    opened.wait_for_selector("h1")
    run(opened)
    paper = "document.querySelector('.plot')._fullLayout.paper_bgcolor"
    assert opened.evaluate("document.documentElement.dataset.theme") == "dark"
    assert opened.evaluate(paper) == "#151a20"
    opened.click("header button >> nth=-1")
    until(opened, f"{paper} === '#ffffff'")
    opened.reload()
    assert opened.evaluate("document.documentElement.dataset.theme") == "light"


def test_markup_in_texts_is_shown_as_text(page, server):
    """An experiment whose texts are markup is shown as text: in the page, its figures and its report."""
    hostile = "<img src=x onerror='window.pwned=1'><script>window.pwned=1</script>"
    opened = page("/runs/", **SMALL)
    spec = json.loads(opened.request.get(f"{server}/api/experiments/shen-hu-2015").text())
    for figure in spec["figures"]:
        figure |= {"title": hostile[:150], "caption": hostile}
        for panel in figure["panels"]:
            panel |= {"title": hostile[:150], "y_title": hostile[:150], "x_title": hostile[:150]}
    spec |= {"title": hostile, "source": hostile, "description": hostile, "errata": [hostile]}
    answer = opened.request.post(f"{server}/api/runs", data=spec)
    assert answer.ok, answer.text()
    opened.goto(f"{server}/runs/?run={answer.json()['id']}")
    opened.wait_for_selector(DRAWN, state="attached")
    assert opened.inner_text("h1") == hostile
    assert opened.evaluate("window.pwned") is None
    opened.goto(f"{server}/api/runs/{answer.json()['id']}/report")
    opened.wait_for_selector(".plot .main-svg", state="attached")
    assert opened.evaluate("window.pwned") is None and opened.locator("img").count() == 0


def test_the_link_of_a_run_that_is_not_done_shows_it_when_it_is(page, server):
    """A link that is opened while the run is computed follows it: the figures come without another visit."""
    opened = page("/runs/", **SMALL)
    request = {"experiment": "zhou-tan-2012", "set": {"seed": 77}}
    answer = opened.request.post(f"{server}/api/runs?wait=0", data=request)
    assert answer.status == 202
    opened.goto(f"{server}/runs/?experiment=zhou-tan-2012&set=seed%3D77&run={answer.json()['id']}")
    opened.wait_for_selector(DRAWN, state="attached")
    assert opened.watch.errors == []


def test_no_button_uploads_a_figure(kept_page):
    """Plotly's button for uploading a figure is absent."""
    opened = drawn(kept_page)
    opened.hover("figure .plot")
    titles = opened.evaluate("[...document.querySelectorAll('.modebar-btn')].map((button) => button.dataset.title)")
    sent = re.compile("share|cloud|studio|send", re.IGNORECASE)
    assert "Zoom in" in titles and not [title for title in titles if sent.search(title)]


def test_the_report_opens_offline_from_a_file(page, server, browser, tmp_path):
    """The saved report draws every figure without a network and requests nothing."""
    opened = page("/runs/")
    answer = opened.request.post(f"{server}/api/runs?wait=60", data={"experiment": "shen-hu-2015"})
    report = opened.request.get(f"{server}{answer.json()['links']['report']}").text()
    (tmp_path / "report.html").write_text(report, encoding="utf-8")
    context = browser.new_context(offline=True)
    page_ = context.new_page()
    requests, errors = [], []
    page_.on("request", lambda request: requests.append(request.url))
    page_.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
    page_.goto((tmp_path / "report.html").as_uri())
    until(page_, "document.querySelectorAll('.plot .js-line').length && !resizing.busy")
    assert page_.locator(".plot").count() == page_.locator(".plot:has(.main-svg)").count() >= 5
    assert len(requests) == 1 and errors == []
    assert page_.locator(".modebar-btn[data-title*=Share]").count() == 0
    context.close()


def test_a_run_names_how_the_simulated_plant_differs_from_the_model(page):
    """The form has a field for each difference; a refusal is shown at it; the run names them, in both languages."""
    opened = page("/runs/?experiment=zhao-2012&set=horizon%3D10&set=truth.deviation%3D0.02", **SMALL)
    opened.wait_for_selector("#field-truth-deviation")  # a link that sets one unfolds them
    assert opened.input_value("#field-truth-deviation") == "0.02" and opened.inner_text(".reality") == ""
    opened.fill("#field-truth-process_noise-x1", "0.001")
    opened.fill("#field-truth-outputs-y-missing", "0.1")
    opened.fill("#field-truth-dynamics-x2", "nope")
    opened.click("button.run")
    opened.wait_for_selector("#field-truth-dynamics-x2[aria-invalid=true]")
    assert "nope" in opened.inner_text("#field-truth-dynamics-x2-error")
    opened.fill("#field-truth-dynamics-x2", "-0.01*x2")
    opened.click("button.run")
    opened.wait_for_selector(".reality p")
    words = opened.inner_text(".reality")
    assert all(part in words for part in ("2 % off", "process noise of x₁", "10 % of the samples", "-0.01*x2"))
    assert "truth.dynamics.x2=-0.01*x2" in opened.inner_text(".side")


def test_a_figure_for_a_paper_is_previewed_and_downloaded(kept_page):
    """The preview is the server's SVG; an option that is chosen is in the command and in the file."""
    page = drawn(kept_page)
    page.click("#figure-faults .heading button")
    until(page, "document.querySelector('.paper-dialog')?.dataset.state === 'drawn'")
    assert "Ready for a journal" in page.inner_text(".paper-dialog .preview")
    assert page.evaluate("document.querySelector('.paper-dialog img').naturalWidth") == round(8.5 / 2.54 * 96)
    page.get_by_role("button", name="17.5 cm").click()
    until(page, "document.querySelector('.paper-dialog form code').textContent.includes('--width 17.5')")
    page.click(".paper-dialog footer .segments button >> nth=1")
    with page.expect_download() as download:
        page.click(".paper-dialog footer .run")
    assert 'width="496.06' in download.value.path().read_text()
    page.keyboard.press("Escape")
    until(page, "document.querySelector('.paper-dialog') === null")
    assert page.watch.errors == []
