"""The routes, one file a resource."""

from __future__ import annotations

from typing import Any

import orjson
from fastapi.responses import Response

PROBLEM: dict[str, Any] = {
    "content": {
        "application/problem+json": {
            "schema": {
                "type": "object",
                "required": ["type", "title", "status", "detail"],
                "properties": {
                    "type": {"type": "string"},
                    "title": {"type": "string"},
                    "status": {"type": "integer"},
                    "detail": {"type": "string"},
                    "instance": {"type": "string"},
                    "errors": {
                        "type": "array",
                        "items": {
                            "type": "object",
                            "required": ["place", "message", "fix"],
                            "properties": {
                                "place": {"type": "string"},
                                "message": {"type": "string"},
                                "fix": {"type": "string"},
                            },
                        },
                    },
                },
            }
        }
    }
}


def problems(**why: str) -> dict[int | str, dict[str, Any]]:
    """Return documented error replies, as in ``problems(s404="No such sweep")``."""
    return {int(status[1:]): {"description": text, **PROBLEM} for status, text in why.items()}


def json_reply(content: Any, status: int = 200, headers: dict[str, str] | None = None) -> Response:
    """Return JSON with numpy arrays written as lists, and NaN and infinity as null."""
    return Response(
        orjson.dumps(content, option=orjson.OPT_SERIALIZE_NUMPY),
        status,
        media_type="application/json",
        headers=headers,
    )
