"""A fault is over when its estimate has fallen below a fifth of its size."""

import pytest

from tests.diagnosis.watching import step, watching

SIZE, CHANGE = 0.02, 45.0


def alarms_of(share: float) -> list[dict]:
    """Return the alarms of a run in which a fault drops to a share of its size at CHANGE."""
    faults = [step("theta3", 20.0, SIZE), step("theta3", CHANGE, (share - 1) * SIZE)]
    alarms = watching("zhao-2012", faults).alarms(1)
    assert {a["channel"] for a in alarms} == {"theta3"}
    return alarms


def test_a_fault_that_drops_to_three_tenths_is_still_on():
    """At 30 % of its size a fault is not over: its alarm stays on, with the remaining size."""
    (alarm,) = alarms_of(0.3)
    assert alarm["cleared"] is None and alarm["size"] == pytest.approx(0.3 * SIZE, rel=0.1)


def test_a_fault_that_drops_to_a_tenth_is_over():
    """At 10 % of its size a fault is over, with its original size; the rest is a new, small fault."""
    first, second = alarms_of(0.1)
    assert CHANGE < first["cleared"] < CHANGE + 1 and first["size"] == pytest.approx(SIZE, rel=0.05)
    assert second["cleared"] is None and second["size"] == pytest.approx(0.1 * SIZE, rel=0.1)
