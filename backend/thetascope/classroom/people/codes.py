"""Codes of rooms, and tokens."""

import secrets
from collections.abc import Collection
from hashlib import sha256

LETTERS = "ABCDEFGHJKMNPRSTWXYZ"
"""Letters of a code: without I, L, O, Q, U and V, which are taken for others on a projector."""
LENGTH = 6


def new_code(taken: Collection[str]) -> str:
    """Return a code that no room has."""
    while True:
        code = "".join(secrets.choice(LETTERS) for _ in range(LENGTH))
        if code not in taken:
            return code


def read_code(text: str) -> str | None:
    """Return a code as it was typed or scanned in its usual form; None for a text that is no code."""
    code = "".join(character for character in text.upper() if character not in " -\u2013\u00a0\t")
    return code if len(code) == LENGTH and all(letter in LETTERS for letter in code) else None


def new_token() -> str:
    """Return a token that cannot be guessed."""
    return secrets.token_urlsafe(24)


def digest(token: str) -> bytes:
    """Return the digest under which a token is looked up: the time of a look-up then tells nothing about tokens."""
    return sha256(token.encode("utf-8", "surrogatepass")).digest()
