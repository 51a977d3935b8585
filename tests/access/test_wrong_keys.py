"""Delays after wrong keys."""

from thetascope.access.wrong_keys import WrongKeys, network


def test_delays_grow_and_are_forgotten():
    """One mistake costs nothing; the delay has a bound; after a while an address is as good as new."""
    time = 0.0
    wrong = WrongKeys(lambda: time)
    delays = [wrong.count("10.0.0.1") for _ in range(20)]
    assert delays[0] == 0 and delays[1:5] == [0.25, 0.5, 1, 2] and max(delays) == 4.0
    assert wrong.count("10.0.0.2") == 0
    time = 600.0
    assert wrong.count("10.0.0.1") == 0


def test_few_answers_wait_for_one_address():
    """A flood of wrong keys holds no flood of connections; other addresses are not concerned."""
    wrong = WrongKeys()
    assert [wrong.wait("10.0.0.1") for _ in range(10)] == [True] * 8 + [False] * 2
    assert wrong.wait("10.0.0.2")
    wrong.answered("10.0.0.1")
    assert wrong.wait("10.0.0.1")


def test_an_ipv6_network_counts_as_one_address():
    """A machine chooses among 2⁶⁴ addresses; an IPv4 address written as IPv6 stays itself."""
    assert network("2001:db8::1") == network("2001:db8::ffff:1") != network("2001:db8:0:1::1")
    assert network("::ffff:10.0.0.1") == "10.0.0.1" != network("::ffff:10.0.0.2")
    assert network("fe80::1%eth0") == network("fe80::2") and network("testclient") == "testclient"


def test_the_memory_is_bounded():
    """An attacker with many addresses does not fill it; the most recent ones are kept."""
    time = 0.0
    wrong = WrongKeys(lambda: time)
    for n in range(20_000):
        time = n / 1000
        wrong.count(f"host-{n}")
    assert len(wrong._counts) <= 4096 and wrong.count("host-19999") == 0.25
