"""Read from a request the key, the tickets, and from where it comes."""

from base64 import urlsafe_b64decode

from starlette.datastructures import Headers
from starlette.requests import HTTPConnection

from thetascope.access.gate import Presented, is_loopback
from thetascope.api.http.hosts import name_of
from thetascope_schemas.service.session import KEY

KEY_HEADER = "X-Access-Key"
NAME_HEADER = "X-Client"
# No browser speaks HTTP/1.0; nginx does to the service behind it, and by default adds none of these headers.
_PROXIES = ("forwarded", "via", "x-forwarded-for", "x-forwarded-host", "x-forwarded-proto", "x-real-ip")


def presented(connection: HTTPConnection) -> Presented:
    """Return what a request or websocket shows."""
    headers = connection.headers
    return Presented(
        address=connection.client.host if connection.client else "",
        loopback_name=is_loopback(name_of(headers.get("host", "")) or ""),
        proxied=any(name in headers for name in _PROXIES) or connection.scope.get("http_version") == "1.0",
        keys=(*keys_in(headers), *_offered(connection)),
        tickets=_cookies(headers),
        script=headers.get(NAME_HEADER, "").strip(),
    )


def keys_in(headers: Headers) -> tuple[str, ...]:
    """Return the keys in `Authorization: Bearer …` and in X-Access-Key."""
    scheme, _, bearer = headers.get("authorization", "").partition(" ")
    given = (bearer if scheme.lower() == "bearer" else "", headers.get(KEY_HEADER, ""))
    return tuple(key.strip() for key in given if key.strip())


def _offered(connection: HTTPConnection) -> tuple[str, ...]:
    """Return the keys in offered subprotocols: a page of another site can set no header of a websocket."""
    names = connection.scope.get("subprotocols", []) if connection.scope["type"] == "websocket" else []
    return tuple(_decoded(name.removeprefix(KEY)) for name in names if name.startswith(KEY))


def _decoded(text: str) -> str:
    try:
        return urlsafe_b64decode(text + "=" * (-len(text) % 4)).decode()
    except ValueError:  # a wrong key
        return text


def _cookies(headers: Headers) -> tuple[tuple[str, str], ...]:
    """Return the cookies by name, in their order; a name may occur twice."""
    pairs = (part.partition("=") for line in headers.getlist("cookie") for part in line[:8192].split(";"))
    return tuple((name.strip(), value.strip()) for name, _, value in pairs)


def is_https(connection: HTTPConnection) -> bool:
    """Return whether the browser reached the service over TLS, perhaps by a proxy that ends it."""
    forwarded = connection.headers.get("x-forwarded-proto", "").split(",")[0].strip().lower()
    return connection.scope["scheme"] in ("https", "wss") or forwarded == "https"
