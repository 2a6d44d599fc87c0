"""The page for browsers: its files, which hold no secrets and need no key."""

from __future__ import annotations

from pathlib import Path

from fastapi import FastAPI
from fastapi.responses import FileResponse, Response
from fastapi.staticfiles import StaticFiles

FILES = Path(__file__).resolve().parent.parent.parent / "page"
NAME = "page"


def index() -> Response:
    """Return the page itself."""
    return FileResponse(FILES / "index.html", headers={"Cache-Control": "no-cache"})


def install(app: FastAPI) -> None:
    """Serve the files that the page asks for."""
    app.mount(f"/{NAME}", StaticFiles(directory=FILES), name=NAME)
