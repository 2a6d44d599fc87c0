"""`vibrafeed leaves`: published moduli and densities of leaf springs."""

from __future__ import annotations

from typing import Annotated

import typer

from app.cli import console
from app.cli.options import FAILED, Json
from core import materials
from core.materials import shown

HEADING = ("material", "form", "elastic modulus (GPa)", "density (kg/m³)", "from")


def leaves(
    words: Annotated[
        list[str] | None,
        typer.Argument(help="Rows that hold all of these words, as in: glass epoxy."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Print published moduli and densities of leaf springs, with their sources."""
    asked = " ".join(words or ())
    published = materials.leaf_springs(asked)
    if as_json:
        console.document(published)
        return
    if not published["materials"]:
        console.say(f"No row holds all of: {asked}. Give fewer words, or none to see all rows.")
        raise typer.Exit(FAILED)
    numbers = {name: str(number) for number, name in enumerate(published["sources"], 1)}
    rows = [
        (
            row["material"],
            "; ".join(text for text in (row["form"], row["note"]) if text),
            *(shown(row, name) for name in materials.OF_LEAVES),
            numbers[row["source"]],
        )
        for row in published["materials"]
    ]
    console.table(HEADING, rows)
    for line in published["about"]:
        console.tell(f"- {line}")
    for name, source in published["sources"].items():
        console.tell(f"  {numbers[name]}: {source['title']}. {source['by']}. {source['address']}")
