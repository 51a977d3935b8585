"""Disk cache of object code and lowered programs, by the hash of their source. It may be deleted at any time."""

import contextlib
import hashlib
import os
import tempfile
import threading
from functools import lru_cache
from pathlib import Path
from weakref import WeakValueDictionary

_lock = threading.Lock()
_locks: "WeakValueDictionary[str, threading.RLock]" = WeakValueDictionary()


@lru_cache(maxsize=1)
def folder() -> Path:
    """Return the cache folder: THETASCOPE_CACHE, else `thetascope` in the user's cache folder."""
    named = os.environ.get("THETASCOPE_CACHE")
    return Path(named) if named else Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "thetascope"


def lock(key: str) -> threading.RLock:
    """Return the lock of a key, held while its value is made: others wait for that value, and for no other."""
    with _lock:
        return _locks.setdefault(key, threading.RLock())


def read(kind: str, key: str) -> bytes | None:
    """Return the bytes stored under a key, or None. An unreadable or damaged file counts as absent."""
    try:
        content = (folder() / kind / key).read_bytes()
    except OSError:
        return None
    digest, body = content[:32], content[32:]
    return body if hashlib.sha256(body).digest() == digest else None


def write(kind: str, key: str, body: bytes) -> None:
    """Store bytes under a key, atomically even with concurrent writers. A full or read-only disk is not an error."""
    place = folder() / kind
    with contextlib.suppress(OSError):
        place.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=place)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(hashlib.sha256(body).digest() + body)
            os.replace(name, place / key)
        except OSError:
            with contextlib.suppress(OSError):
                os.unlink(name)


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
