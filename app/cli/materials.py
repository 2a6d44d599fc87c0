"""`vibrafeed materials`: published friction, restitution and leaf springs."""

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED, Json
from vibrafeed.core.materials import OF_LEAVES, friction, leaf_springs, shown

PAIRS = ("pair", "surface", "static", "kinetic", "from")
REBOUNDS = ("pair", "restitution", "note", "from")
LEAVES = ("material", "form", "elastic modulus (GPa)", "density (kg/m³)", "from")


def materials(
    words: Annotated[
        list[str] | None,
        typer.Argument(help="Show only rows that contain all of these words, as in: steel abs."),
    ] = None,
    leaves: Annotated[
        bool,
        typer.Option("--leaves", help="Print moduli and densities of leaf springs instead."),
    ] = False,
    as_json: Json = False,
) -> None:
    """Print published coefficients of friction and restitution, with their sources."""
    search = " ".join(word for word in " ".join(words or ()).split() if word != "on")
    table = (leaf_springs if leaves else friction)(search)
    if as_json:
        console.document(table)
        return
    keys = ("materials",) if leaves else ("pairs", "rebounds")
    if not any(table[key] for key in keys):
        console.say(f"No row holds all of: {search}. Give fewer words, or none to see all rows.")
        raise typer.Exit(FAILED)
    numbers = {name: str(number) for number, name in enumerate(table["sources"], 1)}
    if leaves:
        cells = [
            (
                row["material"],
                _join_texts(row["form"], row["note"]),
                *(shown(row, name) for name in OF_LEAVES),
                numbers[row["source"]],
            )
            for row in table["materials"]
        ]
        console.table(LEAVES, cells)
    else:
        _show_friction(table, numbers)
    more = () if leaves or search else table["surfaces"]
    for line in (*table["about"], *more):
        console.tell(f"- {line}")
    for name, number in numbers.items():
        source = table["sources"][name]
        console.tell(f"  {number}: {source['title']}. {source['by']}. {source['address']}")


def _show_friction(table: Mapping[str, Any], numbers: Mapping[str, str]) -> None:
    if table["pairs"]:
        rows = []
        for row in table["pairs"]:
            surface = _join_texts(row["surface"], row["note"])
            # A coefficient of which the source does not say which it is stands in both columns.
            unspecified = shown(row, "coefficient")
            default = f"{unspecified} ?" if unspecified else ""
            static, kinetic = (shown(row, name) or default for name in ("static", "kinetic"))
            rows.append((_name_pair(row), surface, static, kinetic, numbers[row["source"]]))
        console.table(PAIRS, rows)
        if any(row["coefficient"] for row in table["pairs"]):
            console.tell("  ?: the source does not say whether it is static or kinetic.")
    if table["rebounds"]:
        rebounds = [
            (_name_pair(row), shown(row, "restitution"), row["note"], numbers[row["source"]])
            for row in table["rebounds"]
        ]
        console.table(REBOUNDS, rebounds)
        for line in table["restitution_notes"]:
            console.tell(f"- {line}")


def _name_pair(row: Mapping[str, Any]) -> str:
    return f"{row['part']} on {row['track']}"


def _join_texts(*texts: str) -> str:
    return "; ".join(text for text in texts if text)
