"""The catalogue of scenes."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Path, Query
from fastapi.responses import Response
from pydantic import BaseModel

from app.jobs.errors import NotFoundError
from app.web.replies import json_reply, problems
from core.catalogue import describe, describe_all, study_schema
from core.scenes import SCENES

router = APIRouter(tags=["scenes"])


class SceneLine(BaseModel):
    """One scene in the list."""

    name: str
    title: str
    source: str
    variants: list[str]
    default_variant: str
    methods: list[str]


@router.get("/scenes", summary="List the scenes", response_model=list[SceneLine])
def list_scenes() -> Response:
    """Return one line for each scene: name, title, source, variants."""
    return json_reply(describe_all())


@router.get(
    "/scenes/{name}",
    summary="Describe a scene",
    response_model=dict[str, Any],
    responses=problems(s404="No such scene", s422="No such variant or method"),
)
def describe_scene(
    name: Annotated[str, Path(max_length=100)],
    variant: Annotated[
        str | None, Query(max_length=100, description="The scene's default if left out.")
    ] = None,
    method: Annotated[
        str | None, Query(max_length=100, description="Describes the motion in time instead.")
    ] = None,
) -> Response:
    """Return parameters, outputs, units, equations, regimes and validity of a scene."""
    if name not in SCENES:
        raise NotFoundError(f"There is no scene '{name}'. GET /scenes lists them.")
    return json_reply(describe(name, variant, method=method))


@router.get("/schema", summary="JSON Schema of a study", response_model=dict[str, Any])
def schema() -> Response:
    """Return the JSON Schema of a study, as `vibrafeed schema` prints it."""
    return json_reply(study_schema())
