"""Decide by which names this service may be addressed, and which pages may change something.

A page of another site can give its own host name the address 127.0.0.1 after it was loaded ("DNS rebinding"). For the
browser that page and this service are then one site. Such requests carry the other site's name in `Host`.
"""

import re
from ipaddress import ip_address
from urllib.parse import urlsplit

from starlette.datastructures import Headers

ANY = "*"


class AllowedHosts:
    """The host names of this service: loopback names, addresses as numbers, the one it listens on, and the setting's.

    An address as numbers cannot be rebound: no name server is asked for it.
    """

    def __init__(self, setting: str = "", own: str = "") -> None:
        """Take the text of the setting and the name on which the service listens.

        The setting has names separated by commas; `*.example.org` includes all names below it.
        """
        self._own = own.lower()
        self._names = [name.strip().lower() for name in setting.split(",") if name.strip()]

    def allows(self, host: str) -> bool:
        """Return whether the value of a `Host` header, with or without a port, names this service."""
        name = name_of(host)
        return name is not None and (
            _is_address(name) or name in ("localhost", self._own) or name.endswith(".localhost") or self._lists(name)
        )

    def may_change(self, headers: Headers) -> bool:
        """Return whether a request may change something: it comes from a page of this service, or from no page.

        The scheme is not compared: behind a proxy that ends TLS, the page's is https and the service's is http. A proxy
        may also replace `Host`; a page of a name in the setting is then accepted.
        """
        origin = headers.get("origin")
        if origin is None:
            return headers.get("sec-fetch-site", "none") in ("none", "same-origin")
        try:
            source = urlsplit(origin).netloc.lower()
        except ValueError:  # not an address
            return False
        name = name_of(source)
        return source != "" and (source == headers.get("host", "").lower() or (name is not None and self._lists(name)))

    def _lists(self, name: str) -> bool:
        """Return whether the setting has a name."""
        return any(
            entry in (ANY, name) or (entry.startswith("*.") and name.endswith(entry[1:])) for entry in self._names
        )


def name_of(host: str) -> str | None:
    """Return the host of `host[:port]` in lower case, without brackets and a final dot; None if it is not a host."""
    match = re.fullmatch(r"(\[[0-9a-f:.]+\]|[a-z0-9._-]+?)\.?(:\d{1,5})?", host.strip().lower())
    return match[1].strip("[]") if match else None


def _is_address(name: str) -> bool:
    try:
        ip_address(name)
    except ValueError:
        return False
    return True
