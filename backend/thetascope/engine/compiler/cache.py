"""Files that can be made again: compiled object code and lowered programs, by the hash of what they come from."""

import contextlib
import hashlib
import os
import tempfile
from functools import lru_cache
from pathlib import Path


@lru_cache(maxsize=1)
def folder() -> Path:
    """THETASCOPE_CACHE, else the user's cache folder."""
    named = os.environ.get("THETASCOPE_CACHE")
    return Path(named) if named else Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "thetascope"


def read(kind: str, key: str) -> bytes | None:
    """The bytes kept under a key, or None. A file that cannot be read, or was cut short, counts as absent."""
    try:
        content = (folder() / kind / key).read_bytes()
    except OSError:
        return None
    digest, body = content[:32], content[32:]
    return body if hashlib.sha256(body).digest() == digest else None


def write(kind: str, key: str, body: bytes) -> None:
    """Keep bytes under a key: whole or not at all, also with several writers. A full or read-only disk is no error."""
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
    """Hash of the files in a folder and below it, with their names."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob(pattern)):
        digest.update(path.relative_to(folder).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


@lru_cache(maxsize=1)
def package_digest() -> str:
    """Hash of the source of the whole engine: what other code has made is not found again."""
    return digest_of(Path(__file__).parents[1])
