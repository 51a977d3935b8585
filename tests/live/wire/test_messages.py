"""Reading a viewer's messages: commands, and refusals of anything else."""

import json
import random

from hypothesis import given
from hypothesis import strategies as st

from thetascope.live.wire.messages import Allowance, read
from thetascope_schemas.service.session import Inject, Refused, SetGainNow

GOOD = [
    {"type": "play", "id": 1},
    {"type": "step", "id": 2, "rows": 5},
    {"type": "speed", "id": 3, "value": None},
    {"type": "inject", "id": 4, "fault": {"channel": "gain", "shape": "step", "onset": 0, "size": 0.1}},
    {"type": "set-gain", "id": 5, "observer": "kalman", "gain": "K", "value": [1, 2]},
    {"type": "seek", "id": 6, "t": 1.5},
]


def malformed(draw: random.Random) -> str | None:
    """Return a malformed message: a damaged command, or noise."""
    message = json.loads(json.dumps(draw.choice(GOOD)))
    text = json.dumps(message)
    spoilt = [
        lambda: None,
        lambda: text[: draw.randrange(len(text))],
        lambda: "".join(chr(draw.randrange(32, 1000)) for _ in range(draw.randrange(60))),
        lambda: json.dumps(draw.choice([None, 1, "play", [], [message], {}, 1e308])),
        lambda: json.dumps(message | {"type": draw.choice(["", "Play", "eject", None, 3, ["play"]])}),
        lambda: json.dumps(message | {"id": draw.choice([-1, "x", None, 1.5, [], 10**400])}),
        lambda: json.dumps(message | {draw.choice(["extra", "__class__", "ID"]): 1}),
        lambda: json.dumps({key: value for key, value in message.items() if key != "type"}),
        lambda: text.replace("}", ', "x": NaN}', 1),
        lambda: "[" * draw.randrange(50, 50_000),
        lambda: '{"type": "inject", "id": 1, "fault": ' + '{"a": ' * 500 + "1" + "}" * 501,
        lambda: json.dumps({"type": "step", "id": 1, "rows": draw.choice([0, -5, 1e9, "1", None, 10**30])}),
        lambda: json.dumps({"type": "speed", "id": 1, "value": draw.choice([0, -1, 1e6, "fast"])}),
        lambda: json.dumps({"type": "clear", "id": 1, "channel": "\ud800"}),
        lambda: json.dumps({"type": "remove-observer", "id": 1, "label": "\udfffx"}),
        lambda: json.dumps(draw.choice(["\ud800", message | {"\ud800": 1}])),
        lambda: json.dumps({"type": "seek", "id": 1, "t": draw.choice([1e308, -1, "1"])}),
    ]
    return draw.choice(spoilt)()


def test_good_commands_are_read():
    """Each as its own type."""
    kinds = [type(read(json.dumps(message), 1000)) for message in GOOD]
    assert Refused not in kinds and Inject in kinds and SetGainNow in kinds


def test_every_malformed_message_is_refused_with_a_reason():
    """Two thousand of them; none raises, each refusal can be sent."""
    draw = random.Random(3)
    for _ in range(2000):
        text = malformed(draw)
        answer = read(text, 20_000)
        assert isinstance(answer, Refused), text
        assert answer.problem and answer.remedy
        json.loads(answer.model_dump_json())


@given(st.text(max_size=200))
def test_noise_is_refused(text):
    """Whatever it contains."""
    assert isinstance(read(text, 1000), Refused)


def test_a_refusal_names_the_command_the_field_and_the_remedy():
    """The client learns which of its commands it was; without a number the id is null."""
    answer = read('{"type": "step", "id": 41, "rows": 0}', 1000)
    assert (answer.id, answer.field, answer.value) == (41, "rows", 0)
    unknown = read('{"type": "ply", "id": 42}', 1000)
    assert unknown.id == 42 and "play" in unknown.remedy
    assert read('{"type": "play"}', 1000).id is None
    assert read("{", 1000).id is None
    assert "1,000" in read('{"type": "play", "id": 1' + " " * 1000 + "}", 1000).problem


def test_a_viewer_may_burst_and_is_then_read_at_its_rate():
    """No message is refused for its rate; it waits."""
    allowance, now, waits = Allowance(10, 0.0), 0.0, []
    for _ in range(40):
        wait = allowance.wait(now)
        waits.append(wait)
        now += wait
    assert waits[:20] == [0.0] * 20
    assert abs(now - 2.0) < 1e-9
    assert allowance.wait(now + 100) == 0.0


def test_a_long_message_counts_as_several():
    """A table of many points takes the time of twenty short commands: at 60 a second nobody else would be answered."""
    allowance, now, count = Allowance(60, 0.0), 0.0, 0
    while now < 10:
        now += allowance.wait(now, 88_000)
        count += 1
    assert count <= 3 * 10 + 10
    allowance = Allowance(60, 0.0)
    assert not any(allowance.wait(k / 60, 200) > 0.2 for k in range(600))


def test_depth_is_bounded():
    """Forty levels are read, the next one is refused."""
    for levels, says in ((39, "type"), (41, "too-deep")):
        text = '{"type": "play", "id": 1, "x": ' + "[" * (levels - 1) + "]" * (levels - 1) + "}"
        assert (says == "too-deep") == (read(text, 10_000).code == "session.message.too-deep")
