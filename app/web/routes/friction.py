"""Published coefficients of friction."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query
from fastapi.responses import Response
from pydantic import BaseModel

from vibrafeed.app.web.replies import json_reply, problems
from vibrafeed.core.materials import friction

router = APIRouter(tags=["scenes"])

Range = list[float]
"""The least and the largest value; clients that are generated read a list best."""


class Pair(BaseModel):
    """A pair of materials; `coefficient` where the source tells neither static nor kinetic."""

    part: str
    track: str
    surface: str
    note: str
    static: Range | None
    kinetic: Range | None
    coefficient: Range | None
    source: str


class Rebound(BaseModel):
    """The restitution of a part in an impact."""

    part: str
    track: str
    note: str
    restitution: Range
    source: str


class Source(BaseModel):
    """The source of values."""

    title: str
    by: str
    address: str


class FrictionTable(BaseModel):
    """Published coefficients, and what to make of them."""

    about: list[str]
    surfaces: list[str]
    restitution_notes: list[str]
    pairs: list[Pair]
    rebounds: list[Rebound]
    sources: dict[str, Source]


@router.get(
    "/friction",
    summary="Published coefficients of friction and restitution",
    response_model=FrictionTable,
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
    """Return published coefficients, as ranges, each row with its source."""
    return json_reply(friction(words))
