"""Serve files outside /api: the page, Plotly.js, the documentation. None is loaded from a CDN."""

import gzip
import mimetypes
from functools import cache
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

from fastapi import APIRouter, FastAPI, Request
from starlette.exceptions import HTTPException
from starlette.responses import RedirectResponse, Response

from thetascope.api.http.page_files import FRONTEND, Frontend

router = APIRouter(include_in_schema=False)

#: Address under /assets → the installed package that carries the file, and the file in it.
ASSETS = {
    "plotly.min.js": ("plotly", "package_data/plotly.min.js"),
    "swagger-ui-bundle.js": ("fastapi_offline", "static/swagger-ui-bundle.js"),
    "swagger-ui.css": ("fastapi_offline", "static/swagger-ui.css"),
    "redoc.standalone.js": ("fastapi_offline", "static/redoc.standalone.js"),
}

DOCS = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Thetascope: the interface</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<link rel="icon" href="data:,"><link rel="stylesheet" href="/assets/swagger-ui.css"></head>
<body style="margin:0"><div id="swagger-ui"></div><script src="/assets/swagger-ui-bundle.js"></script>
<script src="/assets/docs.js"></script></body></html>
"""
DOCS_SCRIPT = """SwaggerUIBundle({url: "/openapi.json", dom_id: "#swagger-ui", deepLinking: true, validatorUrl: null,
  defaultModelsExpandDepth: 0, tryItOutEnabled: true});
"""
REDOC = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Thetascope: the interface</title>
<meta name="viewport" content="width=device-width, initial-scale=1"><link rel="icon" href="data:,"></head>
<body style="margin:0"><redoc spec-url="/openapi.json" disable-search="true" hide-loading></redoc>
<script src="/assets/redoc.standalone.js"></script></body></html>
"""


@router.get("/docs")
async def docs() -> Response:
    """Interactive documentation of the interface (Swagger UI)."""
    return Response(DOCS, media_type="text/html; charset=utf-8")


@router.get("/redoc")
async def redoc() -> Response:
    """Documentation of the interface (Redoc)."""
    return Response(REDOC, media_type="text/html; charset=utf-8")


@router.get("/assets/docs.js")
async def docs_script() -> Response:
    """Return the script that starts Swagger UI, as a file since the content policy forbids inline scripts."""
    return Response(DOCS_SCRIPT, media_type="text/javascript; charset=utf-8")


@router.get("/plants")
@router.get("/plants/")
async def plants_page(request: Request) -> Response:
    """Send the address that the page of plants had to the workshop."""
    query = f"?{request.url.query}" if request.url.query else ""
    return RedirectResponse(f"/workshop/{query}", 308)


@router.get("/assets/{name}")
def asset(request: Request, name: str) -> Response:
    """Return a file of an installed package, compressed once."""
    path = asset_path(name)
    if path is None:
        raise HTTPException(404)
    tag, packed = _packed(path)
    headers = {"ETag": tag, "Cache-Control": "public, max-age=3600", "Vary": "Accept-Encoding"}
    if request.headers.get("if-none-match") == tag:
        return Response(status_code=304, headers=headers)
    kind = mimetypes.guess_type(name)[0]
    if "gzip" in request.headers.get("accept-encoding", ""):
        return Response(packed, 200, {**headers, "Content-Encoding": "gzip"}, kind)
    return Response(_content(path), 200, headers, kind)


def asset_path(name: str) -> Path | None:
    """Return the path of the file, without importing the package (importing plotly is slow)."""
    if name not in ASSETS:
        return None
    package, file = ASSETS[name]
    spec = find_spec(package)
    path = Path(spec.origin).parent / file if spec and spec.origin else None
    return path if path and path.is_file() else None


def _content(path: Path) -> bytes:
    """Return the content of the file; in Redoc, the address of a logo on another site is removed."""
    return path.read_bytes().replace(b"https://cdn.redoc.ly/redoc/logo-mini.svg", b"data:,")


@cache
def _packed(path: Path) -> tuple[str, bytes]:
    content = _content(path)
    return f'"{sha256(content).hexdigest()[:20]}"', gzip.compress(content, 6, mtime=0)


def serve_frontend(app: FastAPI) -> None:
    """Serve frontend/ at every address that no route matches.

    It is the router's default and not a mount at /, which would also catch requests that a route refuses by method.
    """
    app.router.default = Frontend(FRONTEND)
