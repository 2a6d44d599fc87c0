"""`vibrafeed schema`: the JSON Schema of studies."""

from __future__ import annotations

import json

import typer

from core.schema import study_schema


def schema() -> None:
    """Print the JSON Schema of studies, for editors."""
    typer.echo(json.dumps(study_schema(), indent=1))
