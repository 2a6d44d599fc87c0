"""The OpenAPI document: names that generated clients can live with, and models told once."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

import orjson
from fastapi import FastAPI, Request
from fastapi.responses import Response
from fastapi.routing import APIRoute
from pydantic import BaseModel
from pydantic.json_schema import models_json_schema

from vibrafeed.app.kept_texts import kept_text
from vibrafeed.app.web.execution import PROCESSES, AnyStudy
from vibrafeed.app.web.made_once import made_once
from vibrafeed.app.web.replies import ProblemDocument, component, execution_name
from vibrafeed.app.web.sharing import Sharing

PATH = "/openapi.json"


def operation_id(route: APIRoute) -> str:
    """Return the operation identifier of a route: the name of its function."""
    return route.name


def install(app: FastAPI) -> None:
    """Add shared schemas to the OpenAPI document, and serve the document from memory.

    FastAPI would make the document, a megabyte, anew in the event loop for every request.
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
        """Return the OpenAPI document with the shared schemas."""
        is_new = app.openapi_schema is None
        document = plain()
        if is_new:
            document["components"]["schemas"].update(_components())
        return document

    app.openapi = openapi  # type: ignore[method-assign]


@cache
def _components() -> dict[str, Any]:
    """Return the shared schemas of the OpenAPI document by name; callers must not change them.

    They are those of problem documents, studies and execute requests.
    """
    requests = {
        execution_name(process.study): {
            "type": "object",
            "description": "An execute request of OGC API - Processes.",
            "required": ["inputs"],
            "properties": {
                "inputs": {
                    "type": "object",
                    "required": ["study"],
                    "properties": {"study": component(process.study.__name__)},
                },
                "outputs": {
                    "type": "object",
                    "properties": {"dataset": {"type": "object"}},
                    "additionalProperties": False,
                },
                "response": {"enum": ["raw", "document"], "type": "string", "default": "raw"},
            },
        }
        for process in PROCESSES.values()
    }
    models: dict[str, Any] = json.loads(kept_text("openapi", _models))
    return models | requests


def _models() -> str:
    """Return the schemas of problem documents and studies by name, as JSON; takes seconds."""
    models: list[type[BaseModel]] = [ProblemDocument, Sharing, AnyStudy]
    models += [process.study for process in PROCESSES.values()]
    _, schemas = models_json_schema(
        [(model, "validation") for model in models], ref_template=component("{model}")["$ref"]
    )
    return json.dumps(schemas["$defs"])
