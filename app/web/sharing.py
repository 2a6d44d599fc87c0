"""Sharing of jobs and sweeps: the body that says so, and how the OpenAPI document tells of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, ConfigDict, StrictBool

from vibrafeed.app.web.replies import component, problems
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import read_json


class Sharing(BaseModel):
    """The readers of a result: all keys, or the owner only."""

    model_config = ConfigDict(extra="forbid")

    shared: StrictBool


SHARING_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "application/json": {
                "schema": component(Sharing.__name__),
                "example": {"shared": True},
            }
        },
    }
}
NOT_OWNER = problems(
    s403="The owner is another key, or the role of the key does not allow the request"
)
NO_SHARING = problems(s413="The body is too large", s422="The body or the identifier is malformed")


def read_sharing(body: bytes) -> bool:
    """Return the value of `shared` in a request body; True makes a result readable for all keys.

    Raises `RequestValidationError` with all problems of the body, which is JSON.
    """
    try:
        content = read_json(body)
    except StudyError as error:
        raise RequestValidationError([_error(p.place, p.message) for p in error.problems]) from None
    if not isinstance(content, Mapping):
        raise RequestValidationError([_error("body", 'it is not like {"shared": true}')])
    problems = [
        _error(str(name)[:60], "there is no such field") for name in content if name != "shared"
    ]
    if not isinstance(content.get("shared"), bool):
        problems.append(_error("shared", "it is neither true nor false"))
    if problems:
        raise RequestValidationError(problems)
    return bool(content["shared"])


def _error(parameter: str, message: str) -> dict[str, Any]:
    """Return one validation error, in FastAPI's form."""
    return {"loc": (parameter,), "msg": message}
