"""The catalogue of scenes."""

from __future__ import annotations

from functools import cache
from typing import Annotated

import orjson
from fastapi import Path, Query, Request
from fastapi.responses import Response

from vibrafeed.app.jobs.errors import NotFoundError
from vibrafeed.app.web.downloads import made_document
from vibrafeed.app.web.replies import OBJECT, Document, Router, cached_replies, json_reply, problems
from vibrafeed.core.catalogue import describe, describe_all
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.schema import study_schema

router = Router(tags=["scenes"])


@router.get("/scenes", summary="List the scenes", response_model=list[Document])
def list_scenes() -> Response:
    """Return one line for each scene: name, title, source, variants."""
    return json_reply(describe_all())


@router.get(
    "/scenes/{name}",
    summary="Describe a scene",
    response_model=None,
    responses={
        **cached_replies("The scene", {"application/json": OBJECT}),
        **problems(s404="No such scene", s422="No such variant or method"),
    },
)
async def describe_scene(
    request: Request,
    name: Annotated[str, Path(max_length=100)],
    variant: Annotated[
        str | None,
        Query(
            max_length=100,
            description="Variant of the closed-form equations, such as derived; by default the "
            "scene's default variant.",
        ),
    ] = None,
    method: Annotated[
        str | None,
        Query(
            max_length=100,
            description="Method of simulation, such as events: describes the simulated motion "
            "instead of the closed-form equations.",
        ),
    ] = None,
) -> Response:
    """Return parameters, outputs, units, equations, regimes and validity of a scene."""
    if name not in SCENES:
        raise NotFoundError(f"There is no scene '{name}'. GET /scenes lists them.")
    return await made_document(
        request, lambda: orjson.dumps(describe(name, variant, method=method))
    )


@router.get(
    "/schema",
    summary="JSON Schema of a study",
    response_model=None,
    responses=cached_replies("The schema", {"application/json": OBJECT}),
)
async def schema(request: Request) -> Response:
    """Return the JSON Schema of a study, as `vibrafeed scenes --schema` prints it."""
    return await made_document(request, _schema)


@cache
def _schema() -> bytes:
    return orjson.dumps(study_schema())
