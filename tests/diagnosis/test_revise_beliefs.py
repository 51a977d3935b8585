"""Revision of an unexplained event, whose cause may be a wrong belief in other faults."""

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
    """Return zhao-2012 without faults: the filter's inputs, and the detector."""
    w = watching("zhao-2012")
    return w.made, *w.rows(3, faults=False)


def believing(made, table, t, size: float):
    """Return the monitor at AT with two wrong beliefs: theta1 is active and y is not trusted."""
    rows = AT * made.stride
    watched = run_to_end(made.advance(made.begin(), table[:rows], t[:rows]))
    now = watched.decisions
    assert now.at == AT and not now.findings
    level = now.known.level.copy()
    level[0] = size
    fault = Finding(
        AT - 50, 0, (), AT - 50.0, AT - 50.0, AT - 50.0, 2 * size, 0.1 * size, 50.0, settled=(size, 0.01 * size, 0.0)
    )
    silent = Finding(AT, None, (), AT, AT, AT, np.nan, np.nan, 10.0, output=0)
    known = replace(now.known.plus((), AT), level=level)
    return replace(
        watched,
        decisions=replace(
            now, known=known, findings=(fault, silent), active=(0, 1), trusted_outputs=np.zeros(1), start=AT
        ),
    )


def test_an_output_is_trusted_again_when_a_belief_is_dropped(sound):
    """The only output is ignored because of a false fault: the first revision ends both, and detection continues."""
    made, table, t = sound
    watched = believing(made, table, t, 0.02)
    rows = slice(AT * made.stride, (AT + 300) * made.stride)
    now = run_to_end(made.advance(watched, table[rows], t[rows])).decisions
    fault, silent = now.findings
    assert fault.cleared == silent.cleared == AT + FIRST and now.active == () and now.trusted_outputs.tolist() == [1.0]
    assert (fault.size, fault.deviation) == (0.02, 0.0002) and not now.known.level.any()


def test_a_wrong_output_stays_untrusted(sound):
    """Readings that are far off, though not stuck, are not accepted by any revision."""
    made, table, t = sound
    watched = believing(made, table, t, 0.0)
    wild = table.copy()
    wild[AT * made.stride :, made.filter.names.index(f"measured.{made.filter.outputs[0]}")] += (
        0.05 * np.random.default_rng(1).standard_normal(len(t) - AT * made.stride)
    )
    rows = slice(AT * made.stride, (AT + 300) * made.stride)
    now = run_to_end(made.advance(watched, wild[rows], t[rows])).decisions
    assert now.trusted_outputs.tolist() == [0.0] and 1 in now.active


def test_revisions_become_less_frequent(sound):
    """64, 128, 256 decisions after the finding; none if nothing is unexplained."""
    made, table, t = sound
    now = believing(made, table, t, 0.0).decisions
    assert [next_readmission(now, AT + d) - AT for d in (1, 64, 65, 129)] == [64, 64, 128, 256]
    assert next_readmission(replace(now, active=(0,)), AT + 1) is None
