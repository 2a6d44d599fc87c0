"""A study in another form: TOML, JSON, a line for curl, a call in Python."""

from __future__ import annotations

from typing import Annotated, Literal

from fastapi import Query, Request
from fastapi.responses import Response

from vibrafeed.app.web.calculations import convert_study
from vibrafeed.app.web.dependencies import BaseOf, Body, SettingsOf, refuse_repeated
from vibrafeed.app.web.execution import PROCESSES, AnyStudy
from vibrafeed.app.web.replies import Router, component, problems
from vibrafeed.app.web.shares import calculate_in_process, hold_slot

router = Router(tags=["processes"])

TEXT = "text/plain"


@router.post(
    "/convert",
    summary="Convert a study to another format",
    response_class=Response,
    responses={
        200: {"content": {TEXT: {"schema": {"type": "string"}}}, "description": "The study"},
        **problems(
            s413="The body is too large",
            s422="The study cannot be run, or there is no such format",
        ),
    },
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {
                "application/json": {
                    "schema": component(AnyStudy.__name__),
                    "example": PROCESSES["simulate"].example,
                }
            },
        }
    },
    dependencies=[refuse_repeated(), hold_slot()],
)
async def convert(
    request: Request,
    body: Body,
    settings: SettingsOf,
    base: BaseOf,
    to: Annotated[
        Literal["toml", "json", "curl", "powershell", "python"],
        Query(
            description="Format to convert to: toml, json, curl or powershell (commands that post "
            "the study), or python (a program that runs it)."
        ),
    ],
) -> Response:
    """Check a study, and return it as `vibrafeed convert` does; a command asks this service."""
    text = await calculate_in_process(
        request, convert_study, body, to, base, seconds=settings.max_execution_seconds
    )
    return Response(text, media_type=TEXT)
