"""Parts of the commands that print published values: `friction` and `leaves`."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

import typer

from app.cli import console
from app.cli.options import FAILED


def numbered(sources: Iterable[str]) -> dict[str, str]:
    """Return the number by which a table names each source."""
    return {name: str(number) for number, name in enumerate(sources, 1)}


def joined(*texts: str) -> str:
    """Return the texts of a cell that are not empty, as one."""
    return "; ".join(text for text in texts if text)


def check_some(rows: Collection[Any], asked: str) -> None:
    """Say that there are no rows of some words, and end, if there are none."""
    if not rows:
        console.say(f"No row holds all of: {asked}. Give fewer words, or none to see all rows.")
        raise typer.Exit(FAILED)


def tell_notes(notes: Iterable[str], sources: Mapping[str, Mapping[str, str]]) -> None:
    """Print what to make of a table, and its sources by their numbers."""
    for line in notes:
        console.tell(f"- {line}")
    for name, number in numbered(sources).items():
        source = sources[name]
        console.tell(f"  {number}: {source['title']}. {source['by']}. {source['address']}")
