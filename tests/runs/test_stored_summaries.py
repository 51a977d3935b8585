"""Summaries of runs that earlier versions stored are read."""

from typing import Any

import pytest

from tests.runs.samples import spec
from thetascope.messages.message import text_of
from thetascope.runs.jobs.store_rows import snapshot_of
from thetascope.store import Record
from thetascope_schemas.service.facts import ObserverNow
from thetascope_schemas.service.run import RunSummary

CAUSE = {"code": "diverged.plant", "args": {}, "text": "the plant diverged"}


def plain(data: Any) -> Any:
    """Return plain data with the text of every message in place of the message, as the versions before messages did."""
    if isinstance(data, dict):
        return data["text"] if data.keys() == {"code", "args", "text"} else {k: plain(v) for k, v in data.items()}
    return [plain(item) for item in data] if isinstance(data, list) else data


def stored(summary: dict) -> Record:
    return Record("0" * 32, spec().model_dump_json(), "A run", "done", engine="", created=1.0, summary=summary)


def test_a_summary_with_plain_texts_is_read():
    """Titles, checks, causes and notes of a summary without codes are shown as they were written."""
    data = RunSummary.model_validate(RunSummary.model_json_schema()["examples"][0]).model_dump(mode="json")
    data["diverged"] = {"time": 2.5, "cause": CAUSE}
    data["observers"][0]["diverged"] = {"time": 2.5, "cause": CAUSE}
    data["notes"] = [CAUSE]
    summary = snapshot_of(stored(plain(data))).summary
    assert summary is not None and plain(summary.model_dump(mode="json")) == plain(data)
    assert text_of(summary.observers[0].title, "zh") == "Adaptive observer (Zhao, Li, Li)"


def test_an_observer_that_diverged_with_a_plain_text_is_read():
    """The cause in the facts of an earlier version is a sentence without a code."""
    data = ObserverNow.model_json_schema()["examples"][0] | {"diverged": {"t": 2.5, "cause": "it diverged"}}
    observer = ObserverNow.model_validate(data)
    assert observer.diverged is not None and text_of(observer.diverged.cause, "zh") == "it diverged"


@pytest.mark.parametrize("summary", [{"rows": 1}, {"columns": 1, "rows": 1, "step": 1, "old": 1}, {"columns": "many"}])
def test_a_summary_in_an_unknown_form_is_left_out(summary):
    """The run is still listed and can be computed again; its spec is unchanged."""
    snapshot = snapshot_of(stored(summary))
    assert snapshot.summary is None and snapshot.spec == spec() and snapshot.status == "done"
