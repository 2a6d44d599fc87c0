"""`vibrafeed friction`: published coefficients of friction."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rich.table import Table as Grid

LONGEST = 15
"""Letters of the longest name of a material, which stays whole."""


def friction(
    words: Annotated[
        list[str] | None,
        typer.Argument(help="Rows that hold all of these words, as in: steel abs."),
    ] = None,
) -> None:
    """Print published coefficients of friction and restitution, with their sources."""
    from app.cli.console import new_grid, say, stdout
    from core.materials import friction, shown

    asked = " ".join(words or ())
    found = friction(asked)
    if not (found["pairs"] or found["rebounds"]):
        say(f"No row holds all of: {asked}. Give fewer words, or none to see all rows.")
        raise typer.Exit(1)
    numbers = {name: str(number) for number, name in enumerate(found["sources"], 1)}
    if found["pairs"]:
        grid = new_grid("pair", "surface", "static", "kinetic", "from")
        for row in found["pairs"]:
            surface = "; ".join(text for text in (row["surface"], row["note"]) if text)
            either = shown(row, "coefficient") and shown(row, "coefficient") + " ?"
            static, kinetic = shown(row, "static") or either, shown(row, "kinetic") or either
            grid.add_row(_pair(row), surface, static, kinetic, numbers[row["source"]])
        _print(grid)
        if any(row["coefficient"] for row in found["pairs"]):
            stdout.print("?: the source does not tell whether it is static or kinetic.\n")
    if found["rebounds"]:
        grid = new_grid("pair", "restitution", "note", "from")
        for row in found["rebounds"]:
            restitution = shown(row, "restitution")
            grid.add_row(_pair(row), restitution, row["note"], numbers[row["source"]])
        _print(grid)
        _tell(found["restitution_notes"])
    _tell(found["about"])
    if not asked:
        _tell(found["surfaces"])
    for name, source in found["sources"].items():
        say(f"  {numbers[name]}: {source['title']}. {source['by']}. {source['address']}")


def _pair(row: Mapping[str, Any]) -> str:
    return f"{row['part']} on {row['track']}"


def _print(grid: Grid) -> None:
    """Print a table whose cells are folded where the console is narrow."""
    from app.cli.console import stdout

    for number, column in enumerate(grid.columns):
        column.no_wrap, column.overflow = column is grid.columns[-1], "fold"
        column.min_width = None if number else LONGEST
    stdout.print(grid)


def _tell(lines: Iterable[str]) -> None:
    """Print sentences as a list, folded at the width of the console."""
    from app.cli.console import stdout

    for line in lines:
        stdout.print(f"- {line}", markup=False)
    stdout.print()
