"""Text files that commands write: a study, a call."""

from __future__ import annotations

from pathlib import Path

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED
from vibrafeed.app.cli.studies import refuse
from vibrafeed.core.errors import Problem


def refuse_taken(file: Path, option: str, *, force: bool) -> None:
    """Exit if a file exists and `--force` is not given.

    `option` names the argument in the message.
    """
    if file.exists() and not force:
        fix = "Add --force to replace it, or give another name"
        refuse({file: [Problem(option, "the file exists already", fix)]})


def write_text(file: Path, text: str) -> None:
    """Write text to a file; print the reason and exit if it cannot be written."""
    try:
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        console.fail(f"{file}: {error.strerror or error}.")
        raise typer.Exit(FAILED) from None
