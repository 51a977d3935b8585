"""A lock beside a file of the store. It ends with the process that holds it, however that ends."""

import os
import socket
import sys
from contextlib import suppress
from pathlib import Path


def identity() -> str:
    """Return the name of this process for people."""
    return f"process {os.getpid()} on {socket.gethostname()}"


class OwnerFile:
    """The file `<store>.owner`, locked by the owner, with its name as content. The file itself stays."""

    def __init__(self, store: Path) -> None:
        self._path = store.with_name(store.name + ".owner")
        self._handle: int | None = None

    def take(self) -> str | None:
        """Take the lock and return None, or return the name of the process that has it. Raises OSError."""
        if self._handle is not None:
            return None
        handle = os.open(self._path, os.O_RDWR | os.O_CREAT, 0o600)  # not inherited by other programs
        try:
            if not _locked(handle):
                name = os.read(handle, 200).decode("utf-8", "replace").strip()
                os.close(handle)
                return name or "another process"
        except OSError:
            os.close(handle)
            raise
        self._handle = handle
        with suppress(OSError):  # a full disk: the owner is nameless
            os.ftruncate(handle, 0)
            os.write(handle, identity().encode())
        return None

    def release(self) -> None:
        """Give the lock back."""
        if self._handle is not None:
            os.close(self._handle)
            self._handle = None


def _locked(handle: int) -> bool:
    """Lock an open file; return whether it is locked now. Raises OSError where files cannot be locked."""
    try:
        if sys.platform == "win32":
            import msvcrt

            os.lseek(handle, 1000, os.SEEK_SET)  # behind the text, which others read
            msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
            os.lseek(handle, 0, os.SEEK_SET)
        else:
            import fcntl

            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        if sys.platform == "win32":
            os.lseek(handle, 0, os.SEEK_SET)
        return False
    return True
