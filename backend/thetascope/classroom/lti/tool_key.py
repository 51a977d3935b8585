"""The key with which this service signs what it asks of a platform; made once, and kept in the data folder."""

import json
import os
import secrets
from contextlib import suppress
from pathlib import Path

from joserfc.jwk import RSAKey

from thetascope.messages import Message
from thetascope.settings import SettingsError

FILE = "lti-key.json"
ALGORITHM = "RS256"
_BITS = 2048


def tool_key(folder: Path) -> RSAKey:
    """Return the key in a folder; it is made if there is none. Only its owner may read it. Raises SettingsError."""
    path = folder / FILE
    try:
        if not path.exists():
            folder.mkdir(parents=True, exist_ok=True)
            _create(path)
        if os.name == "posix":
            path.chmod(0o600)
        key = RSAKey.import_key(json.loads(path.read_text(encoding="ascii")))
        if not key.is_private:
            raise ValueError("not a private key")
        return key
    except OSError as error:
        detail = error.strerror or str(error)
    except Exception as error:  # whatever is wrong with the text: the libraries below raise several kinds
        detail = str(error)
    raise SettingsError(Message("lti.key", path=str(path), detail=detail))


def _create(path: Path) -> None:
    """Write a new key. Another process may do the same at this moment: then the first one's is kept."""
    key = RSAKey.generate_key(_BITS, {"use": "sig", "alg": ALGORITHM}, private=True, auto_kid=True)
    temporary = path.with_name(f"{path.name}.{secrets.token_hex(8)}")
    handle = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    try:
        with os.fdopen(handle, "w", encoding="ascii") as file:
            json.dump(key.as_dict(private=True), file)
            file.flush()
            os.fsync(file.fileno())
        with suppress(FileExistsError):
            os.link(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
