"""Ids of sessions: random, and where sessions are spread over several processes, with the number of theirs in front."""

import re
import secrets

MOST = 64
"""Processes that there may be."""
_FORM = re.compile(r"p([0-9]{2})-[A-Za-z0-9_-]{16}", re.ASCII)


def new_id(process: int | None) -> str:
    """Return the id of a new session in this process; None: there is no other one."""
    random = secrets.token_urlsafe(12)
    return random if process is None else f"{prefix(process)}{random}"


def prefix(process: int) -> str:
    """Return how the ids of a process's sessions begin, by which a router knows where they live."""
    return f"p{process:02}-"


def process_of(id: str) -> int | None:
    """Return the process in an id; None if it names none."""
    match = _FORM.fullmatch(id)
    return int(match[1]) if match else None
