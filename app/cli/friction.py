"""`vibrafeed friction`: published coefficients of friction and restitution."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from app.cli import console
from app.cli.options import Json
from app.cli.published import check_some, joined, numbered, tell_notes
from core import materials
from core.materials import shown

PAIRS = ("pair", "surface", "static", "kinetic", "from")
REBOUNDS = ("pair", "restitution", "note", "from")


def friction(
    words: Annotated[
        list[str] | None,
        typer.Argument(help="Show only rows that contain all of these words, as in: steel abs."),
    ] = None,
    as_json: Json = False,
) -> None:
    """Print published coefficients of friction and restitution, with their sources."""
    asked = " ".join(words or ())
    published = materials.friction(asked)
    if as_json:
        console.document(published)
        return
    check_some((*published["pairs"], *published["rebounds"]), asked)
    numbers = numbered(published["sources"])
    if published["pairs"]:
        rows = []
        for row in published["pairs"]:
            surface = joined(row["surface"], row["note"])
            either = shown(row, "coefficient") and shown(row, "coefficient") + " ?"
            static, kinetic = (
                shown(row, "static") or either,
                shown(row, "kinetic") or either,
            )
            rows.append((_pair(row), surface, static, kinetic, numbers[row["source"]]))
        console.table(PAIRS, rows)
        if any(row["coefficient"] for row in published["pairs"]):
            console.tell("  ?: the source does not say whether it is static or kinetic.")
    if published["rebounds"]:
        rebounds = [
            (_pair(row), shown(row, "restitution"), row["note"], numbers[row["source"]])
            for row in published["rebounds"]
        ]
        console.table(REBOUNDS, rebounds)
        for line in published["restitution_notes"]:
            console.tell(f"- {line}")
    tell_notes(
        (*published["about"], *(() if asked else published["surfaces"])), published["sources"]
    )


def _pair(row: Mapping[str, Any]) -> str:
    """Return the two materials of a row as `part on track`."""
    return f"{row['part']} on {row['track']}"
