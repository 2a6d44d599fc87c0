"""`vibrafeed scenes`: the catalogue."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli.studies import refuse
from core.errors import StudyError


def scenes(
    name: Annotated[str | None, typer.Argument(help="A scene; all if left out.")] = None,
    variant: Annotated[str | None, typer.Option(help="A variant; the default if left out.")] = None,
    method: Annotated[
        str | None, typer.Option(help="Describe the motion in time by this method instead.")
    ] = None,
) -> None:
    """Print the catalogue: scenes, parameters, outputs, units, equations, validity."""
    from app.cli import tables
    from core.catalogue import describe, describe_all

    try:
        if name is None:
            tables.show_scenes(describe_all())
        else:
            tables.show_scene(describe(name, variant, method=method))
    except StudyError as error:
        refuse({Path("scenes"): error.problems})
