"""`vibrafeed sheet`: one page about a result, for whoever asks for it."""

from pathlib import Path
from typing import Annotated

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.console import needing
from vibrafeed.app.cli.options import FAILED, Units
from vibrafeed.app.cli.studies import refuse, refuse_existing


def sheet(
    file: Annotated[
        Path,
        typer.Argument(
            help="Result to show on the sheet: a NetCDF file written by `vibrafeed run`.",
            show_default=False,
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="Sheet to write: .pdf, .png or .svg; by default a PDF in the folder of "
            "the result.",
        ),
    ] = None,
    title: Annotated[
        str | None, typer.Option(help="Title of the sheet; by default the title of the study.")
    ] = None,
    units: Units = None,
    force: Annotated[bool, typer.Option("--force", help="Replace an existing sheet.")] = False,
) -> None:
    """Write one page about a result: drive and part, outputs, a picture, assumptions."""
    with needing("plot", "matplotlib"):
        from vibrafeed.core.plots.pictures import PlotError
        from vibrafeed.core.plots.sheet import write_sheet
    target = output or file.with_suffix(".pdf")
    refuse_existing(str(file), str(target), force=force)
    try:
        write_sheet(file, target, title=title or "", units=units)
    except PlotError as error:
        refuse({file: [error.problem]})
    except OSError as error:
        console.fail(f"{error.filename or file}: {error.strerror or error}.")
        raise typer.Exit(FAILED) from None
    typer.echo(f"wrote {target}")
