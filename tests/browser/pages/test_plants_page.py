"""The page of plants, and navigation and language shared by all pages."""

import json

from tests.browser.live_helpers import until
from thetascope import library


def test_every_plant_is_listed_with_its_equations(page):
    """Unfolding an entry shows its equations as MathML and links to its experiments."""
    opened = page("/plants/")
    opened.wait_for_selector(".plant-card")
    assert opened.locator(".plant-card").count() == len(library.plants())
    opened.click(".plant-card:has-text('DC motor') summary")
    opened.wait_for_selector(".plant-card[open] math")
    assert opened.locator(".plant-card[open] math").count() == 5
    assert "experiment=dc-motor" in opened.get_attribute(".plant-card[open] a.quiet", "href")
    assert opened.watch.errors == [] and opened.watch.foreign == []


def test_an_edited_plant_is_checked(page):
    """A valid plant gets its equations and the observers that can be built,
    an invalid one the position and the remedy."""
    opened = page("/plants/")
    opened.wait_for_selector("#own")
    plant = library.plant("shen-hu-2015").model_dump(mode="json")
    opened.fill("#own", json.dumps(plant))
    opened.click(".own button")
    until(opened, "document.querySelectorAll('.possible li').length >= 12")
    assert opened.locator(".possible .ok").count() >= 4 and opened.locator(".result math").count() == 3
    plant["dynamics"]["x1"] = "x2 + sin(x3)"
    opened.fill("#own", json.dumps(plant))
    opened.click(".own button")
    assert "x3" in opened.wait_for_selector(".result .problem").inner_text()
    opened.fill("#own", "{")
    opened.click(".own button")
    assert "JSON" in opened.wait_for_selector(".result .alarm").inner_text()


def test_the_pages_link_to_each_other_and_share_the_language(page, server):
    """Live, Runs and Plants are one click away, and a chosen language applies to all."""
    opened = page("/plants/")
    opened.click(".top button:text-is('中文')")
    until(opened, "document.querySelector('h1')?.textContent === '对象'")
    opened.click(".pages a:nth-child(2)")
    opened.wait_for_url(f"{server}/runs/**")
    until(opened, "document.querySelector('button.run')?.textContent === '运行'")
    opened.click(".pages a:nth-child(1)")
    until(opened, "document.querySelector('#panel-inject h2')?.textContent === '注入故障'")
