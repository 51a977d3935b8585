"""Delays after wrong keys.

A right key is never delayed or refused, so nobody can lock others out by guessing. A wrong one is answered later the
more of them have come from its address lately. Few such answers wait at a time; others are refused immediately.
"""

import time
from collections.abc import Callable
from ipaddress import IPv6Address, ip_address

_FIRST, _LONGEST = 0.25, 4.0
"""Seconds of delay for the second wrong key, doubled for each further one, and the longest delay."""
_HALF = 60.0
"""Seconds after which half of the wrong keys of an address is forgotten."""
_WAITING = 8
"""Answers to one address that wait at a time."""
_ADDRESSES = 4096


class WrongKeys:
    """The wrong keys of each address. Used on the event loop only.

    Args:
        clock: returns the time in s.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._counts: dict[str, tuple[float, float]] = {}
        self._waiting: dict[str, int] = {}

    def count(self, address: str) -> float:
        """Count a wrong key, and return the seconds after which it is answered."""
        net, now = network(address), self._clock()
        before, at = self._counts.get(net, (0.0, now))
        before *= 0.5 ** ((now - at) / _HALF)
        self._counts[net] = (before + 1, now)
        if len(self._counts) > _ADDRESSES:
            oldest = sorted(self._counts, key=lambda name: self._counts[name][1])
            for name in oldest[: _ADDRESSES // 2]:
                del self._counts[name]
        return 0.0 if before < 0.5 else min(_LONGEST, _FIRST * 2 ** min(before - 1, 10))

    def wait(self, address: str) -> bool:
        """Let one more answer to an address wait; return False if too many do."""
        net = network(address)
        if self._waiting.get(net, 0) >= _WAITING:
            return False
        self._waiting[net] = self._waiting.get(net, 0) + 1
        return True

    def answered(self, address: str) -> None:
        """Let one answer to an address wait no longer."""
        net = network(address)
        self._waiting[net] -= 1
        if not self._waiting[net]:
            del self._waiting[net]


def network(address: str) -> str:
    """Return an address, or for IPv6 its network of 64 bits, in which one machine may choose addresses freely."""
    try:
        number = ip_address(address.partition("%")[0])
    except ValueError:
        return address
    if isinstance(number, IPv6Address):
        return str(number.ipv4_mapped or IPv6Address(int(number) >> 64 << 64))
    return address
