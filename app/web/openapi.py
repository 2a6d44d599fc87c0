"""The OpenAPI document: one model of a value, and names that generated clients can live with."""

from __future__ import annotations

from functools import cache, cached_property
from typing import Annotated, Any, Literal

import orjson
from fastapi import FastAPI, Request
from fastapi.responses import Response
from fastapi.routing import APIRoute
from pydantic import BaseModel, Field, RootModel
from pydantic.json_schema import GenerateJsonSchema, models_json_schema
from pydantic_core.core_schema import NullableSchema, WithDefaultSchema

from vibrafeed.app.jobs.keys import Keys
from vibrafeed.app.web.documents import JobList, Results
from vibrafeed.app.web.downloads import made_document
from vibrafeed.app.web.execution import AnyStudy, ExecuteRequest
from vibrafeed.app.web.guard import is_open
from vibrafeed.app.web.replies import Document, ProblemDocument, component, problems
from vibrafeed.app.web.sharing import Sharing
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.study.grid_study import PARAMETERS, Parameters

PATH = "/openapi.json"
KEYS: list[dict[str, list[str]]] = [{"bearer": []}, {"header": []}]
SCHEMES = {
    "bearer": {"type": "http", "scheme": "bearer"},
    "header": {"type": "apiKey", "in": "header", "name": "X-API-Key"},
}
REFUSALS = {
    str(status): reply
    for status, reply in problems(
        s401="No key, or a wrong one, where keys are needed",
        s403="The role of the key does not allow it",
        s414="The query is too long",
        s429="The key sends too many requests",
    ).items()
}
REFUSALS["401"]["headers"] = {"WWW-Authenticate": {"schema": {"type": "string"}}}

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


class Values(RootModel[dict[str, Value]]):
    """Values of parameters by name."""


class Distributions(RootModel[dict[str, Distribution]]):
    """Unknown or uncertain parameters by name."""


class StudySchema(GenerateJsonSchema):
    """The JSON Schema of studies whose sections are mappings from names to one model of a value.

    The names and units of a scene's parameters come from `/scenes/{scene}`. `/schema` has a model
    per parameter, for editors.
    """

    def generate_inner(self, schema: Any) -> dict[str, Any]:
        """Return the schema of a part: of a section of parameters, that of a mapping."""
        if schema["type"] == "model" and PARAMETERS[0] in schema["cls"].model_fields:
            section = Values if schema["cls"] is Parameters else Distributions
            section_schema = super().generate_inner(section.__pydantic_core_schema__)
            self._sections[schema.get("ref")] = section_schema
            return section_schema
        if schema["type"] == "definition-ref" and schema["schema_ref"] in self._sections:
            return self._sections[schema["schema_ref"]]
        return super().generate_inner(schema)

    @cached_property
    def _sections(self) -> dict[str | None, dict[str, Any]]:
        # By the names under which pydantic refers to sections that a study has twice.
        return {}

    def nullable_schema(self, schema: NullableSchema) -> dict[str, Any]:
        """Return the schema of a field that is left out where it has no value."""
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: WithDefaultSchema) -> dict[str, Any]:
        """Return the schema of a field with its default, unless that is None."""
        if schema.get("default") is None:
            return self.generate_inner(schema["schema"])
        return super().default_schema(schema)


def operation_id(route: APIRoute) -> str:
    """Return the operation identifier of a route: the name of its function."""
    return route.name


def install(app: FastAPI, keys: Keys) -> None:
    """Complete the OpenAPI document with bodies, refusals and keys, and serve it with its ETag.

    The document says that a key is required if any exist, else that it is optional.
    """
    openapi_of_routes = app.openapi
    routes = app.router.routes
    routes[:] = [route for route in routes if getattr(route, "path", "") != PATH]

    def openapi() -> dict[str, Any]:
        """Return the OpenAPI document, which FastAPI keeps."""
        is_new = app.openapi_schema is None
        document = openapi_of_routes()
        if is_new:
            document["components"] |= {"securitySchemes": SCHEMES}
            document["components"]["schemas"].update(_components())
            for path, operations in document["paths"].items():
                for operation in operations.values():
                    if is_open(path):
                        operation["security"] = []
                    else:
                        operation["responses"] = REFUSALS | operation["responses"]
        # Keys come and go while the service runs.
        document["security"] = KEYS if keys.are_needed else [{}, *KEYS]
        return document

    app.openapi = openapi  # type: ignore[method-assign]

    @app.api_route(PATH, methods=["GET", "HEAD"], include_in_schema=False)
    async def document(request: Request) -> Response:
        """Return the OpenAPI document for the address by which the client calls the service."""

        def make() -> bytes:
            """Return its bytes."""
            root = request.scope.get("root_path", "")
            servers = {"servers": [{"url": root}]} if root else {}
            return orjson.dumps(openapi() | servers)

        return await made_document(request, make)


@cache
def _components() -> dict[str, Any]:
    """Return the schemas of bodies and problem documents by name; callers must not change them."""
    models: list[type[BaseModel]] = [ProblemDocument, Sharing, Document, ExecuteRequest, AnyStudy]
    models += [JobList, Results, *(kind.model for kind in KINDS.values())]
    _, document = models_json_schema(
        [(model, "validation") for model in models],
        ref_template=component("{model}")["$ref"],
        schema_generator=StudySchema,
    )
    schemas: dict[str, Any] = document["$defs"]
    # A drive is written out in every study that may have one.
    for schema in [*schemas.values()]:
        drives = schema.get("properties", {}).get("drive", {}).get("anyOf", [])
        for number, drive in enumerate(drives):
            if "title" in drive:
                schemas[drive["title"]] = drive
                drives[number] = component(drive["title"])
    return schemas
