"""The picture of every plant of the library: no site, name or value lies on another one."""

import pytest

from tests.browser.live_helpers import FONTS, SET_FONT, opened

#: Draw a plant of the library as the card does and return the pairs of texts and sites that overlap, or leave it.
OVERLAPS = """async ([id, wide]) => {
  const {drawPlant} = await import(moduleAt('panels/plant/plant.js'));
  const plant = await (await fetch(`/api/plants/${id}`)).json();
  const app = {state: {...thetascope.state, plant}, act: thetascope.act};
  const {svg, values} = drawPlant(plant, app);
  for (const {node} of values) node.textContent = wide;
  const home = document.querySelector('#panel-plant');
  const before = [...home.childNodes];
  home.replaceChildren(svg);
  const frame = svg.getBoundingClientRect();
  const boxes = [...svg.querySelectorAll('text:not(.site text), .site')].map((element) => {
    const shape = element.matches('.site') ? element.querySelector('circle:not(.ring):not(.hit), rect:not(.ring)')
      : element;
    const {left, right, ...box} = shape.getBoundingClientRect().toJSON();
    const line = element.matches('.site') ? 0 : 0.22 * box.height; // of a line that its letters do not take
    const [top, bottom] = [box.top + line, box.bottom - line];
    const name = element.matches('.site') ? element.getAttribute('aria-label') : element.textContent;
    return {name, site: element.matches('.site'), left, right, top, bottom};
  }).filter(({left, right}) => right > left);
  const wrong = [];
  boxes.forEach((a, at) => {
    if (a.left < frame.left - 1 || a.right > frame.right + 1 || a.top < frame.top - 1 || a.bottom > frame.bottom + 1)
      wrong.push(`${a.name} leaves the picture`);
    for (const b of boxes.slice(at + 1)) {
      const over = Math.min(Math.min(a.right, b.right) - Math.max(a.left, b.left),
        Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top));
      if (over > 1.5) wrong.push(`${a.name} / ${b.name}`);
    }
  });
  home.replaceChildren(...before);
  return wrong;
}"""


@pytest.mark.parametrize("language", ["en", "zh"])
def test_nothing_overlaps_in_the_picture_of_any_plant(kept_page, server, language):
    """At 1440 px, in narrow and wide fonts, with long values beside the wires."""
    live = opened(kept_page, "/?experiment=zhao-2012&t=5")
    live.evaluate(f"thetascope.act.language('{language}')")
    plants = live.evaluate(
        "fetch('/api/catalogue').then((one) => one.json()).then((one) => one.plants.map(({id}) => id))"
    )
    assert len(plants) >= 10
    wrong = {}
    for font in FONTS:
        live.evaluate(SET_FONT, font)
        for id in plants:
            for value in ("−0.0123",):
                if found := live.evaluate(OVERLAPS, [id, value]):
                    wrong[f"{id} in {font or 'the usual font'}"] = found
    assert wrong == {}
