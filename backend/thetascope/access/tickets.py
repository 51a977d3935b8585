"""Tickets: the value of the cookie of a browser that signed in.

    <id>.<end>.<signature of the id>.<signature of id, end and key>

The id is random and names the browser as the owner of its runs. The first signature holds for as long as the
installation's secret, the second until `end` and for the present key. So a browser that signs in again, after its
ticket has ended or after the key was changed, keeps its runs.
"""

import hmac
import re
import secrets
import time
from base64 import urlsafe_b64encode

from thetascope.access.key_file import Keys

LASTS = 30 * 86400.0
"""Seconds for which a browser is signed in."""
KEPT = 400 * 86400
"""Seconds for which a browser keeps its cookie, and with it its id; browsers allow no more."""
_FORM = re.compile(r"([A-Za-z0-9_-]{16})\.([0-9]{1,12})\.([A-Za-z0-9_-]{22})\.([A-Za-z0-9_-]{22})", re.ASCII)


def issue(keys: Keys, known: str | None = None, now: float | None = None) -> str:
    """Return a new ticket; `known` is the browser's earlier one, whose id is kept if it is this installation's."""
    id = (known and owner_id(keys, known)) or secrets.token_urlsafe(12)
    end = int((time.time() if now is None else now) + LASTS)
    return f"{id}.{end}.{_owner(keys, id)}.{_access(keys, id, end)}"


def owner_id(keys: Keys, ticket: str) -> str | None:
    """Return the id in a ticket of this installation, whether it still holds or not; None for anything else."""
    match = _FORM.fullmatch(ticket)
    return match[1] if match and hmac.compare_digest(match[3], _owner(keys, match[1])) else None


def holder(keys: Keys, ticket: str, now: float | None = None) -> str | None:
    """Return the id in a ticket that holds now; None for one that is forged, has ended or is of another key."""
    match = _FORM.fullmatch(ticket)
    if match is None or keys.digest is None or owner_id(keys, ticket) is None:
        return None
    id, end = match[1], int(match[2])
    signed = hmac.compare_digest(match[4], _access(keys, id, end))
    return id if signed and end > (time.time() if now is None else now) else None


def _owner(keys: Keys, id: str) -> str:
    return _text(keys.sign("owner", id))


def _access(keys: Keys, id: str, end: int) -> str:
    assert keys.digest is not None
    return _text(keys.sign("access", id, str(end), keys.digest.hex()))


def _text(signature: bytes) -> str:
    """Return the first 128 bits as text."""
    return urlsafe_b64encode(signature[:16]).decode().rstrip("=")
