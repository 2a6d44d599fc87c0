"""The OpenAPI document: one model of a value, and names that generated clients can live with."""

from __future__ import annotations

from functools import cache
from typing import Annotated, Any, Literal

import orjson
from fastapi import FastAPI, Request
from fastapi.responses import Response
from fastapi.routing import APIRoute
from pydantic import BaseModel, Field, RootModel, TypeAdapter
from pydantic.json_schema import GenerateJsonSchema, models_json_schema
from pydantic_core.core_schema import ModelSchema

from vibrafeed.app.web.execution import PROCESSES, AnyStudy, ExecuteRequest
from vibrafeed.app.web.made_once import made_once
from vibrafeed.app.web.replies import ProblemDocument, component
from vibrafeed.app.web.sharing import Sharing
from vibrafeed.core.study.grid_study import PARAMETERS, Parameters

PATH = "/openapi.json"

Number = float | Annotated[str, Field(max_length=200)]
"""A number in the unit of its parameter, or text with a unit."""


class Range(BaseModel):
    """Values from `start` to `stop`, both included: `num` of them, or one every `step`."""

    start: Number
    stop: Number
    num: int | None = Field(None, ge=2)
    step: Number | None = None
    spacing: Literal["linear", "log"] = "linear"


class Value(RootModel[float | str | list[Number] | Range]):
    """A value of a parameter: a number in its unit, text with a unit, a list, or a range."""


class Distribution(BaseModel):
    """An unknown or uncertain value: its bounds, a distribution, or both."""

    lower: Number | None = None
    upper: Number | None = None
    mean: Number | None = None
    deviation: Number | None = None
    most_likely: Number | None = None
    median: Number | None = None
    factor: float | None = None
    values: list[Number] | None = None
    densities: list[Number] | None = None


class StudySchema(GenerateJsonSchema):
    """The JSON Schema of studies whose sections are mappings from names to one model of a value.

    The names and units of a scene's parameters come from `/scenes/{scene}`. `/schema` has a model
    per parameter, for editors.
    """

    def model_schema(self, schema: ModelSchema) -> dict[str, Any]:
        """Return the schema of a model: of a section of parameters, that of a mapping."""
        section = schema["cls"]
        if PARAMETERS[0] not in section.model_fields:
            return super().model_schema(schema)
        entry = TypeAdapter(Value if section is Parameters else Distribution)
        return {
            "type": "object",
            "title": section.__name__,
            "description": section.__doc__,
            "additionalProperties": self.generate_inner(entry.core_schema),
        }


def operation_id(route: APIRoute) -> str:
    """Return the operation identifier of a route: the name of its function."""
    return route.name


def install(app: FastAPI) -> None:
    """Add the schemas of bodies to the OpenAPI document, and serve the document from memory.

    FastAPI would make the document anew in the event loop for every request.
    """
    plain = app.openapi
    routes = app.router.routes
    routes[:] = [route for route in routes if getattr(route, "path", "") != PATH]

    @app.api_route(PATH, methods=["GET", "HEAD"], include_in_schema=False)
    async def document(request: Request) -> Response:
        """Return the OpenAPI document, made once per address and need of keys."""
        root, needs_key = request.scope.get("root_path", ""), request.app.state.keys.are_needed

        def make() -> bytes:
            """Return the bytes of the OpenAPI document for one address."""
            servers = {"servers": [{"url": root}]} if root else {}
            return orjson.dumps(app.openapi() | servers)

        return await made_once(request, (PATH, root, needs_key), make)

    def openapi() -> dict[str, Any]:
        """Return the OpenAPI document with the schemas of bodies."""
        is_new = app.openapi_schema is None
        document = plain()
        if is_new:
            document["components"]["schemas"].update(_components())
        return document

    app.openapi = openapi  # type: ignore[method-assign]


@cache
def _components() -> dict[str, Any]:
    """Return the schemas of bodies and problem documents by name; callers must not change them."""
    models: list[type[BaseModel]] = [ProblemDocument, Sharing, ExecuteRequest, AnyStudy]
    models += [process.study for process in PROCESSES.values()]
    _, made = models_json_schema(
        [(model, "validation") for model in models],
        ref_template=component("{model}")["$ref"],
        schema_generator=StudySchema,
    )
    schemas: dict[str, Any] = made["$defs"]
    # A drive is written out in every study that may have one.
    for schema in [*schemas.values()]:
        drives = schema.get("properties", {}).get("drive", {}).get("anyOf", [])
        for number, drive in enumerate(drives):
            if "title" in drive:
                schemas[drive["title"]] = drive
                drives[number] = component(drive["title"])
    return schemas
