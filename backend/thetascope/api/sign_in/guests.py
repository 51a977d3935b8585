"""Addresses that students of a classroom reach without the access key.

They get the page for joining, its files and words, and the seats of classrooms, each of which its own token opens.
Nothing there starts a computation, reads a file, or shows a run.
"""

from thetascope.access.principal import Principal

_PAGE = "/join"
_FILES = ("/join/", "/static/", "/api/messages/")
_SEATS = ("/api/classroom/join", "/api/classroom/seat")
_LAUNCHES = {
    "/api/classroom/lti/login",
    "/api/classroom/lti/launch",
    "/api/classroom/lti/keys",
    "/api/classroom/lti/seat",
}
"""Where learning platforms send their users, and where these claim their place. A teacher's room needs the key."""
MOST_SOCKETS = 600
"""Websockets of students from one address: a school may have one address for all."""


def is_for_guests(method: str, path: str) -> bool:
    """Return whether a request needs no key; `method` is WEBSOCKET for a websocket."""
    if path in _SEATS or path in _LAUNCHES or path.startswith(f"{_SEATS[1]}/"):
        return True
    return method in ("GET", "HEAD") and (path == _PAGE or path.startswith(_FILES))


def guest(address: str) -> Principal:
    """Return for whom such a request acts: nobody who owns anything."""
    return Principal(f"student {address}", "student")
