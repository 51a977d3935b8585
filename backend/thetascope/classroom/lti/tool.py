"""This service as a tool of learning platforms: logins, launches, and the rooms and gradebooks they lead to."""

import asyncio
import hmac
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from secrets import token_urlsafe
from time import monotonic
from typing import Any
from urllib.parse import urlencode, urlsplit

from joserfc.jwk import KeySet, RSAKey

from thetascope.classroom.lti.id_token import Launch, PlatformKeys, launch_of, verified
from thetascope.classroom.lti.launched_rooms import LaunchedRooms
from thetascope.classroom.lti.one_use import OneUse
from thetascope.classroom.lti.registry import Platform, Registry, read_registry
from thetascope.classroom.lti.scores import Gradebooks, Score
from thetascope.classroom.lti.tool_key import tool_key
from thetascope.classroom.people.codes import digest
from thetascope.classroom.rooms import Rooms
from thetascope.messages import Message
from thetascope.runs.specs.refusals import Unknown, invalid
from thetascope.settings import Settings

_AGAIN = Message("lti.repeat")
_COMPARE = Message("lti.compare")
_THREADS = 8
"""Launches that are verified at the same time: each may wait for the keys of its platform."""


@dataclass(frozen=True)
class Login:
    """A login that has begun: with which platform, for which browser, and where it is to end."""

    platform: Platform
    browser: bytes
    nonce: str
    target: str


def prepared(settings: Settings) -> tuple[Registry, RSAKey]:
    """Return the registered platforms and the key of this service. Raises SettingsError."""
    return read_registry(Path(settings.lti).expanduser()), tool_key(settings.data)


class Tool:
    """The tool; its methods are called on the event loop. Raises SettingsError."""

    def __init__(self, settings: Settings, rooms: Rooms) -> None:
        self._registry, self._key = prepared(settings)
        self._all, self._threads = rooms, ThreadPoolExecutor(_THREADS, "launch")
        self._keys = PlatformKeys()
        self._logins: OneUse[Login] = OneUse(monotonic)
        self._launches: OneUse[tuple[bytes, Launch]] = OneUse(monotonic)
        self._gradebooks = Gradebooks(self._key)
        self.rooms = LaunchedRooms(rooms, self._send)

    def public_keys(self) -> dict[str, Any]:
        """Return the key set with which platforms verify what this service signs."""
        return dict(KeySet([self._key]).as_dict(private=False))

    def begin(self, asked: dict[str, str], browser: str, target: str) -> str:
        """Begin a login; return the address of the platform to which the browser goes. Raises InvalidSpec.

        Args:
            asked: the parameters of the platform's request.
            browser: the secret in the browser's cookie.
            target: the address of this service's launch.
        """
        platform = self._registry.find(asked.get("iss", ""), asked.get("client_id", ""))
        if platform is None:
            raise invalid("iss", asked.get("iss"), Message("lti.platform"), _COMPARE)
        deployment = asked.get("lti_deployment_id")
        if deployment is not None and deployment not in platform.deployments:
            raise invalid("lti_deployment_id", deployment, Message("lti.claim.other"), _COMPARE)
        if asked.get("target_link_uri") != target:
            raise invalid(
                "target_link_uri", asked.get("target_link_uri"), Message("lti.target", wanted=target), _COMPARE
            )
        if not asked.get("login_hint"):
            raise invalid("login_hint", None, Message("lti.claim.missing"), _COMPARE)
        nonce = token_urlsafe(24)
        state = self._logins.put(Login(platform, digest(browser), nonce, target))
        query = {
            "scope": "openid",
            "response_type": "id_token",
            "response_mode": "form_post",
            "prompt": "none",
            "client_id": platform.client_id,
            "redirect_uri": target,
            "login_hint": asked["login_hint"],
            "state": state,
            "nonce": nonce,
        }
        if hint := asked.get("lti_message_hint"):
            query["lti_message_hint"] = hint
        between = "&" if urlsplit(platform.login_url).query else "?"
        return f"{platform.login_url}{between}{urlencode(query)}"

    async def launch(self, state: str, token: str, browser: str) -> tuple[Launch, str]:
        """Return who comes with a launch, and the secret with which the page claims it. Raises InvalidSpec, Busy.

        The state is taken whatever comes of it, so that no token can be tried twice.
        """
        login = self._logins.take(state)
        if login is None:
            raise invalid("state", state[:60], Message("lti.state"), _AGAIN)
        if not hmac.compare_digest(login.browser, digest(browser)):
            raise invalid("state", state[:60], Message("lti.browser"), _AGAIN)
        claims = await asyncio.get_running_loop().run_in_executor(
            self._threads, verified, token, login.platform, self._keys
        )
        launch = launch_of(claims, login.platform, login.nonce, login.target)
        return launch, self._launches.put((login.browser, launch))

    def claimed(self, secret: str, browser: str, teaches: bool) -> Launch:
        """Return a launch on its way to its page, and keep it no longer. Raises Unknown.

        It is that of the browser that was launched. That of a student whose room is not open yet is kept, so that the
        page can try again.
        """
        owner, launch = self._launches.look(secret) or (b"", None)
        if launch is None or launch.teaches != teaches or not hmac.compare_digest(owner, digest(browser)):
            raise Unknown(Message("lti.launch"))
        if teaches or self.rooms.is_open(launch):
            self._launches.take(secret)
        return launch

    def stop(self) -> None:
        """Send nothing more."""
        self._all.follower = None
        self._gradebooks.stop()
        self._threads.shutdown(wait=False, cancel_futures=True)

    def _send(self, score: Score, done: Callable[[str], None]) -> None:
        loop = asyncio.get_running_loop()

        def came(why: str) -> None:
            if not loop.is_closed():
                loop.call_soon_threadsafe(done, why)

        self._gradebooks.send(score, came)
