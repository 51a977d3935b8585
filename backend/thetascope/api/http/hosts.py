"""Decide by which names this service may be addressed, and which pages may change something.

A page of another site can give its own host name the address 127.0.0.1 after it was loaded ("DNS rebinding"). For the
browser that page and this service are then one site. Such requests carry the other site's name in `Host`.
"""

import re
from ipaddress import ip_address
from urllib.parse import urlsplit

from starlette.datastructures import Headers

from thetascope.messages import Message
from thetascope.settings import SettingsError

ANY = "*"


def origins_of(setting: str) -> frozenset[str]:
    """Return the origins of the setting `origins`, separated by commas, each exact as `https://lab.example.org:8443`.

    Raises SettingsError for anything else: a wildcard, a path, or `null`, which the sandboxed pages of all sites send.
    """
    names = [name.strip().rstrip("/").lower() for name in setting.split(",") if name.strip()]
    for name in names:
        scheme, _, host = name.partition("://")
        if scheme not in ("http", "https") or name_of(host) is None:
            raise SettingsError(Message("settings.no-origin", value=name[:100]))
    return frozenset(_without_default_port(name) for name in names)


def _without_default_port(origin: str) -> str:
    """Return an origin as browsers send it."""
    scheme, _, host = origin.partition("://")
    port = ":443" if scheme == "https" else ":80"
    return f"{scheme}://{host.removesuffix(port)}"


class AllowedHosts:
    """The host names of this service: loopback names, addresses as numbers, the one it listens on, and the setting's.

    An address as numbers cannot be rebound: no name server is asked for it.
    """

    def __init__(self, setting: str = "", own: str = "", origins: str = "") -> None:
        """Take the texts of two settings and the name on which the service listens.

        The setting has names separated by commas; `*.example.org` includes all names below it. `origins` are pages of
        other sites that may use the service. Raises SettingsError.
        """
        self._origins = origins_of(origins)
        self._own = own.lower()
        self._names = [name.strip().lower() for name in setting.split(",") if name.strip()]

    def allows(self, host: str) -> bool:
        """Return whether the value of a `Host` header, with or without a port, names this service."""
        name = name_of(host)
        return name is not None and (
            _is_address(name) or name in ("localhost", self._own) or name.endswith(".localhost") or self._lists(name)
        )

    @property
    def lists_origins(self) -> bool:
        """Return whether answers depend on the origin of the page that asks."""
        return bool(self._origins)

    def other_site(self, headers: Headers) -> str | None:
        """Return the origin of a request from a page of another site that the setting lists; None for all others."""
        origin = headers.get("origin")
        return origin if origin is not None and origin in self._origins else None

    def may_change(self, headers: Headers) -> bool:
        """Return whether a request may change something: it comes from a page of this service or of a listed
        origin, or from no page.

        The scheme is not compared: behind a proxy that ends TLS, the page's is https and the service's is http. A proxy
        may also replace `Host`; a page of a name in the setting is then accepted.
        """
        origin = headers.get("origin")
        if self.other_site(headers) is not None:
            return True
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
