"""The routes, one file a resource."""

from __future__ import annotations

from typing import Any

import orjson
from fastapi.responses import Response
from pydantic import BaseModel


class ProblemItem(BaseModel):
    """One of several problems."""

    place: str
    message: str
    fix: str


class ProblemDocument(BaseModel):
    """What went wrong (RFC 9457)."""

    type: str
    title: str
    status: int
    detail: str
    instance: str | None = None
    errors: list[ProblemItem] | None = None


def component(name: str) -> dict[str, Any]:
    """Return a reference to a schema that `app.openapi` adds to the document."""
    return {"$ref": f"#/components/schemas/{name}"}


def execution_name(study: type[BaseModel]) -> str:
    """Return the name of the schema of an execute request with a study."""
    return f"{study.__name__}Execution"


PROBLEM: dict[str, Any] = {
    "content": {"application/problem+json": {"schema": component(ProblemDocument.__name__)}}
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
