"""`vibrafeed scenes`: the catalogue."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from app.cli import catalogue, console
from app.cli.options import Json, Units
from app.cli.studies import refuse
from app.cli.units import units_asked
from core.catalogue import describe, describe_all
from core.errors import StudyError
from core.scenes import SCENES


def _names(begun: str) -> list[str]:
    """Return the scene names that begin with the typed text, for completion in a shell."""
    return [name for name in SCENES if name.startswith(begun)]


def scenes(
    name: Annotated[
        str | None,
        typer.Argument(help="Name of a scene; all scenes by default.", autocompletion=_names),
    ] = None,
    variant: Annotated[
        str | None,
        typer.Option(help="Variant of the closed forms; the scene's default if omitted."),
    ] = None,
    method: Annotated[
        str | None,
        typer.Option(
            help="Describe the simulated motion by this method instead of the closed forms."
        ),
    ] = None,
    units: Units = None,
    as_json: Json = False,
) -> None:
    """Print the catalogue: scenes, parameters, outputs, units, equations, validity."""
    shown = units_asked(units)
    try:
        document = describe_all() if name is None else describe(name, variant, method=method)
    except StudyError as error:
        refuse({Path("scenes"): error.problems})
    if as_json:
        console.document(document)
    elif isinstance(document, list):
        catalogue.show_scenes(document)
    else:
        catalogue.show_scene(document, shown)
