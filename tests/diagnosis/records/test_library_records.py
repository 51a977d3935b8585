"""Runs of library experiments as records: the noise and all faults are found, and nothing in runs without faults."""

import pytest

from thetascope import library
from thetascope.assembly import prepare
from thetascope.assembly.analyses.record_diagnosis import diagnose_columns
from thetascope_schemas import Experiment


@pytest.mark.parametrize("name", ["dc-motor", "contois-physical"])
def test_every_fault_is_named_once_and_none_without_faults(name: str) -> None:
    """The noise is estimated to 15 %; each fault has its channel, and its size within 1 %; no other fault is named."""
    spec = library.experiment(name)
    plant = library.plant(spec.plant)
    for faults in (spec.faults, ()):
        changes = {"faults": faults, "observers": [], "figures": [], "diagnosis": {"enabled": False}, "seed": 3}
        run = prepare(library.resolve(Experiment.model_validate(spec.model_dump() | changes))).run()
        columns = {c: run.column(c) for c in run.names if c == "t" or c.startswith(("u.", "signal.", "y."))}
        diagnosis = diagnose_columns(plant, columns)
        assert [f.best.channel for f in diagnosis.faults] == [f.channel for f in faults], diagnosis.sentence.text
        for fault, true in zip(diagnosis.faults, faults, strict=True):
            assert fault.best.size.value == pytest.approx(true.size, rel=0.01)
        noise = {o.output: o.noise for o in diagnosis.fit.outputs}
        assert noise == pytest.approx({n: spec.noise[n].std for n in noise}, rel=0.15)
