"""The folder of the cache and the key of its files: machine code must come from this user of this installation.

The folder has mode 0700 and holds a secret key, a file with mode 0600. A folder in which others could replace files
is refused.
"""

import contextlib
import os
import secrets
import stat
import tempfile
from functools import lru_cache
from pathlib import Path

from thetascope.engine.errors import FolderRefused
from thetascope.messages import Message

_KEY_BYTES = 32
_ALONE = secrets.token_bytes(_KEY_BYTES)  # of this process, where none can be stored


def protect(folder: Path) -> None:
    """Create a folder for this user alone, or make it so. A disk that is full or cannot be written is not an error.

    Raises FolderRefused if the folder belongs to somebody else, or if others can write in it or replace it.
    """
    check(folder)
    with contextlib.suppress(OSError):
        for missing in reversed([place for place in folder.parents if not place.exists()]):
            missing.mkdir(mode=0o700, exist_ok=True)
        folder.mkdir(mode=0o700, exist_ok=True)
        check(folder)  # somebody may have created it in between
        if os.name == "posix" and stat.S_IMODE(folder.stat().st_mode) != 0o700:
            folder.chmod(0o700)


def check(folder: Path) -> None:
    """Raise FolderRefused if somebody else owns a folder or could write in it, or in a folder above it."""
    if os.name != "posix":
        return
    folder = folder.absolute()
    places = [folder, *folder.parents]
    resolved = folder.resolve()
    places += [place for place in (resolved, *resolved.parents) if place not in places]
    for place in places:
        try:
            status = place.lstat()
        except OSError:
            continue
        own = place in (folder, resolved)
        if status.st_uid not in ((os.geteuid(),) if own else (0, os.geteuid())):
            raise FolderRefused(Message("cache.foreign", folder=str(folder), place=str(place), owner=status.st_uid))
        if _others_write(status) and not (status.st_mode & stat.S_ISVTX and not own):
            raise FolderRefused(Message("cache.writable", folder=str(folder), place=str(place)))


def _others_write(status: os.stat_result) -> bool:
    """Return whether somebody else than the owner and root may write in a folder, by its mode."""
    if stat.S_ISLNK(status.st_mode):
        return False
    by_group = bool(status.st_mode & stat.S_IWGRP) and not _is_private(status.st_gid, status.st_uid)
    return by_group or bool(status.st_mode & stat.S_IWOTH)


def _is_private(group: int, user: int) -> bool:
    """Return whether a user is the only member of a group, as where every user has a group of its own."""
    import grp
    import pwd

    try:
        entry, name = grp.getgrgid(group), pwd.getpwuid(user).pw_name
    except KeyError:
        return False
    return entry.gr_name == name and set(entry.gr_mem) <= {name}


def key(folder: Path) -> bytes:
    """Return the secret key of a cache folder; it is created when it is lacking or others could have read it.

    Of several processes that create it at the same time, all get the same; they follow when the folder was deleted.
    Where it cannot be stored, the process has a key of its own.
    """
    try:
        status = (folder / "key").stat(follow_symlinks=False)
    except OSError:
        return _created(folder)
    known = _read(folder, status.st_ino, status.st_mtime_ns, status.st_mode, status.st_size)
    return known or _created(folder)


@lru_cache(maxsize=8)
def _read(folder: Path, *identity: int) -> bytes | None:
    """Return the stored key, read once while its file stays the same."""
    return _stored(folder / "key")


def _created(folder: Path) -> bytes:
    """Return a new key, or that of another process that created one meanwhile."""
    place = folder / "key"
    exists = os.path.lexists(place)
    known = _stored(place)
    if known is not None:
        return known
    fresh = secrets.token_bytes(_KEY_BYTES)
    try:
        handle, name = tempfile.mkstemp(dir=folder)  # with mode 0600
    except OSError:
        return _ALONE
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(fresh)
        if exists:  # and cannot be used
            with contextlib.suppress(OSError):
                place.unlink()
        os.link(name, place)
    except FileExistsError:
        return _stored(place) or fresh
    except OSError:  # a file system without links
        with contextlib.suppress(OSError):
            os.replace(name, place)
    finally:
        with contextlib.suppress(OSError):
            os.unlink(name)
    return _stored(place) or fresh


def _stored(place: Path) -> bytes | None:
    """Return a stored key that only this user can read."""
    try:
        handle = os.open(place, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
        with os.fdopen(handle, "rb") as file:
            status = os.fstat(file.fileno())
            content = file.read(_KEY_BYTES + 1)
    except OSError:
        return None
    private = os.name != "posix" or (status.st_uid == os.geteuid() and not status.st_mode & 0o077)
    return content if private and stat.S_ISREG(status.st_mode) and len(content) == _KEY_BYTES else None
