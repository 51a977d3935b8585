"""Files for tests of the page of records: a leaky tank whose sensor gets an offset, in several forms, and its plant."""

from pathlib import Path

import numpy as np

from tests.test_docs import blocks

TANK = blocks(Path(__file__).parents[2] / "docs" / "plant-format.md", "yaml")[0]
#: Row at which the offset of the sensor begins, and its size in cm.
ONSET, OFFSET = 300, 1.0

Row = tuple[float, float, float]


def tank_rows(rows: int = 600, seed: int = 0) -> list[Row]:
    """Return time in s, flow in cm³/s and measured level in cm of a tank with an offset from ONSET on."""
    rng, level, result = np.random.default_rng(seed), 20.0, []
    for k in range(rows):
        flow = 50.0 if (k // 60) % 2 == 0 else 65.0
        result.append((float(k), flow, level + (OFFSET if k >= ONSET else 0.0) + 0.05 * rng.standard_normal()))
        level = _later(level, flow)
    return result


def controlled_rows(rows: int = 600, leak: float = 0.03) -> list[Row]:
    """Return the same of a tank whose level a controller keeps, with a leak in cm² from ONSET on."""
    rng, level, integral, result = np.random.default_rng(1), 20.0, 50.0, []
    for k in range(rows):
        measured = level + 0.05 * rng.standard_normal()
        error = (20.0 if (k // 100) % 2 == 0 else 22.0) - measured
        integral += 0.1 * error
        flow = float(np.clip(integral + 4 * error, 0, 150))
        result.append((float(k), flow, measured))
        level = _later(level, flow, leak if k >= ONSET else 0.0)
    return result


def _later(level: float, flow: float, leak: float = 0.0) -> float:
    """Return the level in cm a second later."""
    for _ in range(10):
        level += 0.1 * (flow - (0.25 + leak) * np.sqrt(2 * 981 * max(level, 0.0))) / 154
    return level


def csv(rows: list[Row], head: str = "t,q,y", scale: float = 1.0) -> str:
    """Return the rows as CSV, levels multiplied by a scale."""
    lines = [f"{t:g},{q:g},{'' if np.isnan(y) else format(y * scale, '.6g')}" for t, q, y in rows]
    return "\n".join([head, *lines, ""])


def read_on(page, folder: Path, name: str, text: str, plant: str = TANK):
    """Give a page of records a plant of one's own and a file; return the page when it has been read or refused."""
    (folder / "plant.yaml").write_text(plant)
    (folder / name).write_text(text)
    page.locator("#plant option").nth(2).wait_for(state="attached")
    with page.expect_response("**/api/plants/read"):
        page.set_input_files("#plant-file", folder / "plant.yaml")
    page.wait_for_selector("#cancel", state="detached")
    with page.expect_response("**/api/records?name=*"):
        page.set_input_files("#file", folder / name)
    page.wait_for_selector("#cancel", state="detached")
    page.wait_for_selector("#found .checked, #refused")
    return page


def checked(page) -> str:
    """Press the black button of the first step; return the verdict of the second one."""
    page.click("#next")
    page.wait_for_selector(".step-2 .verdict, #refused")
    page.wait_for_selector("#cancel", state="detached")
    return page.inner_text(".step-2 .verdict")
