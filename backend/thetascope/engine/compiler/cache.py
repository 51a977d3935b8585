"""Disk cache of object code and lowered programs, by the hash of their source. It may be deleted at any time.

Object code is executed, and programs become code: a file is only read if it carries the key of this installation.
"""

import contextlib
import hashlib
import hmac
import os
import tempfile
import threading
from functools import lru_cache
from pathlib import Path
from weakref import WeakValueDictionary

from thetascope.engine.compiler.cache_folder import key as secret
from thetascope.engine.compiler.cache_folder import protect

_lock = threading.Lock()
_locks: "WeakValueDictionary[str, threading.RLock]" = WeakValueDictionary()


@lru_cache(maxsize=1)
def folder() -> Path:
    """Return the cache folder: THETASCOPE_CACHE, else `thetascope` in the user's cache folder.

    Raises FolderRefused if somebody else could write in it.
    """
    named = os.environ.get("THETASCOPE_CACHE")
    base = Path(named) if named else Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "thetascope"
    protect(base)
    return base


def lock(key: str) -> threading.RLock:
    """Return the lock of a key, held while its value is made: others wait for that value, and for no other."""
    with _lock:
        return _locks.setdefault(key, threading.RLock())


def read(kind: str, key: str) -> bytes | None:
    """Return the bytes stored under a key, or None.

    A file that is damaged, or that was not written under this key by this installation, counts as absent.
    """
    place = folder()
    try:
        content = (place / kind / key).read_bytes()
    except OSError:
        return None
    body = memoryview(content)[32:]
    return bytes(body) if hmac.compare_digest(_seal(place, kind, key, body), content[:32]) else None


def write(kind: str, key: str, body: bytes) -> None:
    """Store bytes under a key, atomically even with concurrent writers. A full or read-only disk is not an error."""
    base = folder()
    place = base / kind
    with contextlib.suppress(OSError):
        if not place.is_dir():
            protect(base)
            place.mkdir(mode=0o700, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=place)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(_seal(base, kind, key, body) + body)
            os.replace(name, place / key)
        except OSError:
            with contextlib.suppress(OSError):
                os.unlink(name)


def _seal(place: Path, kind: str, key: str, body: bytes | memoryview) -> bytes:
    """Return the code that authenticates a file: HMAC-SHA-256 of its kind, key and content (RFC 2104)."""
    code = hmac.new(secret(place), f"{kind}\0{key}\0".encode(), "sha256")
    code.update(body)
    return code.digest()


def digest_of(folder: Path, pattern: str = "*.py") -> str:
    """Return the SHA-256 of all files below a folder and their names, as hexadecimal digits."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob(pattern)):
        digest.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


@lru_cache(maxsize=1)
def package_digest() -> str:
    """Return the hash of the engine's source. As part of every key it invalidates the cache when the code changes."""
    return digest_of(Path(__file__).parents[1])
