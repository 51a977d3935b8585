"""Believe what a platform says of a launch: its signature first, then every claim. A refusal names the claim."""

import json
import time
from base64 import urlsafe_b64decode
from dataclasses import dataclass
from threading import Lock
from typing import Any

from joserfc import jwt
from joserfc.errors import JoseError
from joserfc.jwk import KeySet

from thetascope.classroom.lti.outgoing import NoAnswer, ask_json
from thetascope.classroom.lti.registry import Platform
from thetascope.classroom.lti.tool_key import ALGORITHM
from thetascope.messages import Message
from thetascope.runs.specs.refusals import Busy, InvalidSpec, invalid

LONGEST = 32 * 1024
"""Characters of a token."""
_CLAIM = "https://purl.imsglobal.org/spec/lti/claim/"
SCORES = "https://purl.imsglobal.org/spec/lti-ags/claim/endpoint"
MAY_SCORE = "https://purl.imsglobal.org/spec/lti-ags/scope/score"
_MEMBERSHIP = "http://purl.imsglobal.org/vocab/lis/v2/membership"
_LEEWAY, _OLDEST = 60.0, 600.0
"""Seconds by which two clocks may differ, and after which a token is too old whatever it says itself."""
_KEPT, _AGAIN = 3600.0, 30.0
"""Seconds for which a platform's keys are kept, and after which they are asked for again where one is missing."""
_COMPARE = Message("lti.compare")
_REPEAT = Message("lti.repeat")


@dataclass(frozen=True)
class Resource:
    """An activity in a course of a platform."""

    issuer: str
    client_id: str
    deployment: str
    id: str


@dataclass(frozen=True)
class Launch:
    """Somebody who comes from a platform.

    Args:
        platform: from where.
        resource: the activity.
        teaches: whether the person is an instructor of the course.
        person: the platform's id of the person.
        name: the person's name, where the platform sends it and the teacher wants it.
        column: address of the activity's column in the gradebook; "": there is none.
    """

    platform: Platform
    resource: Resource
    teaches: bool
    person: str
    name: str = ""
    column: str = ""


class PlatformKeys:
    """The public keys of platforms, asked for when they are needed. Used by several threads."""

    def __init__(self) -> None:
        self._kept: dict[str, tuple[float, KeySet]] = {}
        self._locks: dict[str, Lock] = {}

    def of(self, platform: Platform, kid: str) -> KeySet:
        """Return the keys of a platform, asked for again if none has this id. Raises NoAnswer, JoseError."""
        if platform.keys_url is None:
            return _signing(platform.keys or {})
        with self._locks.setdefault(platform.keys_url, Lock()):
            at, keys = self._kept.get(platform.keys_url, (0.0, None))
            age = time.monotonic() - at
            known = keys is not None and any(key.kid == kid for key in keys)
            if keys is None or age > (_KEPT if known else _AGAIN):
                keys = _signing(ask_json(platform.keys_url))
                self._kept[platform.keys_url] = time.monotonic(), keys
            return keys


def _signing(data: dict[str, Any]) -> KeySet:
    """Return the keys of a set that can have signed a token: RSA, not for encryption."""
    listed = data.get("keys")
    entries = [one for one in listed if isinstance(one, dict)] if isinstance(listed, list) else []
    return KeySet.import_key_set(
        {"keys": [one for one in entries if one.get("kty") == "RSA" and one.get("use", "sig") == "sig"]}
    )


def verified(token: str, platform: Platform, keys: PlatformKeys) -> dict[str, Any]:
    """Return the claims of a token that a platform has signed. Raises InvalidSpec, Busy if its keys cannot be had."""
    if len(token) > LONGEST:
        raise invalid("id_token", f"{len(token)} characters", Message("lti.token.long", limit=LONGEST), _REPEAT)
    header = _header(token)
    if header.get("alg") != ALGORITHM:
        raise invalid("id_token.alg", header.get("alg"), Message("lti.token.algorithm", wanted=ALGORITHM), _COMPARE)
    kid = header.get("kid")
    if not isinstance(kid, str):
        raise invalid("id_token.kid", kid, Message("lti.claim.missing"), _COMPARE)
    try:
        return dict(jwt.decode(token, keys.of(platform, kid), [ALGORITHM]).claims)
    except NoAnswer as error:
        raise Busy(Message("lti.no-keys", why=error.why)) from error
    except (JoseError, ValueError, TypeError, KeyError, RecursionError) as error:
        raise invalid("id_token.signature", kid, Message("lti.token.signature"), _COMPARE) from error


def _header(token: str) -> dict[str, Any]:
    """Return the header of a token, of which nothing is believed yet."""
    try:
        text = token.split(".")[0]
        header = json.loads(urlsafe_b64decode(text + "=" * (-len(text) % 4)))
    except (ValueError, RecursionError):
        header = None
    if not isinstance(header, dict):
        raise invalid("id_token", token[:20], Message("lti.token.form"), _REPEAT)
    return header


def launch_of(claims: dict[str, Any], platform: Platform, nonce: str, target: str) -> Launch:
    """Return what verified claims say. Raises InvalidSpec that names a claim.

    Args:
        claims: of the token.
        platform: to which the login was sent.
        nonce: of the login.
        target: the address to which the platform was to send its user.
    """
    _who(claims, platform)
    _when(claims)
    if claims.get("nonce") != nonce:
        raise invalid("id_token.nonce", claims.get("nonce"), Message("lti.nonce"), _REPEAT)
    _same(claims, "message_type", "LtiResourceLinkRequest")
    _same(claims, "version", "1.3.0")
    deployment = _text(claims, f"{_CLAIM}deployment_id")
    if deployment not in platform.deployments:
        raise _other("deployment_id", deployment)
    if _text(claims, f"{_CLAIM}target_link_uri", 2000) != target:
        raise _other("target_link_uri", claims[f"{_CLAIM}target_link_uri"])
    link = claims.get(f"{_CLAIM}resource_link")
    id = _text(link if isinstance(link, dict) else {}, "id", field="resource_link.id")
    person = _text(claims, "sub")
    custom = claims.get(f"{_CLAIM}custom")
    named = isinstance(custom, dict) and custom.get("names") == "yes"
    name = claims.get("name") if named else ""
    return Launch(
        platform,
        Resource(platform.issuer, platform.client_id, deployment, id),
        _teaches(claims),
        person,
        name[:200] if isinstance(name, str) else "",
        _column(claims, platform),
    )


def _who(claims: dict[str, Any], platform: Platform) -> None:
    """Check from whom and for whom the token is."""
    if claims.get("iss") != platform.issuer:
        raise _other("iss", claims.get("iss"))
    audience = claims.get("aud")
    named = [audience] if isinstance(audience, str) else audience if isinstance(audience, list) else []
    if platform.client_id not in named:
        raise _other("aud", audience)
    party = claims.get("azp")
    if (party is not None or len(named) > 1) and party != platform.client_id:
        raise _other("azp", party)


def _when(claims: dict[str, Any]) -> None:
    """Check that the token holds now."""
    now = time.time()
    for name in ("exp", "iat"):
        value = claims.get(name)
        if not isinstance(value, int | float) or isinstance(value, bool):
            raise invalid(f"id_token.{name}", value, Message("lti.claim.missing"), _COMPARE)
    if not claims["exp"] > now - _LEEWAY:
        raise invalid("id_token.exp", claims["exp"], Message("lti.expired"), _REPEAT)
    if not now - _OLDEST < claims["iat"] < now + _LEEWAY:
        raise invalid("id_token.iat", claims["iat"], Message("lti.clock"), _REPEAT)


def _same(claims: dict[str, Any], name: str, wanted: str) -> None:
    value = claims.get(f"{_CLAIM}{name}")
    if value != wanted:
        raise invalid(f"id_token.{name}", value, Message("lti.claim.only", wanted=wanted), _COMPARE)


def _text(claims: dict[str, Any], name: str, most: int = 255, field: str = "") -> str:
    value = claims.get(name)
    if not isinstance(value, str) or not 0 < len(value) <= most:
        field = field or name.removeprefix(_CLAIM)
        raise invalid(f"id_token.{field}", value, Message("lti.claim.missing"), _COMPARE)
    return value


def _other(name: str, value: object) -> InvalidSpec:
    return invalid(f"id_token.{name}", value, Message("lti.claim.other"), _COMPARE)


def _teaches(claims: dict[str, Any]) -> bool:
    """Return whether somebody teaches the course, or learns in it."""
    listed = claims.get(f"{_CLAIM}roles")
    roles = [one for one in listed if isinstance(one, str)] if isinstance(listed, list) else []
    kinds = {
        one.removeprefix(_MEMBERSHIP).lstrip("#/").partition("#")[0]
        for one in roles
        if one.startswith((f"{_MEMBERSHIP}#", f"{_MEMBERSHIP}/"))
    }
    if not kinds & {"Instructor", "Learner"}:
        raise invalid("id_token.roles", ", ".join(roles)[:200], Message("lti.roles"), _COMPARE)
    return "Instructor" in kinds


def _column(claims: dict[str, Any], platform: Platform) -> str:
    """Return the address of the gradebook's column, if this service may write to it."""
    endpoint = claims.get(SCORES)
    scopes = endpoint.get("scope") if isinstance(endpoint, dict) else None
    if not isinstance(endpoint, dict) or not isinstance(scopes, list) or MAY_SCORE not in scopes:
        return ""
    column = endpoint.get("lineitem")
    if column is None:
        return ""
    if not isinstance(column, str) or len(column) > 2000 or not platform.may_score_at(column):
        raise _other("lineitem", column)
    return column
