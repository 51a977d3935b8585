"""Requests to a platform: to registered addresses only, so no redirect is followed. Answers are small and come soon."""

import json
import time
from http.client import HTTPException, HTTPMessage
from typing import IO, Any
from urllib.error import HTTPError
from urllib.request import HTTPRedirectHandler, Request, build_opener

SECONDS = 10.0
"""Seconds without a byte after which a request is given up; and twice that for all of it."""
_LARGEST = 256 * 1024


class NoAnswer(Exception):
    """A platform did not answer, or not with success.

    Args:
        why: in a few words, for the teacher.
        status: of HTTP; 0: there was no answer.
    """

    def __init__(self, why: str, status: int = 0) -> None:
        super().__init__(why)
        self.why, self.status = why, status

    @property
    def passes(self) -> bool:
        """Return whether another try may succeed."""
        return self.status in (0, 401, 408, 425, 429) or self.status >= 500


class _NoRedirect(HTTPRedirectHandler):
    def redirect_request(
        self, req: Request, fp: IO[bytes], code: int, msg: str, headers: HTTPMessage, newurl: str
    ) -> None:
        """Follow no redirect."""
        return


_OPENER = build_opener(_NoRedirect)


def ask(address: str, body: bytes | None = None, headers: dict[str, str] | None = None) -> bytes:
    """Return the answer of a GET, or of a POST with a body. Raises NoAnswer."""
    request = Request(address, body, {"Accept": "application/json"} | (headers or {}))
    end = time.monotonic() + 2 * SECONDS
    try:
        with _OPENER.open(request, timeout=SECONDS) as answer:
            content = bytearray()
            while part := answer.read1(64 * 1024):
                content += part
                if len(content) > _LARGEST:
                    raise NoAnswer("answer too large", 413)
                if time.monotonic() > end:
                    raise NoAnswer("answer too slow")
            return bytes(content)
    except HTTPError as error:
        error.close()
        raise NoAnswer(f"HTTP {error.code}", error.code) from None
    except (OSError, HTTPException, ValueError) as error:
        raise NoAnswer("no connection") from error


def ask_json(address: str, body: bytes | None = None, headers: dict[str, str] | None = None) -> dict[str, Any]:
    """Return the JSON object of an answer. Raises NoAnswer."""
    try:
        data = json.loads(ask(address, body, headers))
    except (ValueError, RecursionError) as error:
        raise NoAnswer("answer is not JSON", 422) from error
    if not isinstance(data, dict):
        raise NoAnswer("answer is not a JSON object", 422)
    return data
