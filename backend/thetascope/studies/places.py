"""Where a study's files lie: a folder of this machine, or any place that fsspec knows (`s3://bucket/folder`)."""

import os
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

from thetascope.messages import Message
from thetascope.runs.specs.refusals import Refusal


class Files(Protocol):
    """Small files by name, with one level of folders. A file that was written is whole, or not there."""

    def names(self, folder: str) -> list[str]:
        """Return the names of the files in a folder, sorted; empty where there is none."""
        ...

    def folders(self) -> list[str]:
        """Return the names of the folders, sorted."""
        ...

    def read(self, name: str) -> bytes:
        """Return a file. Raises OSError."""
        ...

    def write(self, name: str, data: bytes) -> None:
        """Write a file at once. Raises OSError."""
        ...

    def remove(self, name: str) -> None:
        """Remove a file that may be absent. Raises OSError."""
        ...


class LocalFiles:
    """A folder of this machine."""

    def __init__(self, root: Path) -> None:
        self.root = root

    def names(self, folder: str) -> list[str]:
        """Return the names of the files in a folder."""
        place = self.root / folder
        return sorted(p.name for p in place.iterdir() if p.is_file()) if place.is_dir() else []

    def folders(self) -> list[str]:
        """Return the names of the folders."""
        return sorted(p.name for p in self.root.iterdir() if p.is_dir()) if self.root.is_dir() else []

    def read(self, name: str) -> bytes:
        """Return a file."""
        return (self.root / name).read_bytes()

    def write(self, name: str, data: bytes) -> None:
        """Write a file beside its place and move it there, so that a kill leaves no half of it."""
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        draft = path.with_name(f".{path.name}.{os.getpid()}")
        try:
            with draft.open("wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            draft.replace(path)
        except BaseException:
            draft.unlink(missing_ok=True)
            raise

    def remove(self, name: str) -> None:
        """Remove a file."""
        (self.root / name).unlink(missing_ok=True)


class RemoteFiles:
    """A place that fsspec knows. An object store shows a file only when it is whole; others may show a part."""

    def __init__(self, url: str) -> None:
        try:
            core: Any = import_module("fsspec.core")
        except ModuleNotFoundError:
            raise Refusal(Message("study.fsspec", place=url)) from None
        try:
            self._files, self._root = core.url_to_fs(url)
        except (ValueError, ImportError) as error:
            raise Refusal(Message("study.place", place=url, reason=str(error)[:200])) from None

    def names(self, folder: str) -> list[str]:
        """Return the names of the files in a folder."""
        return self._listed(folder, "file")

    def folders(self) -> list[str]:
        """Return the names of the folders."""
        return self._listed("", "directory")

    def _listed(self, folder: str, kind: str) -> list[str]:
        try:
            found = self._files.ls(f"{self._root}/{folder}".rstrip("/"), detail=True, refresh=True)
        except FileNotFoundError:
            return []
        return sorted(one["name"].rstrip("/").rsplit("/", 1)[-1] for one in found if one["type"] == kind)

    def read(self, name: str) -> bytes:
        """Return a file."""
        return self._files.cat_file(f"{self._root}/{name}")

    def write(self, name: str, data: bytes) -> None:
        """Write a file."""
        path = f"{self._root}/{name}"
        self._files.makedirs(path.rsplit("/", 1)[0], exist_ok=True)
        self._files.pipe_file(path, data)

    def remove(self, name: str) -> None:
        """Remove a file."""
        if self._files.exists(f"{self._root}/{name}"):
            self._files.rm_file(f"{self._root}/{name}")


def files_at(place: str | Path) -> Files:
    """Return the files of a folder or of an address with `://`."""
    return RemoteFiles(str(place)) if "://" in str(place) else LocalFiles(Path(place))
