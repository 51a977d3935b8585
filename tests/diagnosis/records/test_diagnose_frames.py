"""`thetascope.diagnose`: columns of NumPy or a frame in, findings out."""

import numpy as np
import polars
import pytest

from tests.diagnosis.records.rigs import TANK, since, tank
from thetascope import diagnose
from thetascope.runs.specs.refusals import InvalidSpec


def test_columns_and_frames_give_the_same_diagnosis() -> None:
    """A mapping of arrays and a frame of polars, a plant as data and as an object: the same findings."""
    recording = tank({"offset": since(300, 1.0)})
    columns = {"t": recording.t, "q": recording.u[:, 0], "level": recording.y[:, 0]}
    mapping = {"quantities": {"y": {"column": "level"}}}
    first = diagnose(TANK, columns, healthy=(0, 250), mapping=mapping)
    second = diagnose(TANK.model_dump(mode="json"), polars.DataFrame(columns), (0, 250), mapping)
    assert first == second and [f.best.channel for f in first.faults] == ["offset"]
    assert first.healthy.given and first.healthy.end == pytest.approx(250, abs=1.5)


def test_tables_come_back_in_the_kind_of_the_record() -> None:
    """Arrays give arrays and polars gives polars: findings, fits, innovations, and the estimates of observers."""
    recording = tank({"offset": since(300, 1.0)})
    columns = {"t": recording.t, "q": recording.u[:, 0], "y": recording.y[:, 0]}
    arrays = diagnose(TANK, columns, healthy=(0, 250))
    frame = diagnose(TANK, polars.DataFrame(columns), healthy=(0, 250), observers=["joint-ekf"])
    assert arrays == frame
    for name in ("findings", "outputs", "curves"):
        table = getattr(frame, name)()
        assert isinstance(table, polars.DataFrame)
        for key, values in getattr(arrays, name)().items():
            assert isinstance(values, np.ndarray)
            assert polars.Series(key, values).equals(table[key], null_equal=True) or np.isnan(values).any()
    (best,) = [fault.best for fault in frame.faults]
    assert frame.findings()["size"].to_list() == [best.size.value]
    estimates = frame.columns()
    assert estimates["t"].to_list() == (recording.t - recording.t[0]).tolist()
    assert estimates["y.y"].to_list() == recording.y[:, 0].tolist()
    assert "joint-ekf.sigma.offset" in estimates.columns and "theta.offset" not in estimates.columns
    with pytest.raises(ValueError, match="observers="):
        arrays.columns()
    with pytest.raises(InvalidSpec, match="joint-ekf"):
        diagnose(TANK, columns, observers=["joint-efk"])


def test_what_is_refused_is_named() -> None:
    """A plant, a column or a setting that cannot be raises InvalidSpec with the field."""
    recording = tank(rows=150)
    columns = {"t": recording.t, "q": recording.u[:, 0], "y": recording.y[:, 0]}
    falling = TANK.model_dump(mode="json") | {"events": [{"when": "h < 0", "set": {"h": "0"}}]}
    for arguments, words in (
        ((falling, columns), "a plant with events"),
        (({"id": "x"}, columns), "states"),
        ((TANK, {"t": np.arange(150.0), "q": columns["q"]}), "no column holds this output"),
    ):
        with pytest.raises(InvalidSpec, match=words):
            diagnose(*arguments)
    with pytest.raises(InvalidSpec, match="false_alarms"):
        diagnose(TANK, columns, false_alarms=-1)
