"""Whom a request acts for, by where the service listens, and by what the request shows."""

from dataclasses import replace

import pytest

from thetascope.access.gate import HOLDER, Gate, Presented, Refused, cookie_name, is_loopback
from thetascope.access.principal import MACHINE, Principal
from thetascope.settings import Settings

LOCAL = Presented("127.0.0.1")
OTHER = Presented("192.168.1.7", loopback_name=False)


def gate(tmp_path, **settings) -> tuple[Gate, str]:
    """Return a gate, and its access key."""
    made = Gate(Settings(data=tmp_path, **settings))
    return made, made.file.ensured()[1] or settings["key"]


def test_on_loopback_everything_on_the_machine_is_its_owner(tmp_path):
    """A page and a script have the same rights; no key is created."""
    made = Gate(Settings(data=tmp_path))
    assert made.admit(LOCAL) == Principal("127.0.0.1", MACHINE, is_machine=True)
    assert not made.expects_others and made.admit(replace(LOCAL, keys=("wrong",))).is_machine
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("request_", [replace(LOCAL, proxied=True), replace(LOCAL, loopback_name=False), OTHER])
def test_a_proxy_in_front_of_loopback_needs_the_key(tmp_path, request_):
    """Its clients are on other machines, whatever its own address is."""
    made, key = gate(tmp_path)
    assert made.admit(request_) is Refused.NO_KEY
    assert made.admit(replace(request_, keys=(key,))).owner == HOLDER


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "", "192.168.1.2", "lab-pc", "localhost.example.org"])
@pytest.mark.parametrize("request_", [LOCAL, OTHER])
def test_bound_to_other_addresses_everybody_needs_the_key(tmp_path, host, request_):
    """Also what claims to come from the machine itself."""
    made, key = gate(tmp_path, host=host)
    assert made.asks_everybody and made.admit(request_) is Refused.NO_KEY
    assert made.admit(replace(request_, keys=("guess",))) is Refused.WRONG_KEY
    assert not made.admit(replace(request_, keys=("guess", key))).is_machine


@pytest.mark.parametrize(
    ("published", "asked"), [("127.0.0.1", False), ("::1", False), ("0.0.0.0", True), ("10.0.0.5", True)]
)
def test_of_a_container_the_address_of_its_port_counts(tmp_path, published, asked):
    """It listens everywhere; published on loopback only a proxy's clients need the key."""
    made, key = gate(tmp_path, host="0.0.0.0", published=published)
    assert made.asks_everybody is asked
    assert (made.admit(LOCAL) is Refused.NO_KEY) is asked
    assert made.admit(replace(OTHER, proxied=True)) is Refused.NO_KEY
    assert made.admit(replace(OTHER, keys=(key,))).owner == HOLDER or not asked


def test_open_admits_everybody(tmp_path):
    """THETASCOPE_OPEN=1 asks nobody, and nobody owns a run alone."""
    made = Gate(Settings(data=tmp_path, host="0.0.0.0", open=1))
    assert made.admit(OTHER).is_machine and not made.expects_others and list(tmp_path.iterdir()) == []


def test_without_a_key_nobody_else_gets_in(tmp_path):
    """A service on loopback that never had a key is closed to a proxy's clients, whatever they show."""
    made = Gate(Settings(data=tmp_path))
    assert made.admit(replace(OTHER, keys=("",))) is Refused.WRONG_KEY
    assert made.admit(replace(OTHER, tickets=(("thetascope-", ""),))) is Refused.NO_KEY
    assert made.sign_in(OTHER, "") is None


def test_a_browser_is_known_by_its_ticket(tmp_path):
    """It stays the same owner over a change of the key, after signing in again."""
    made, key = gate(tmp_path, host="0.0.0.0")
    name = cookie_name(made.file.current())
    with_ticket = replace(OTHER, tickets=((name, made.sign_in(OTHER, key)),))
    browser = made.admit(with_ticket)
    assert browser.owner.startswith("browser-") and browser.acts_for(HOLDER) and not browser.acts_for(MACHINE)
    assert made.admit(replace(with_ticket, address="10.0.0.1")) == browser
    key = made.file.renew()
    assert made.admit(with_ticket) is Refused.ENDED
    again = made.sign_in(with_ticket, key)
    assert made.admit(replace(OTHER, tickets=((name, again),))) == browser


def test_scripts_may_name_themselves(tmp_path):
    """The name is a secret of the script: owners cannot be computed from it without the installation's secret."""
    made, key = gate(tmp_path, host="0.0.0.0")
    plain, mine, yours = (made.admit(replace(OTHER, keys=(key,), script=name)) for name in ("", "mine", "yours"))
    assert plain.owner == HOLDER and len({plain.owner, mine.owner, yours.owner}) == 3
    assert "mine" not in mine.owner and not yours.acts_for(mine.owner) and mine.acts_for(HOLDER)
    assert made.admit(replace(OTHER, script="mine")) is Refused.NO_KEY


@pytest.mark.parametrize(
    ("name", "own"),
    [
        *((name, True) for name in ("localhost", "LOCALHOST", "127.0.0.1", "127.9.8.7", "::1", "[::1]", "a.localhost")),
        *((name, False) for name in ("", "0.0.0.0", "::", "127.0.0.1.nip.io", "localhost.example", "2130706433")),
    ],
)
def test_loopback_is_recognised(name, own):
    """By the number, or by names that browsers resolve themselves."""
    assert is_loopback(name) is own
