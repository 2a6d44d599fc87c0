"""Text files that commands write: a study, a call."""

from __future__ import annotations

from pathlib import Path

import typer

from app.cli import console
from app.cli.options import FAILED
from app.cli.studies import refuse
from core.errors import Problem


def refuse_taken(file: Path, option: str, *, force: bool) -> None:
    """Exit if a file is there already; `place` is the argument or option that names it."""
    if file.exists() and not force:
        fix = "Add --force to replace it, or give another name"
        refuse({file: [Problem(option, "it is there already", fix)]})


def write_text(file: Path, text: str) -> None:
    """Write a text; say why and exit if it cannot be written."""
    try:
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        console.fail(f"{file}: {error.strerror or error}.")
        raise typer.Exit(FAILED) from None
