"""Parts of the commands that print published values: `friction` and `leaves`."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED


def number_sources(sources: Iterable[str]) -> dict[str, str]:
    """Return the number under which a table cites each source."""
    return {name: str(number) for number, name in enumerate(sources, 1)}


def join_texts(*texts: str) -> str:
    """Return the texts that are not empty, joined into one cell of a table."""
    return "; ".join(text for text in texts if text)


def exit_if_empty(rows: Collection[Any], asked: str) -> None:
    """Exit with a message if there are no rows, as none contains the words `asked`."""
    if not rows:
        console.say(f"No row holds all of: {asked}. Give fewer words, or none to see all rows.")
        raise typer.Exit(FAILED)


def tell_notes(notes: Iterable[str], sources: Mapping[str, Mapping[str, str]]) -> None:
    """Print the notes on a table of published values, and its sources with their numbers.

    `notes` are sentences; `sources` holds title, authors (`by`) and address of each source, by
    name.
    """
    for line in notes:
        console.tell(f"- {line}")
    for name, number in number_sources(sources).items():
        source = sources[name]
        console.tell(f"  {number}: {source['title']}. {source['by']}. {source['address']}")
