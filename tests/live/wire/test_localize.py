"""Messages of a session are written in the viewer's language: sentences by their codes, prose by its maps."""

import json

from thetascope import library
from thetascope.live.wire.localize import encode
from thetascope.messages import Message
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.service.session import Event, Refused, Spec
from thetascope_schemas.texts.local_text import ALL


def spec() -> Spec:
    """Return the message with an experiment of the library, its plant in full."""
    experiment = library.experiment("dc-motor")
    return Spec(spec=experiment.model_copy(update={"plant": library.plant("dc-motor")}))


def sent(message, language: str):
    """Return the message that a viewer of a language receives."""
    return json.loads(encode(message, language))


def test_a_sentence_is_in_the_language_of_the_viewer():
    """English as created, Chinese by code and arguments."""
    message = Message("event.observer-added", observer="ekf")
    event = Event(row=0, t=0, kind="observer-added", subject="ekf", message=Text.of(message))
    assert sent(event, "en")["message"]["text"] == message.text("en")
    assert sent(event, "zh")["message"] == {**message.as_data(), "text": message.text("zh")}
    assert message.text("en") != message.text("zh")


def test_a_refusal_is_in_the_language_of_the_viewer():
    """Problem and remedy, both by the code of the problem."""
    code, args = "session.seek.ahead", {"t": 12.5}
    refusal = Refused(id=1, code=code, args=args, problem="", remedy="")
    answer = sent(refusal, "zh")
    assert answer["problem"] == Message(code, **args).text("zh")
    assert answer["remedy"] == Message(f"{code}.remedy", **args).text("zh")


def test_prose_is_in_the_language_of_the_viewer_or_in_all():
    """A title is a text, and with `*` the map of all its languages, which the contract takes back."""
    english, chinese = (sent(spec(), language)["spec"]["plant"]["title"] for language in ("en", "zh"))
    assert isinstance(english, str) and isinstance(chinese, str) and english != chinese
    everything = sent(spec(), ALL)["spec"]
    assert everything["plant"]["title"] == {"en": english, "zh": chinese}
    assert Spec(spec=everything).spec == spec().spec
