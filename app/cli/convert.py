"""`vibrafeed convert`: a study in another form."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vibrafeed.app.cli.studies import (
    content_of,
    name_of,
    refuse,
    refuse_existing,
    warn,
    write_text,
)
from vibrafeed.core.errors import Problem, StudyError

if TYPE_CHECKING:
    from collections.abc import Mapping


def convert(
    file: Annotated[
        Path,
        typer.Argument(
            help="Study file to convert, TOML or JSON; - reads the study from standard input."
        ),
    ],
    to: Annotated[
        str,
        typer.Option(
            help="Format to convert to: toml, json, curl or powershell (commands that post the "
            "study), or python (a program that runs it)."
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="Write the converted study to this file; by default to standard output.",
        ),
    ] = None,
    service: Annotated[
        str | None,
        typer.Option(
            help="Base URL of the service that the command posts to, as in http://localhost:8000."
        ),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Convert a study to TOML, JSON, a command that posts it, or a Python call.

    Units and ranges stay as they were typed; comments are lost. The study is checked first. Exit
    code 2 means that the study or an option is wrong, 1 that the file could not be written.
    """
    from vibrafeed.core.intake.forms import FORMS, SERVICE, resolve_files, write_as
    from vibrafeed.core.suggestions import suggestion

    if to not in FORMS:
        refuse(
            {
                file: [
                    Problem(
                        "to",
                        f"a study cannot be converted to the format '{to[:40]}'",
                        suggestion(to, FORMS),
                    )
                ]
            }
        )
    content = _read_valid_study(file)
    folder = output.parent if output is not None else Path()
    try:
        text = write_as(to, resolve_files(content, to, folder), service or SERVICE)
    except StudyError as error:
        refuse({file: error.problems})
    if output is None:
        typer.echo(text, nl=False)
        return
    refuse_existing(str(file), str(output), force=force)
    write_text(output, text)
    typer.echo(f"wrote {output}")


def _read_valid_study(file: Path) -> "Mapping[str, Any]":
    """Return the content of a valid study file as it was typed; else print every error and exit."""
    from vibrafeed.core.intake import prepare_content

    try:
        content = content_of(file)
        warn(name_of(file), prepare_content(content, files=True).questions)
    except StudyError as error:
        refuse({file: error.problems})
    assert isinstance(content, dict)  # otherwise it was refused
    return content
