"""Changes of a spec by commands: the result of clearing a fault."""

import pytest

from tests.runs.samples import spec_data
from thetascope import library
from thetascope.live.session.edits import with_faults_ended
from thetascope_schemas import Experiment
from thetascope_schemas.service.session import Clear


@pytest.mark.parametrize(("at", "left"), [(9.9, []), (10.0, []), (10.1, [(10.0, 10.1)])])
def test_a_fault_leaves_a_trace_only_if_it_began_before_it_was_cleared(at, left):
    """A fault that is cleared at its onset, or before, is removed; later it ends where it was cleared."""
    fault = {"channel": "gain", "shape": "step", "onset": 10.0, "size": 0.01}
    spec = library.resolve(Experiment.model_validate(spec_data(horizon=20, faults=[fault])))
    ended = with_faults_ended(spec, Clear(id=1, channel="gain"), at)
    assert [(f.onset, f.end) for f in ended.faults] == left
