"""The log and refusals of a live session in the language of each viewer."""

import json

import pytest

from tests.live.stage import Stage, staged
from thetascope.live.wire.localize import encode
from thetascope.live.wire.messages import read
from thetascope.messages import Message
from thetascope.messages.catalogue import catalogue, languages
from thetascope_schemas.experiment.base import Text
from thetascope_schemas.service.session import Event

FAULT = {"channel": "gain", "shape": "step", "onset": 0, "size": 0.3}


def test_each_viewer_gets_the_log_in_its_language():
    """Two viewers of one session: the same event with the same code and arguments, one in English, one in Chinese."""

    async def scenario(stage: Stage) -> None:
        page, reader = await stage.connect(), await stage.connect(language="zh")
        await stage.say(page, "inject", fault=FAULT)
        english, chinese = page.of("event")[-1], reader.of("event")[-1]
        assert english["message"]["text"] == "gain injected: step, size 0.3"
        assert chinese["message"]["text"] == "已注入 gain：阶跃，大小 0.3"
        assert english | {"message": None} == chinese | {"message": None}
        assert english["message"] | {"text": ""} == chinese["message"] | {"text": ""}
        late = await stage.connect(language="zh")
        assert late.texts[0]["log"][-1] == chinese

    staged(scenario)


@pytest.mark.parametrize(
    ("kind", "fields", "problem", "remedy"),
    [
        ("seek", {"t": 500}, "会话目前在", "请给出不大于"),
        ("step", {"rows": 0}, "", ""),
        ("inject", {"fault": FAULT | {"channel": "no"}}, "没有名为 no 的故障通道", "请从 gain 中选择"),
        ("set-gain", {"observer": "no", "gain": "rho", "value": 1}, "no", ""),
    ],
)
def test_a_refusal_is_in_the_language_of_the_viewer_that_it_answers(kind, fields, problem, remedy):
    """Problem and remedy are Chinese, whether the message, the session or the clock refuses;
    code and arguments stay."""

    async def scenario(stage: Stage) -> None:
        page, english = await stage.connect(language="zh"), await stage.connect()
        answer, other = await stage.say(page, kind, **fields), await stage.say(english, kind, **fields)
        assert answer["type"] == "refused" and problem in answer["problem"] and remedy in answer["remedy"]
        assert any("\u4e00" <= char <= "\u9fff" for char in answer["problem"])
        assert any("\u4e00" <= char <= "\u9fff" for char in answer["remedy"])
        assert (answer["code"], answer["args"]) == (other["code"], other["args"]) and answer["code"]
        assert other["problem"].isascii() and other["remedy"].isascii()

    staged(scenario)


def test_invalid_messages_are_refused_with_codes():
    """Each has a code of its own, a problem and a remedy."""
    texts = [None, "x" * 2000, "[" * 900 + "]" * 900, "{", '{"type": "clear", "id": 1, "channel": "\\ud800"}']
    refusals = [read(text, 1900) for text in texts]
    assert [refusal.code.removeprefix("session.message.") for refusal in refusals] == [
        "binary",
        "too-long",
        "too-deep",
        "json",
        "surrogate",
    ]
    assert all(refusal.problem and refusal.remedy for refusal in refusals)


def test_nested_messages_and_lists_are_rendered():
    """A nested message is in the same language, and data without a code is unchanged."""
    planned = Message("event.cleared-planned", cleared=Message("event.cleared", fault="θ1"))
    event = Event(row=1, t=0.1, kind="clear", value={"text": "left alone"}, message=Text.of(planned))
    sent = json.loads(encode(event, "zh"))
    assert sent["message"]["text"] == "已清除 θ1，包括尚未发生的计划故障" and sent["value"] == {"text": "left alone"}
    assert json.loads(encode(event, "en")) == event.model_dump(mode="json")


@pytest.mark.parametrize("language", languages())
def test_the_reasons_for_closing_fit_into_a_close_frame(language):
    """A close frame has room for 123 bytes of UTF-8."""
    reasons = [words for code, words in catalogue(language).templates.items() if code.startswith("session.close.")]
    assert len(reasons) == 8 and max(len(words.encode()) for words in reasons) <= 123
