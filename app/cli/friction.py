"""`vibrafeed friction`: published coefficients of friction and restitution."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import Json
from vibrafeed.app.cli.published import exit_if_empty, join_texts, number_sources, tell_notes
from vibrafeed.core import materials
from vibrafeed.core.materials import shown

PAIRS = ("pair", "surface", "static", "kinetic", "from")
REBOUNDS = ("pair", "restitution", "note", "from")


def friction(
    words: Annotated[
        list[str] | None,
        typer.Argument(
            help="Show only pairs of materials whose row in the table contains all of these "
            "words, as "
            "in: steel abs."
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Print published coefficients of friction and restitution, with their sources."""
    asked = " ".join(words or ())
    published = materials.friction(asked)
    if as_json:
        console.document(published)
        return
    exit_if_empty((*published["pairs"], *published["rebounds"]), asked)
    numbers = number_sources(published["sources"])
    if published["pairs"]:
        rows = []
        for row in published["pairs"]:
            surface = join_texts(row["surface"], row["note"])
            either = shown(row, "coefficient") and shown(row, "coefficient") + " ?"
            static, kinetic = (
                shown(row, "static") or either,
                shown(row, "kinetic") or either,
            )
            rows.append((_name_pair(row), surface, static, kinetic, numbers[row["source"]]))
        console.table(PAIRS, rows)
        if any(row["coefficient"] for row in published["pairs"]):
            console.tell("  ?: the source does not say whether it is static or kinetic.")
    if published["rebounds"]:
        rebounds = [
            (_name_pair(row), shown(row, "restitution"), row["note"], numbers[row["source"]])
            for row in published["rebounds"]
        ]
        console.table(REBOUNDS, rebounds)
        for line in published["restitution_notes"]:
            console.tell(f"- {line}")
    tell_notes(
        (*published["about"], *(() if asked else published["surfaces"])), published["sources"]
    )


def _name_pair(row: Mapping[str, Any]) -> str:
    """Return the two materials of a row as `part on track`."""
    return f"{row['part']} on {row['track']}"
