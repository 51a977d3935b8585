"""Clients whose computations take long give way to others."""

from thetascope.runs.workers.precedence import Precedence


def test_others_are_clients_who_sent_a_request_lately():
    """A client alone has no others; one that has been silent for more than ten seconds is not there."""
    now = 0.0
    precedence = Precedence(lambda: now)
    precedence.note_request("one")
    assert not precedence.others("one") and precedence.others("two")
    now = 5.0
    precedence.note_request("two")
    now = 12.0
    assert precedence.others("one") and not precedence.others("two")
    now = 16.0
    assert not precedence.others("one")


def test_a_client_gives_way_after_two_long_computations_within_half_a_minute():
    """One long computation, or two far apart, are what everybody has now and then."""
    now = 0.0
    precedence = Precedence(lambda: now)
    precedence.note_long("one")
    now = 40.0
    precedence.note_long("one")
    assert not precedence.gives_way("one")
    now = 60.0
    precedence.note_long("one")
    assert precedence.gives_way("one") and not precedence.gives_way("two")
    now = 71.0
    assert not precedence.gives_way("one")


def test_clients_that_are_gone_are_forgotten():
    """Thousands of addresses leave no memory behind."""
    now = 0.0
    precedence = Precedence(lambda: now)
    for number in range(3000):
        now += 0.1
        precedence.note_request(f"c{number}")
        precedence.note_long(f"c{number}")
    assert len(precedence._last_request) <= 1001 and len(precedence._long) <= 1001
