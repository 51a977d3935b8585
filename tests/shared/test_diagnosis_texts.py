"""Sentences of the diagnosis are messages on the wire; results stored as plain text can be read."""

from thetascope.messages import Message
from thetascope.messages.message import text_of
from thetascope_schemas.experiment.diagnosis import ObserverDiagnosis


def test_a_message_keeps_its_code_and_arguments():
    """A message becomes code, arguments and the English sentence; it can be rendered in Chinese later."""
    found = ObserverDiagnosis.model_validate(
        {"observer": "", "sentence": Message("diagnosis.summary.no-fault", since=2.0)}
    )
    assert found.sentence is not None and found.note is None
    assert (found.sentence.code, found.sentence.args) == ("diagnosis.summary.no-fault", {"since": 2.0})
    assert found.sentence.text == "no fault found since 2 s" and text_of(found.sentence, "zh") == "自 2 s 起未发现故障"


def test_a_plain_text_of_a_stored_result_is_read():
    """A plain text becomes a message without a code, shown unchanged; an empty one becomes None."""
    found = ObserverDiagnosis.model_validate({"observer": "", "sentence": "over", "note": ""})
    assert text_of(found.sentence, "zh") == "over" and found.note is None and text_of(found.note) == ""
