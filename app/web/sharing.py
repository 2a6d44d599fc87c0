"""Sharing of jobs and sweeps: the body that says so, and how the OpenAPI document tells of it."""

from __future__ import annotations

from typing import Any

from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, ConfigDict, StrictBool, ValidationError

from vibrafeed.app.web.replies import component, problems


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
        return Sharing.model_validate_json(body).shared
    except ValidationError as error:
        raise RequestValidationError(error.errors(include_input=False)) from None
