"""Send points to the gradebook of a platform (Assignment and Grade Services). Everything here runs in threads."""

import json
import logging
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from datetime import UTC, datetime
from secrets import token_hex
from threading import Event, Lock
from urllib.parse import urlencode, urlsplit, urlunsplit

from joserfc import jwt
from joserfc.jwk import RSAKey

from thetascope.classroom.lti.id_token import MAY_SCORE
from thetascope.classroom.lti.outgoing import NoAnswer, ask, ask_json
from thetascope.classroom.lti.registry import Platform
from thetascope.classroom.lti.tool_key import ALGORITHM

log = logging.getLogger(__name__)

_PAUSES = (0.5, 2.0, 8.0)
"""Seconds before the second, third and fourth try."""
_THREADS = 4
_JWT_BEARER = "urn:ietf:params:oauth:client-assertion-type:jwt-bearer"
_KIND = "application/vnd.ims.lis.v1.score+json"


@dataclass(frozen=True)
class Score:
    """Points of a student in an activity."""

    platform: Platform
    column: str
    person: str
    points: float
    most: float


class Gradebooks:
    """Sends scores, each a bounded number of times."""

    def __init__(self, key: RSAKey) -> None:
        self._key = key
        self._threads = ThreadPoolExecutor(_THREADS, "gradebook")
        self._ended = Event()
        self._tokens: dict[tuple[str, str], tuple[float, str]] = {}
        self._locks: dict[tuple[str, str], Lock] = {}

    def send(self, score: Score, done: Callable[[str], None]) -> None:
        """Send a score in a thread, which calls `done` with "" or with what went wrong."""
        said = datetime.now(UTC).isoformat(timespec="milliseconds")
        self._threads.submit(lambda: done(self._sent(score, said)))

    def stop(self) -> None:
        """Send nothing more."""
        self._ended.set()
        self._threads.shutdown(wait=False, cancel_futures=True)

    def _sent(self, score: Score, said: str) -> str:
        for pause in (*_PAUSES, None):
            try:
                self._post(score, said)
                return ""
            except NoAnswer as error:
                if error.status == 401:
                    self._tokens.pop((score.platform.issuer, score.platform.client_id), None)
                if pause is None or not error.passes or self._ended.wait(pause):
                    log.warning("a gradebook of %s took no score: %s", score.platform.issuer, error.why)
                    return error.why
            except Exception:
                log.exception("a score could not be sent")
                return "internal error"
        return ""

    def _post(self, score: Score, said: str) -> None:
        body = {
            "userId": score.person,
            "scoreGiven": score.points,
            "scoreMaximum": score.most,
            "activityProgress": "Completed",
            "gradingProgress": "FullyGraded",
            "timestamp": said,
        }
        headers = {"Authorization": f"Bearer {self._token(score.platform)}", "Content-Type": _KIND}
        ask(scores_of(score.column), json.dumps(body).encode(), headers)

    def _token(self, platform: Platform) -> str:
        """Return a token of the platform for scores; it is asked for with an assertion that this service signs."""
        known = (platform.issuer, platform.client_id)
        with self._locks.setdefault(known, Lock()):
            end, token = self._tokens.get(known, (0.0, ""))
            if time.monotonic() < end:
                return token
            now = int(time.time())
            claims = {
                "iss": platform.client_id,
                "sub": platform.client_id,
                "aud": platform.token_audience or platform.token_url,
                "iat": now,
                "exp": now + 300,
                "jti": token_hex(16),
            }
            assertion = jwt.encode({"alg": ALGORITHM, "kid": self._key.kid}, claims, self._key)
            form = {
                "grant_type": "client_credentials",
                "client_assertion_type": _JWT_BEARER,
                "client_assertion": assertion,
                "scope": MAY_SCORE,
            }
            kind = {"Content-Type": "application/x-www-form-urlencoded"}
            answer = ask_json(platform.token_url, urlencode(form).encode(), kind)
            token, lasts = answer.get("access_token"), answer.get("expires_in", 0)
            if not isinstance(token, str) or not token or not all("!" <= character <= "~" for character in token):
                raise NoAnswer("no access token", 422)
            seconds = float(lasts) if isinstance(lasts, int | float) else 0.0
            end = time.monotonic() + min(3600.0, seconds) - 30.0
            self._tokens[known] = end, token
            return token


def scores_of(column: str) -> str:
    """Return where the scores of a column are posted; its address may have a query."""
    parts = urlsplit(column)
    return urlunsplit(parts._replace(path=parts.path.rstrip("/") + "/scores", fragment=""))
