"""The registered platforms: a JSON file that the operator writes.

{"platforms": [{
    "issuer": "https://moodle.example.org",
    "client_id": "aB3x",
    "deployments": ["1"],
    "login_url": "https://moodle.example.org/mod/lti/auth.php",
    "token_url": "https://moodle.example.org/mod/lti/token.php",
    "keys_url": "https://moodle.example.org/mod/lti/certs.php"}]}
"""

import json
from pathlib import Path
from typing import Annotated, Any
from urllib.parse import urlsplit

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, model_validator

from thetascope.access.gate import is_loopback
from thetascope.messages import Message
from thetascope.settings import SettingsError

_LARGEST = 256 * 1024


def origin_of(address: str) -> str:
    """Return scheme, name and port of an address. Raises ValueError for one that is not to be trusted.

    It is https, or http to this machine itself; a name and a password before the host would hide where it leads.
    """
    parts = urlsplit(address)
    host = parts.hostname or ""
    plain = all("!" <= character <= "~" and character != "\\" for character in address)
    if not plain or not host or parts.username is not None or parts.password is not None:
        raise ValueError("not a plain address")
    if parts.scheme != "https" and not (parts.scheme == "http" and is_loopback(host)):
        raise ValueError("not https")
    port = parts.port or (443 if parts.scheme == "https" else 80)
    return f"{parts.scheme}://{host}:{port}"


def _checked(address: str) -> str:
    origin_of(address)
    return address


Address = Annotated[str, Field(max_length=2000), AfterValidator(_checked)]
Name = Annotated[str, Field(min_length=1, max_length=255)]


class Platform(BaseModel):
    """A registered platform. `keys` are its public keys where they have no address; `scores` are beginnings of the
    addresses of its gradebook, by default the origin of `token_url`."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    issuer: Name
    client_id: Name
    deployments: tuple[Name, ...] = Field(min_length=1, max_length=1000)
    login_url: Address
    token_url: Address
    token_audience: Name | None = None
    keys_url: Address | None = None
    keys: dict[str, Any] | None = None
    scores: tuple[Address, ...] = ()

    @model_validator(mode="after")
    def _has_keys(self) -> "Platform":
        if (self.keys_url is None) == (self.keys is None):
            raise ValueError("one of keys_url and keys is needed")
        return self

    def may_score_at(self, address: str) -> bool:
        """Return whether an address belongs to the platform's gradebook as it is registered."""
        try:
            origin, path = origin_of(address), urlsplit(address).path
        except ValueError:
            return False
        if "/.." in path or "%2e" in path.lower():
            return False
        begins = self.scores or (origin_of(self.token_url),)
        return any(origin == origin_of(one) and path.startswith(urlsplit(one).path) for one in begins)


class Registry(BaseModel):
    """All registered platforms."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    platforms: tuple[Platform, ...] = Field(min_length=1, max_length=200)

    def find(self, issuer: str, client_id: str) -> Platform | None:
        """Return a platform; without a client id, the only one of the issuer."""
        found = [one for one in self.platforms if one.issuer == issuer and client_id in ("", one.client_id)]
        return found[0] if len(found) == 1 else None


def read_registry(path: Path) -> Registry:
    """Return the platforms in a file. Raises SettingsError."""
    try:
        with path.open("rb") as file:
            text = file.read(_LARGEST + 1)
        if len(text) > _LARGEST:
            raise ValueError("too large")
        return Registry.model_validate(json.loads(text))
    except OSError as error:
        detail = error.strerror or str(error)
    except ValidationError as error:
        first = error.errors()[0]
        detail = f"{'.'.join(str(part) for part in first['loc'])}: {first['msg']}"
    except (ValueError, RecursionError) as error:
        detail = str(error)
    raise SettingsError(Message("lti.file", path=str(path), detail=detail))
