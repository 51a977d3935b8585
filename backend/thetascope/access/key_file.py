"""The access key of an installation: a file in the data folder that only its owner may read.

The file holds a secret, which signs tickets, and a digest of the key. The key itself is shown once and not stored. It
is random and has 192 bits, so nobody can find it from a fast digest. A key that a person chooses is in the environment
(`THETASCOPE_KEY`), and never in a file.
"""

import hmac
import json
import logging
import os
import secrets
import stat
import string
import time
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from thetascope.messages import Message
from thetascope.messages.explained import Explained
from thetascope.settings import SettingsError

log = logging.getLogger(__name__)

SHORTEST = 16
"""Characters of the shortest key that a person may choose: guesses are slowed down, but never locked out."""
_ALLOWED = set(string.ascii_letters + string.digits + string.punctuation)
_BYTES = 24


class KeyFileError(Explained, SettingsError):
    """The file of the access key cannot be used."""


@dataclass(frozen=True)
class Keys:
    """The secret of an installation, the digest of its access key (None: no key exists), and the key's Unix time."""

    secret: bytes
    digest: bytes | None
    created: float = 0.0

    def digest_of(self, key: str) -> bytes:
        """Return the digest under which a key is stored."""
        return self.sign("key", key)

    def sign(self, *parts: str) -> bytes:
        """Return the signature of texts under the installation's secret, 32 bytes."""
        return hmac.digest(self.secret, "\0".join(parts).encode(), "sha256")

    @property
    def installation(self) -> str:
        """Return a short public name of the installation, for its cookie: two services on one host do not collide."""
        return sha256(b"installation" + self.secret).hexdigest()[:8]


class KeyFile:
    """Reads the keys when they are needed, and again after another process has changed them.

    Args:
        path: where the keys are, or will be.
        chosen: the key that the environment sets, or "".

    Raises:
        SettingsError: the chosen key is short, or has characters that a header cannot carry.
    """

    def __init__(self, path: Path, chosen: str = "") -> None:
        if chosen and (len(chosen) < SHORTEST or not set(chosen) <= _ALLOWED):
            raise SettingsError(Message("access.key.unsuitable", least=SHORTEST))
        self.path, self._chosen = path, chosen
        self._read: tuple[tuple[int, ...], Keys] | None = None

    @property
    def is_chosen(self) -> bool:
        """Return whether the environment sets the key."""
        return bool(self._chosen)

    def current(self) -> Keys | None:
        """Return the keys now; None if the installation has none. Raises KeyFileError."""
        try:
            status = os.stat(self.path)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise self._error(error) from error
        mark = (status.st_ino, status.st_mtime_ns, status.st_size)
        if self._read is None or self._read[0] != mark:
            self._read = mark, self._load(status.st_mode)
        return self._read[1]

    def ensured(self) -> tuple[Keys, str | None]:
        """Return the keys, and the access key if it was created now. Raises KeyFileError."""
        keys = self.current()
        if keys is None or keys.digest is None:
            return self._stored(None if self._chosen else secrets.token_urlsafe(_BYTES))
        return keys, None

    def renew(self) -> str:
        """Create another access key and return it; everybody is signed out. Raises SettingsError."""
        if self._chosen:
            raise SettingsError(Message("access.key.chosen"))
        key = secrets.token_urlsafe(_BYTES)
        self._stored(key)
        return key

    def _stored(self, key: str | None) -> tuple[Keys, str | None]:
        """Store keys with the installation's secret, a new one if it has none."""
        known = self.current()
        keys = Keys(known.secret if known else secrets.token_bytes(32), None, time.time())
        data = {"secret": keys.secret.hex(), "created": keys.created}
        if key is not None:
            data["key"] = keys.digest_of(key).hex()
        try:
            self._write(json.dumps(data))
        except OSError as error:
            raise self._error(error) from error
        self._read = None
        stored = self.current()
        assert stored is not None
        return stored, key

    def _write(self, text: str) -> None:
        """Replace the file by one that only its owner may read; a crash leaves the old or the new one."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        temporary = self.path.with_name(f"{self.path.name}.{secrets.token_hex(8)}")
        handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        try:
            with os.fdopen(handle, "w", encoding="ascii") as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
            os.replace(temporary, self.path)
        except BaseException:
            temporary.unlink(missing_ok=True)
            raise

    def _load(self, mode: int) -> Keys:
        try:
            if os.name == "posix" and stat.S_IMODE(mode) & 0o077:
                os.chmod(self.path, 0o600)
                log.warning("%s could be read by others; it is now for its owner only", self.path)
            data = json.loads(self.path.read_text(encoding="ascii"))
            keys = Keys(bytes.fromhex(data["secret"]), None, float(data["created"]))
            digest = bytes.fromhex(data["key"]) if "key" in data else None
        except OSError as error:
            raise self._error(error) from error
        except (ValueError, KeyError, TypeError) as error:
            raise KeyFileError(Message("access.file.damaged", path=str(self.path))) from error
        if len(keys.secret) < 32 or (digest is not None and len(digest) != 32):
            raise KeyFileError(Message("access.file.damaged", path=str(self.path)))
        if self._chosen:
            digest = keys.digest_of(self._chosen)
        return Keys(keys.secret, digest, keys.created)

    def _error(self, error: OSError) -> KeyFileError:
        return KeyFileError(Message("access.file.unusable", path=str(self.path), detail=error.strerror or str(error)))
