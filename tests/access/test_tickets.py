"""Tickets: forged, ended, of another key, of another installation."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thetascope.access import tickets
from thetascope.access.key_file import Keys

KEYS = Keys(b"s" * 32, b"d" * 32)
NOW = 1_800_000_000.0


def test_a_ticket_holds_until_its_end():
    """From the sign-in on, for thirty days."""
    ticket = tickets.issue(KEYS, now=NOW)
    assert len(tickets.holder(KEYS, ticket, NOW)) == 16
    assert tickets.holder(KEYS, ticket, NOW + tickets.LASTS - 1) == tickets.holder(KEYS, ticket, NOW)
    assert tickets.holder(KEYS, ticket, NOW + tickets.LASTS) is None


def test_a_browser_keeps_its_id_when_it_signs_in_again():
    """After the ticket has ended, and after the key was changed; but not with a forged ticket."""
    ticket = tickets.issue(KEYS, now=NOW)
    id = tickets.owner_id(KEYS, ticket)
    changed = replace(KEYS, digest=b"e" * 32)
    assert tickets.holder(changed, ticket, NOW) is None
    assert tickets.holder(changed, tickets.issue(changed, ticket, NOW), NOW) == id
    assert tickets.holder(KEYS, tickets.issue(KEYS, "A" * 16 + ticket[16:], NOW), NOW) not in (id, "A" * 16)


def test_other_installations_and_removed_keys_accept_nothing():
    """The secret of an installation signs its tickets."""
    ticket = tickets.issue(KEYS, now=NOW)
    assert tickets.holder(replace(KEYS, secret=b"t" * 32), ticket, NOW) is None
    assert tickets.holder(replace(KEYS, digest=None), ticket, NOW) is None


@given(place=st.integers(0, 72), character=st.sampled_from("AZaz09-_.\n é"))
def test_no_character_of_a_ticket_can_be_changed(place, character):
    """Neither the id, nor the end, nor a signature."""
    ticket = tickets.issue(KEYS, now=NOW)
    forged = ticket[: place % len(ticket)] + character + ticket[place % len(ticket) + 1 :]
    assert forged == ticket or tickets.holder(KEYS, forged, NOW) is None


@pytest.mark.parametrize(
    "text", ["", "....", "a.1.b.c", "A" * 16 + ".99999999999." + "A" * 22 + "." + "A" * 22, "é" * 80]
)
def test_other_texts_are_no_tickets(text):
    """They are refused without an error."""
    assert tickets.holder(KEYS, text) is None and tickets.owner_id(KEYS, text) is None
