"""Something unexplained is looked at again: it may be the belief in other faults that was wrong."""

from dataclasses import replace

import numpy as np
import pytest

from tests.diagnosis.watching import watching
from thetascope.diagnosis.isolation.decision_state import Finding
from thetascope.diagnosis.isolation.revise_beliefs import FIRST, next_readmission
from thetascope.diagnosis.yield_points import run_to_end

AT = 500  # the decision at which something wrong is believed


@pytest.fixture(scope="module")
def sound():
    """zhao-2012 without faults: what the filter is given, and the watcher."""
    w = watching("zhao-2012")
    return w.made, *w.rows(3, faults=False)


def believing(made, table, t, size: float):
    """Watched up to AT, and then theta1 is taken to be on and y is not heeded, both wrongly."""
    rows = AT * made.stride
    watched = run_to_end(made.advance(made.begin(), table[:rows], t[:rows]))
    now = watched.decisions
    assert now.at == AT and not now.findings
    level = now.known.level.copy()
    level[0] = size
    fault = Finding(
        AT - 50, 0, (), AT - 50.0, AT - 50.0, AT - 50.0, 2 * size, 0.1 * size, 50.0, settled=(size, 0.01 * size)
    )
    silent = Finding(AT, None, (), AT, AT, AT, np.nan, np.nan, 10.0, output=0)
    known = replace(now.known.plus((), AT), level=level)
    return replace(
        watched,
        decisions=replace(
            now, known=known, findings=(fault, silent), active=(0, 1), trusted_outputs=np.zeros(1), start=AT
        ),
    )


def test_an_output_is_heeded_again_where_a_fault_is_not_believed_any_more(sound):
    """The only output is not heeded because of a fault that is none: at the first chance both are over, with the size that it had, and watching goes on."""
    made, table, t = sound
    watched = believing(made, table, t, 0.02)
    rows = slice(AT * made.stride, (AT + 300) * made.stride)
    now = run_to_end(made.advance(watched, table[rows], t[rows])).decisions
    fault, silent = now.findings
    assert fault.cleared == silent.cleared == AT + FIRST and now.active == () and now.trusted_outputs.tolist() == [1.0]
    assert (fault.size, fault.deviation) == (0.02, 0.0002) and not now.known.level.any()


def test_an_output_that_is_wrong_stays_unheeded(sound):
    """Readings that are far off all the time, though not stuck, are not believed at any chance."""
    made, table, t = sound
    watched = believing(made, table, t, 0.0)
    wild = table.copy()
    wild[AT * made.stride :, made.filter.names.index(f"measured.{made.filter.outputs[0]}")] += (
        0.05 * np.random.default_rng(1).standard_normal(len(t) - AT * made.stride)
    )
    rows = slice(AT * made.stride, (AT + 300) * made.stride)
    now = run_to_end(made.advance(watched, wild[rows], t[rows])).decisions
    assert now.trusted_outputs.tolist() == [0.0] and 1 in now.active


def test_chances_come_ever_more_rarely(sound):
    """64, 128, 256 decisions after it was found; none where nothing is unexplained."""
    made, table, t = sound
    now = believing(made, table, t, 0.0).decisions
    assert [next_readmission(now, AT + d) - AT for d in (1, 64, 65, 129)] == [64, 64, 128, 256]
    assert next_readmission(replace(now, active=(0,)), AT + 1) is None
