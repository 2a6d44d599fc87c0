"""`vibrafeed schema`: the JSON Schema of studies."""

from __future__ import annotations

import typer


def schema() -> None:
    """Print the JSON Schema of studies, for editors."""
    import json

    from core.catalogue import study_schema

    typer.echo(json.dumps(study_schema(), indent=2))
