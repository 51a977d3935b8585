"""Who used much processor time gives way to others."""

from thetascope.runs.workers.shares import Shares


def test_a_client_that_used_much_gives_way_while_there_are_others():
    """A client alone never gives way; its use is forgotten with time, and so are clients that are gone."""
    now = 0.0
    shares = Shares(lambda: now)
    shares.add("one", 20.0)
    assert shares.nice("one") == 0
    shares.add("two", 0.1)
    assert shares.nice("one") > shares.nice("two") == 0
    now = 30.0
    assert shares.used("one") == 10.0
    middle = shares.nice("one")
    assert middle > 0
    shares.add("two", 0.1)
    now = 89.0
    assert shares.nice("one") < middle
    now = 200.0
    shares.add("one", 20.0)
    assert shares.nice("one") == 0 == shares.nice("three")
