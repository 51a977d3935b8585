"""The diagnosis in one sentence: the message of each situation, with words in all languages."""

import re
from types import SimpleNamespace

import pytest

from thetascope.diagnosis.evaluation.summary_message import Situation, summary
from thetascope.diagnosis.evaluation.verdicts import judge, presences
from thetascope.messages.catalogue import languages
from thetascope_schemas.experiment.faults import Site

OWN = {"a", "b", "c"}
KINDS = {"a": "actuator", "b": "sensor", "c": "process"}


def fault(name, onset, end=None, kind="channel"):
    """Return a step in a channel, or a fault on an output."""
    return SimpleNamespace(site=Site(kind, name), shape="step", onset=onset, end=end)


def alarm(t, channel="", *alternatives, output="", cleared=None):
    """Return an alarm raised at t, with size 1 ± 0.1."""
    return SimpleNamespace(
        id=f"{channel}{output}{t}",
        t=t,
        kind="fault" if channel else "unexplained",
        channel=channel,
        alternatives=alternatives,
        output=output,
        onset=t,
        onset_from=t,
        size=1.0 if channel else None,
        size_from=0.9 if channel else None,
        size_to=1.1 if channel else None,
        cleared=cleared,
    )


def message_at(faults=(), *alarms, t=50.0, **more):
    """Return the message at time t."""
    ordered = sorted(alarms, key=lambda one: one.t)
    judgement = judge(ordered, faults, presences(faults, t, lambda *_: True), OWN, 0.0)
    return summary(Situation(t, ordered, judgement, kinds=KINDS, **more))


A, B, C = fault("a", 20), fault("b", 25), fault("c", 30)
CASES = {
    "broken": lambda: message_at([A], alarm(21, "a"), broken=40.0),
    "no-diagnosis": lambda: summary(Situation(50, (), None, note="the plant has no fault channels")),
    "unexplained": lambda: message_at([fault("y", 20, kind="output")], alarm(21, output="y.y")),
    "misattributed": lambda: message_at([A], alarm(21, "b")),
    "misattributed-for-output": lambda: message_at([fault("y", 20, kind="output")], alarm(21, "b")),
    "false-alarm": lambda: message_at([], alarm(21, "b")),
    "either": lambda: message_at([A], alarm(21, "a", "b")),
    "measurement": lambda: message_at([fault("y", 20, kind="output")]),
    "hidden": lambda: message_at([A], hidden=frozenset("a")),
    "hidden-beside": lambda: message_at([A, B], alarm(26, "b"), hidden=frozenset("a")),
    "looking": lambda: message_at([A]),
    "looking-beside": lambda: message_at([A, B], alarm(21, "a")),
    "not-judged": lambda: message_at([A], judged=15.0),
    "not-judged-beside": lambda: message_at([A, B], alarm(21, "a"), judged=24.0),
    "one-found": lambda: message_at([A], alarm(21, "a")),
    "one": lambda: message_at([A], alarm(21, "a", cleared=23), alarm(30, "a")),
    "one-again": lambda: message_at([fault("a", 20, 40), fault("a", 45)], alarm(21, "a")),
    "two-identified-found": lambda: message_at([A, B], alarm(21, "a"), alarm(26, "b")),
    "two-identified": lambda: message_at(
        [A, B], *(alarm(t, c, cleared=28) for t, c in ((21, "a"), (26, "b"))), alarm(30, "a"), alarm(31, "b")
    ),
    "identified-found": lambda: message_at([A, B, C], alarm(21, "a"), alarm(26, "b"), alarm(31, "c")),
    "ending": lambda: message_at([fault("a", 20, 40)], alarm(21, "a")),
    "lost-only": lambda: message_at(observers=1, lost=[("ekf", 30.0)]),
    "lost-all": lambda: message_at(observers=2, lost=[("ekf", 30.0), ("ukf", 31.0)]),
    "lost-one": lambda: message_at(observers=2, lost=[("ekf", 30.0)]),
    "lost-some": lambda: message_at(observers=3, lost=[("ekf", 30.0), ("ukf", 31.0)]),
    "quiet-again": lambda: message_at([fault("a", 20, 30)], alarm(21, "a", cleared=33)),
    "early": lambda: message_at(settled=60.0),
    "quiet": lambda: message_at(settled=10.0),
}


@pytest.mark.parametrize("key", CASES)
def test_a_situation_gets_its_message_with_words_in_every_language(key):
    """The code is the expected one, and no sentence shows a code or an unfilled field."""
    message = CASES[key]()
    assert message.code == f"diagnosis.summary.{key}"
    for language in languages():
        words = message.text(language)
        assert not re.search(r"diagnosis\.|[{}]", words), words


def test_sentences_contain_the_numbers():
    """Size with interval, onset and delay; two undetected faults are counted; the newest covered fault is named."""
    assert str(CASES["one-found"]()) == "a actuator fault: +1 ± 0.1 since 21 s, found in 1 s."
    assert str(message_at([A, B])) == "2 faults are active. None is found yet."
    assert str(CASES["one-again"]()).endswith("A second a fault began at 45 s while this alarm was still on.")
    assert str(CASES["either"]()) == "a or b: this input does not distinguish them."
    assert str(CASES["identified-found"]()).startswith("3 faults, all identified. c was found 1 s")


def test_an_active_fault_whose_alarm_has_cleared_is_undetected():
    """The sentence is not "all faults are over"."""
    assert message_at([A], alarm(21, "a", cleared=25)).code == "diagnosis.summary.looking"


def test_the_worst_situation_comes_first():
    """Lost plant, wrong name, false alarm, undetected fault, then "identified"."""
    assert message_at([A, B], alarm(21, "a")).code == "diagnosis.summary.looking-beside"
    assert message_at([A, B], alarm(10, "c"), alarm(21, "a")).code == "diagnosis.summary.false-alarm"
    assert message_at([A, B], alarm(10, "c"), alarm(21, "a"), alarm(22, "c")).code == "diagnosis.summary.misattributed"
    assert message_at([A, B], alarm(10, "c"), alarm(21, "a"), broken=30.0).code == "diagnosis.summary.broken"
