"""Whether the service is alive."""

from __future__ import annotations

from typing import Any

from fastapi import APIRouter
from fastapi.responses import Response

import core
from app.routes import json_reply

router = APIRouter(tags=["service"])


@router.get("/healthz", summary="Alive", response_model=dict[str, Any])
async def healthz() -> Response:
    """Return ``ok`` and the version; touches neither disk nor store."""
    return json_reply({"status": "ok", "version": core.__version__})
