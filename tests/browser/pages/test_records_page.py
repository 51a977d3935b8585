"""The page of records: a file is read, the model is checked against it, and its faults are found."""

import json
from math import nan
from pathlib import Path

from tests.browser.live_helpers import until
from tests.browser.record_files import OFFSET, ONSET, TANK, checked, controlled_rows, csv, read_on, tank_rows
from thetascope.runs.specs.spec_files import parse

#: Let a file fall on the page.
DROP = """([name, text]) => {
  const data = new DataTransfer();
  data.items.add(new File([text], name));
  document.querySelector('h1').dispatchEvent(new DragEvent('drop', {dataTransfer: data, bubbles: true}));
}"""
PASTE = """(text) => {
  const data = new DataTransfer();
  data.setData('text/plain', text);
  document.body.dispatchEvent(new ClipboardEvent('paste', {clipboardData: data, bubbles: true}));
}"""


def downloaded(page, words: str) -> str:
    """Choose something from the list of downloads and return the text of its file."""
    page.evaluate("document.querySelector('#download').open = true")
    return file_of(page, f".download-list :text('{words}')")


def file_of(page, selector: str) -> str:
    """Click on an element and return the text of the file that it downloads."""
    with page.expect_download() as download:
        page.click(selector)
    return Path(download.value.path()).read_text()


def test_a_fault_is_found_in_three_steps_and_the_address_reopens_them(page, tmp_path):
    """Nothing is computed before the black button; the finding has the true size and onset, in the table and its
    downloads."""
    opened = page("/records/")
    sent = []
    opened.on("request", lambda request: sent.append(request.url.rpartition("/")[2]))
    read_on(opened, tmp_path, "tank.csv", csv(tank_rows()))
    assert "diagnosis" not in sent and opened.inner_text(".record-name h1") == "tank.csv"
    assert opened.locator(".picture .plot path").count() == 3 and opened.locator("#step-2").is_disabled()
    assert "fits" in checked(opened) and opened.locator(".fits tbody tr").count() == 1
    assert opened.locator(".plot path.simulated").count() == 1
    opened.click("#next")
    row = opened.wait_for_selector(".faults tbody tr")
    assert "Sensor offset" in row.inner_text()
    head, best, *_ = downloaded(opened, "Findings (CSV)").splitlines()
    found = dict(zip(head.split(","), best.split(","), strict=True))
    assert found["channel"] == "offset" and abs(float(found["onset_s"]) - ONSET) <= 2
    assert float(found["size_low"]) < OFFSET < float(found["size_high"]) and abs(float(found["size"]) - OFFSET) < 0.1
    report = json.loads(downloaded(opened, "Findings (JSON)"))
    assert report["faults"][0]["best"]["size"]["value"] == float(found["size"])
    assert opened.locator(".band.fault").count() == 1 and opened.locator(".threshold").count() == 1
    again = page(opened.evaluate("location.pathname + location.search + location.hash"))
    assert again.wait_for_selector(".step-3 .verdict").inner_text() == opened.inner_text(".verdict")
    opened.click(".top .languages")
    until(opened, "document.querySelector('.faults thead').textContent.includes('故障')")
    assert opened.watch.errors == again.watch.errors == [] and opened.watch.foreign == []


def test_observers_run_on_a_record_whose_own_plant_is_kept(page, tmp_path):
    """θ̂ of the observers is drawn with bands, the run has a report and all downloads, and the list of earlier records
    brings back the plant of one's own; the run is replayed in Live, where nothing can be injected."""
    opened = page("/records/")
    read_on(opened, tmp_path, "observed.csv", csv(tank_rows()))
    checked(opened)
    opened.click("#next")
    opened.wait_for_selector(".step-3 .verdict")
    opened.select_option("#add-observer", "adaptive-kalman")
    opened.click("#run-observers")
    opened.wait_for_selector(".run-card")
    assert opened.locator("[data-strip='theta.offset'] .curve").count() == 2
    assert opened.locator("[data-strip='theta.offset'] .curve-band").count() == 2
    assert opened.locator("[data-strip='residual.y'] .curve").count() == 2
    head = downloaded(opened, "All columns (CSV)").partition("\n")[0].split(",")
    assert "joint-ekf.theta.offset" in head and "adaptive-kalman.sigma.offset" in head and "theta.offset" not in head
    assert opened.get_attribute("#report", "href").startswith("/api/runs/")
    again = page("/records/")
    again.click(".earlier a:has-text('observed.csv')")
    again.wait_for_selector("#found .checked")
    until(again, "document.querySelector('#plant').selectedOptions[0].textContent.includes('Tank')")
    opened.click("#next")
    opened.wait_for_selector("#panel-inject a[href*='/records/?record=']")
    assert opened.locator("#panel-inject button").count() == 0
    until(opened, "document.querySelectorAll('#panel-observers .chip').length >= 2")
    assert opened.watch.errors == again.watch.errors == []


def test_a_leak_is_found_in_a_closed_loop(page, tmp_path):
    """The controller keeps the level and raises the flow; the leak has its size, and its rows are marked."""
    opened = page("/records/", width=390, height=844, theme="dark")
    read_on(opened, tmp_path, "loop.csv", csv(controlled_rows(leak=0.03)))
    assert "fits" in checked(opened)
    opened.click("#next")
    assert "Leak" in opened.wait_for_selector(".faults tbody tr").inner_text()
    head, best, *_ = downloaded(opened, "Findings (CSV)").splitlines()
    found = dict(zip(head.split(","), best.split(","), strict=True))
    assert abs(float(found["size"]) - 0.03) < 0.003 and abs(float(found["onset_s"]) - ONSET) <= 5
    width = opened.evaluate("document.documentElement.scrollWidth")
    assert width <= 390, "nothing is wider than the phone"
    assert opened.watch.errors == []


def test_a_wrong_unit_ends_in_the_second_step_and_one_click_mends_it(page, tmp_path):
    """A level in metres that is read as centimetres: no fault is named; the black button reads it in metres."""
    opened = page("/records/")
    read_on(opened, tmp_path, "tank.csv", csv(tank_rows(), scale=0.01))
    assert "y" in opened.inner_text(".peculiar") and opened.locator(".columns .doubtful").count() == 1
    opened.focus("#unit-3")
    for unit in ("mm", "cm"):
        opened.select_option("#unit-3", unit)
        until(opened, f"document.querySelector('#unit-3').value === '{unit}' && !document.querySelector('#cancel')")
    assert opened.evaluate("document.activeElement.id") == "unit-3", "the focus stays where the unit was changed"
    assert "not fit" in checked(opened)
    assert opened.is_disabled("#step-3") and opened.get_attribute(".bar-actions [aria-disabled]", "aria-disabled")
    assert opened.inner_text("#next") == "Read y in m"
    opened.click("#next")
    until(opened, "document.querySelector('#next')?.textContent === 'Find faults'")
    opened.click("#next")
    assert "Sensor offset" in opened.wait_for_selector(".faults tbody tr").inner_text()
    opened.click("#step-1")
    assert opened.input_value("#unit-3") == "m"
    assert opened.watch.errors == []


def test_what_is_peculiar_is_numbered_alike_in_the_list_and_in_the_picture(page, tmp_path):
    """A gap, sentinels and empty cells; focusing an entry lights its mark, and the other way round."""
    rows = tank_rows()
    rows[100:110] = [(t, q, -9999.0) for t, q, _ in rows[100:110]]
    rows[400:405] = [(t, q, nan) for t, q, _ in rows[400:405]]
    opened = page("/records/")
    read_on(opened, tmp_path, "tank.csv", csv(rows[:200] + rows[240:]))
    entries = opened.locator(".peculiar li")
    assert entries.count() >= 3 and opened.locator(".band.gap").count() == 1
    ids = entries.evaluate_all("(all) => all.map((one) => one.dataset.finding)")
    assert sorted(ids) == sorted(
        opened.locator(".plot .mark").evaluate_all("(all) => all.map((one) => one.dataset.finding)")
    )
    for place, finding in enumerate(ids, 1):
        mark = opened.locator(f".plot .mark[data-finding='{finding}']")
        assert mark.inner_text() == str(place)
        entries.nth(place - 1).focus()
        assert "lit" in mark.get_attribute("class")
        mark.focus()
        assert "lit" in entries.nth(place - 1).get_attribute("class")
    assert opened.watch.errors == []


def test_a_refusal_names_the_row_and_another_file_can_be_dropped_or_pasted(page, tmp_path):
    """A row with one cell is refused in place of the list; a dropped file and pasted text take its place."""
    good, lines = csv(tank_rows(150)), csv(tank_rows(150)).splitlines()
    opened = page("/records/")
    read_on(opened, tmp_path, "broken.csv", "\n".join([*lines[:100], "7", *lines[100:]]))
    assert "101" in opened.inner_text("#refused") and opened.locator("#next").count() == 0
    opened.evaluate(DROP, ["dropped.csv", good])
    until(opened, "document.querySelector('.record-name h1').textContent === 'dropped.csv'")
    opened.wait_for_selector("#next:not([aria-disabled])")
    opened.evaluate(PASTE, good.replace("q,y", "flow,level"))
    until(opened, "document.querySelector('.columns')?.textContent.includes('level')")
    opened.evaluate(DROP, ["tank.yaml", TANK.replace("title: Tank", "title: Barrel")])
    until(opened, "document.querySelector('#plant').selectedOptions[0].textContent.startsWith('Barrel')")
    opened.evaluate(DROP, ["wrong.yaml", "id: [a"])
    assert "Line 2, column 1" in opened.wait_for_selector("#refused").inner_text()
    assert [error for error in opened.watch.errors if "422" not in error] == []


def test_columns_are_changed_by_hand(page, tmp_path):
    """A column that is taken for another quantity, and a record without times whose period is typed in."""
    opened = page("/records/")
    text = "\n".join(line.split(",", 1)[1] for line in csv(tank_rows(200), "t,y,q").splitlines())
    read_on(opened, tmp_path, "tank.csv", text + "\n")
    assert opened.input_value("#use-1") == "y", "its name says so"
    opened.select_option("#use-1", "q")
    until(opened, "document.querySelector('#use-1').value === 'q' && !document.querySelector('#cancel')")
    opened.select_option("#use-2", "y")
    until(opened, "document.querySelector('#use-2').value === 'y' && !document.querySelector('#cancel')")
    opened.fill("#period", "x")
    opened.keyboard.press("Tab")
    assert opened.get_attribute("#period", "aria-invalid") == "true"
    opened.fill("#period", "2")
    opened.keyboard.press("Tab")
    until(opened, "document.querySelector('.record-name small').textContent.includes('398')")
    assert opened.watch.errors == []


def test_the_healthy_stretch_and_the_fit_follow_the_keyboard(page, tmp_path):
    """Keys move the end by a row and by a minute; a parameter is fitted, and the fitted plant is a file."""
    opened = page("/records/")
    read_on(opened, tmp_path, "tank.csv", csv(tank_rows()), TANK.replace("value: 0.25", "value: 0.27"))
    opened.focus("#next")
    opened.keyboard.press("Enter")
    opened.wait_for_selector(".step-2 .verdict")
    opened.wait_for_selector("#cancel", state="detached")
    opened.focus("#stretch-end")
    for key in ("Home", "Shift+ArrowRight", "Shift+ArrowRight", "Shift+ArrowRight", "ArrowRight", "ArrowLeft"):
        opened.keyboard.press(key)
    assert opened.evaluate("document.activeElement.id") == "stretch-end"
    end = float(opened.input_value("#healthy-end"))
    assert 180 <= end <= 182 and opened.inner_text("#next") == "Check again"
    opened.fill("#healthy-end", "280")
    opened.keyboard.press("Tab")
    opened.select_option("#fit-mode", "chosen")
    opened.set_checked("#fit-s", True)
    for name in ("A", "g"):
        opened.set_checked(f"#fit-{name}", False)
    opened.click("#next")
    until(opened, "document.querySelector('#next')?.textContent.startsWith('Find faults')")
    assert opened.locator(".groups").count() == 1
    plant = parse(file_of(opened, "button:has-text('YAML')")).data
    fitted = {one["name"]: one["value"] for one in plant["parameters"]}
    assert abs(fitted["s"] - 0.25) < 0.002 and fitted["A"] == 154
    assert opened.watch.errors == []


def test_a_lost_connection_is_waited_for_and_can_be_cancelled(page, tmp_path):
    """The header reports it; after cancelling the record is as it was read, and works once the service is back."""
    opened = page("/records/")
    read_on(opened, tmp_path, "tank.csv", csv(tank_rows()))
    opened.route("**/diagnosis", lambda route: route.abort())
    opened.click("#next")
    opened.wait_for_selector(".connection.lost")
    opened.click("#cancel")
    opened.wait_for_selector(".step-1 .columns")
    opened.unroute("**/diagnosis")
    assert "fits" in checked(opened)
    assert opened.locator(".connection.lost").count() == 0
