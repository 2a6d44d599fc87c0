"""The pages for browsers, and their files, which hold no secrets and need no key."""

from __future__ import annotations

import mimetypes
from pathlib import Path

from fastapi import FastAPI
from fastapi.responses import FileResponse, Response
from fastapi.staticfiles import StaticFiles

# Not those of Windows' registry, which any program changes: browsers run no script of type text.
for suffix, media in {
    ".css": "text/css",
    ".js": "text/javascript",
    ".mjs": "text/javascript",
    ".json": "application/json",
    ".svg": "image/svg+xml",
    ".woff2": "font/woff2",
}.items():
    mimetypes.add_type(media, suffix)

FILES = Path(__file__).resolve().parent.parent.parent / "page"
NAME = "page"
BUNDLE = FILES / "bundle.js"
"""All modules in one file: wheels have it."""


def index() -> Response:
    """Return the page itself."""
    return _page("index.html")


def docs() -> Response:
    """Return the page that shows each route, and tries them."""
    return _page("docs.html")


def bundle() -> Response:
    """Return all modules of the page in one file, under the name of their entry."""
    return _page(BUNDLE.name)


def _page(name: str) -> Response:
    return FileResponse(FILES / name, headers={"Cache-Control": "no-cache"})


def install(app: FastAPI) -> None:
    """Add the routes of the documentation page and the files of both pages."""
    app.add_api_route("/docs", docs, methods=["GET", "HEAD"], include_in_schema=False)
    if BUNDLE.exists():
        entry = f"/{NAME}/modules/main.js"
        app.add_api_route(entry, bundle, methods=["GET", "HEAD"], include_in_schema=False)
    app.mount(f"/{NAME}", StaticFiles(directory=FILES), name=NAME)
