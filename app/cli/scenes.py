"""`vibrafeed scenes`: the catalogue."""

import json
from pathlib import Path
from typing import Annotated

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import Json, Units
from vibrafeed.app.cli.studies import refuse
from vibrafeed.core.errors import StudyError


def _names(begun: str) -> list[str]:
    """Return the scene names that begin with the typed text, for completion in a shell."""
    from vibrafeed.core.scenes import SCENES

    return [name for name in SCENES if name.startswith(begun)]


def scenes(
    name: Annotated[
        str | None,
        typer.Argument(
            help="Name of the scene to describe; by default all scenes are listed.",
            autocompletion=_names,
        ),
    ] = None,
    variant: Annotated[
        str | None,
        typer.Option(
            help="Variant of the closed-form equations to describe, such as derived; by "
            "default the scene's default variant."
        ),
    ] = None,
    method: Annotated[
        str | None,
        typer.Option(
            help="Describe the motion simulated by this method, such as events, instead of "
            "the closed-form equations."
        ),
    ] = None,
    schema: Annotated[
        bool, typer.Option("--schema", help="Print the JSON Schema of studies, for editors.")
    ] = False,
    units: Units = None,
    as_json: Json = False,
) -> None:
    """Print the catalogue: scenes, parameters, outputs, units, equations, validity."""
    from vibrafeed.app.cli import catalogue
    from vibrafeed.app.cli.units import units_asked
    from vibrafeed.core.catalogue import describe, describe_all

    if schema:
        from vibrafeed.core.schema import study_schema  # it loads half of core

        typer.echo(json.dumps(study_schema(), indent=0))
        return
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
