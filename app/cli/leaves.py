"""`vibrafeed leaves`: published moduli and densities of leaf springs."""

from __future__ import annotations

from typing import Annotated

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import Json
from vibrafeed.app.cli.published import exit_if_empty, join_texts, number_sources, tell_notes
from vibrafeed.core import materials
from vibrafeed.core.materials import shown

HEADING = ("material", "form", "elastic modulus (GPa)", "density (kg/m³)", "from")


def leaves(
    words: Annotated[
        list[str] | None,
        typer.Argument(
            help="Show only spring materials whose row contains all of these words, as in: "
            "glass epoxy."
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Print published moduli and densities of leaf springs, with their sources."""
    asked = " ".join(words or ())
    published = materials.leaf_springs(asked)
    if as_json:
        console.document(published)
        return
    exit_if_empty(published["materials"], asked)
    numbers = number_sources(published["sources"])
    rows = [
        (
            row["material"],
            join_texts(row["form"], row["note"]),
            *(shown(row, name) for name in materials.OF_LEAVES),
            numbers[row["source"]],
        )
        for row in published["materials"]
    ]
    console.table(HEADING, rows)
    tell_notes(published["about"], published["sources"])
