"""`vibrafeed schema`: the JSON Schema of studies."""

from __future__ import annotations

import typer


def schema() -> None:
    """Print the JSON Schema of studies, for editors.

    Models of every kind make it, which takes a second; the text is kept with the user until a
    source changes.
    """
    from vibrafeed.app.kept_texts import study_schema_text

    typer.echo(study_schema_text())
