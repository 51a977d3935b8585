"""Each observer with constant gains, DREM and parity equations: a case in which it shines and one in which it fails.

The cases and errors are those of docs/which-observer.md: root mean square in typical faults, an omitted fault whole.
"""

import re
from pathlib import Path

import pytest

from tests.simulate import simulate
from thetascope import library
from thetascope_schemas import ResolvedExperiment
from tools.compare_observers import CASES, figure

GUIDE = (Path(__file__).parents[3] / "docs" / "which-observer.md").read_text()
BY_HEADING = {case.heading: case for case in CASES}
SHINES = {
    "proportional-integral": ("at rest", 0.02),
    "extended-state": ("moving fault", 0.25),
    "sliding-mode": ("moving fault", 0.2),
    "unknown-input": ("at rest", 0.02),
    "drem": ("four faults", 0.03),
}
FAILS = {
    "proportional-integral": ("four faults", 0.9),
    "extended-state": ("both directions", 1.0),
    "sliding-mode": ("both directions", None),
    "unknown-input": ("both directions", None),
    "drem": ("moving fault", 0.45),
}


def in_guide(kind: str, heading: str) -> str:
    """Return the entry of the guide's table."""
    head = next(line for line in GUIDE.splitlines() if line.startswith("| Observer | at rest"))
    row = next(line for line in GUIDE.splitlines() if re.match(rf"\| `{kind}` \| [0-9–]", line))
    columns = [cell.strip() for cell in head.split("|")]
    return row.split("|")[columns.index(heading)].strip()


@pytest.mark.parametrize("kind", SHINES)
def test_it_shines_where_the_guide_sends_people(kind: str):
    """Its error is small, no assumption fails, and the guide has the same number."""
    heading, most = SHINES[kind]
    shown = figure(BY_HEADING[heading], kind)
    assert float(shown) < most and shown == in_guide(kind, heading)


@pytest.mark.parametrize("kind", FAILS)
def test_it_fails_where_the_guide_warns(kind: str):
    """Its error is large, or it cannot be built; the guide has the same entry."""
    heading, least = FAILS[kind]
    shown = figure(BY_HEADING[heading], kind)
    assert shown == in_guide(kind, heading)
    assert shown == "–" if least is None else float(shown.rstrip("*")) > least


def parity(experiment: str, channels: str, changes: dict):
    data = library.resolve(library.experiment(experiment)).model_dump(mode="json")
    data |= {"figures": [], "diagnosis": {"enabled": False}} | changes
    data["observers"] = [{"label": "o", "kind": "parity", "options": {"channels": channels}}]
    result = simulate(ResolvedExperiment.model_validate(data))
    shares = {name: float((result.column(f"o.residual.{name}")[-100:] > 1).mean()) for name in channels.split(",")}
    return {check.name.code: check.verdict for check in result.observers[0].checks}, shares


def test_parity_shines_on_the_motor():
    """A load moves the residual that is blind to the gain, and not its own."""
    verdicts, over = parity("dc-motor-parity", "gain_loss,load_torque", {})
    assert over == {"gain_loss": 1.0, "load_torque": 0.0} and set(verdicts.values()) == {"holds"}


def test_parity_fails_on_the_slow_tanks():
    """Pump 1 loses half, and no residual rises: within a window the tanks hardly move. The check says so beforehand."""
    faults = [{"channel": "pump1", "shape": "step", "onset": 500, "size": 0.5}]
    verdicts, over = parity("quadruple-tank", "pump1,pump2", {"faults": faults, "horizon": 1500})
    assert max(over.values()) < 0.1 and verdicts["check.isolable"] == "fails"
