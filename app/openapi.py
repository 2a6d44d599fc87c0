"""The OpenAPI document: schemas that models bring along stand where references find them."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI

_OWN, _SHARED = "#/$defs/", "#/components/schemas/"


def install(app: FastAPI) -> None:
    """Have the document's schemas moved to its components, where it is made."""
    plain = app.openapi

    def openapi() -> dict[str, Any]:
        if app.openapi_schema is None:
            share_schemas(plain())
        return plain()

    app.openapi = openapi  # type: ignore[method-assign]


def share_schemas(document: dict[str, Any]) -> None:
    """Move what stands under ``$defs`` in any schema to the components of the document.

    Pydantic writes references from the root of a model's schema; within a larger document they
    would point nowhere.

    Raises
    ------
    ValueError
        If two different schemas have one name.
    """
    shared = document.setdefault("components", {}).setdefault("schemas", {})

    def walk(node: Any) -> None:
        if isinstance(node, list):
            for item in node:
                walk(item)
        elif isinstance(node, dict):
            own = node.pop("$defs", {})
            for item in (*own.values(), *node.values()):
                walk(item)
            for name, value in node.items():
                if isinstance(value, str):  # a reference, or one in a discriminator's mapping
                    node[name] = value.replace(_OWN, _SHARED, 1) if value[:8] == _OWN else value
            for name, schema in own.items():
                if shared.setdefault(name, schema) != schema:
                    raise ValueError(f"two schemas are called {name}")

    walk(document)
