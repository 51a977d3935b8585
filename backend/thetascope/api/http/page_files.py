"""Serve the page's own files. Browsers keep scripts and styles at addresses that change with their content."""

import mimetypes
import os
import re
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.responses import FileResponse, Response
from starlette.staticfiles import NotModifiedResponse, StaticFiles
from starlette.types import Scope

_PACKAGE = Path(__file__).parents[2]
#: Inside the package where it is installed as a wheel, beside backend/ in a checkout.
FRONTEND = next(
    (f for f in (_PACKAGE / "frontend", _PACKAGE.parents[1] / "frontend") if f.is_dir()), _PACKAGE / "frontend"
)

#: Addresses of pages whose files lie in frontend/pages.
PAGES = ("learn", "lesson-editor", "worksheet", "runs", "records", "workshop", "classroom", "studies")
#: Addresses under which every path is one document: `/join/HWRTKM` carries the code of a room.
ONE_DOCUMENT = ("join",)

#: A versioned file is at /static/<version>/<file>; modules import each other by relative addresses.
STATIC = "static"
_FILE = re.compile(r'(?<=(?:href="|.src="))/(?=[^"]+\.(?:js|css|svg)")')

# Without these the operating system's table of types applies, which may lack scripts or have a wrong type for them.
for _suffix, _kind in {
    ".js": "text/javascript",
    ".mjs": "text/javascript",
    ".css": "text/css",
    ".svg": "image/svg+xml",
    ".json": "application/json",
    ".woff2": "font/woff2",
    ".webmanifest": "application/manifest+json",
}.items():
    mimetypes.add_type(_kind, _suffix)

FOREVER = "public, max-age=31536000, immutable"
REVALIDATED = "no-cache"


class PageFiles(NamedTuple):
    """The files of the page at one moment: a digest of all of them, and the signature of each."""

    version: str
    signatures: dict[str, tuple[int, int]]


def _signature(path: str | os.PathLike[str]) -> tuple[int, int]:
    """Return the time of the last change of a file in ns, and its size in bytes."""
    status = os.stat(path)
    return status.st_mtime_ns, status.st_size


def page_files(folder: Path) -> PageFiles:
    """Return the version and the signatures of the scripts, styles and images in a folder, by their relative paths."""
    paths = (Path(root, name) for root, _, names in os.walk(folder) for name in names)
    kept = (path for path in paths if path.suffix in (".js", ".css", ".svg"))
    signatures = {path.relative_to(folder).as_posix(): _signature(path) for path in kept}
    return PageFiles(_version(folder, tuple(sorted(signatures.items()))), signatures)


@lru_cache(maxsize=4)
def _version(folder: Path, signatures: tuple[tuple[str, tuple[int, int]], ...]) -> str:
    digest = sha256()
    for name, _ in signatures:
        content = (folder / name).read_bytes()
        digest.update(f"{name}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()[:16]


class Frontend(StaticFiles):
    """The page: documents that browsers revalidate at each request, and versioned files that they keep.

    An update is visible immediately, since the documents then refer to other addresses. The plain address of a file is
    served, too, and revalidated.
    """

    def __init__(self, directory: Path):
        super().__init__(directory=directory, html=True, check_dir=False)
        self.folder = directory
        self.files: PageFiles | None = None

    async def get_response(self, path: str, scope: Scope) -> Response:
        """Return a file of the page. Raises HTTPException 404."""
        first, *others = Path(path).parts or ("",)
        if first == "api":  # never a file of the page
            raise HTTPException(404)
        if first == STATIC and len(others) > 1:
            return await self._versioned(others[0], "/".join(others[1:]), scope)
        if first in ONE_DOCUMENT:
            path = f"pages/{first}/index.html"
        response = await super().get_response(f"pages/{path}" if first in PAGES else path, scope)
        if isinstance(response, FileResponse) and response.media_type == "text/html":
            return await run_in_threadpool(self._document, Path(response.path), scope)
        response.headers["Cache-Control"] = REVALIDATED
        return response

    async def _versioned(self, version: str, file: str, scope: Scope) -> Response:
        response = await super().get_response(file, scope)
        response.headers["Cache-Control"] = FOREVER if self._is_current(version, file) else REVALIDATED
        return response

    def _is_current(self, version: str, file: str) -> bool:
        """Return whether the version is that of the present content of the file."""
        if self.files is None:
            self.files = page_files(self.folder)
        signature = self.files.signatures.get(file)
        return signature is not None and self.files.version == version and _signature(self.folder / file) == signature

    def _document(self, path: Path, scope: Scope) -> Response:
        """Return a document whose scripts and styles have versioned addresses."""
        self.files = page_files(self.folder)
        text = _FILE.sub(f"/{STATIC}/{self.files.version}/", path.read_text(encoding="utf-8"))
        headers = {"ETag": f'"{sha256(text.encode()).hexdigest()[:20]}"', "Cache-Control": REVALIDATED}
        response = Response(text, headers=headers, media_type="text/html")
        known = Headers(scope=scope).get("if-none-match", "")
        tags = [tag.strip().removeprefix("W/") for tag in known.split(",")]
        return NotModifiedResponse(response.headers) if headers["ETag"] in tags else response
