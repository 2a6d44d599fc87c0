"""Published coefficients of friction."""

from __future__ import annotations

from typing import Annotated

from fastapi import Query
from fastapi.responses import Response

from vibrafeed.app.web.replies import Document, Router, json_reply, problems
from vibrafeed.core.materials import friction

router = Router(tags=["scenes"])


@router.get(
    "/friction",
    summary="Published coefficients of friction and restitution",
    response_model=Document,
    responses=problems(s422="The words are too many"),
)
def list_friction(
    words: Annotated[
        str,
        Query(
            max_length=100,
            description="Only rows that contain all of these words, such as `steel abs`; by "
            "default all rows.",
        ),
    ] = "",
) -> Response:
    """Return published coefficients, each row with its source.

    Ranges are lists of the least and the largest value.
    """
    return json_reply(friction(words))
