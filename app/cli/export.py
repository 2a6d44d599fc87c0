"""`vibrafeed export`: a result in another format."""

from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Literal

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED, INVALID_INPUT, CsvStyle
from vibrafeed.app.cli.studies import refuse, refuse_existing
from vibrafeed.core.errors import LimitError, Problem, VibrafeedError

FOR_PEOPLE = (".csv", ".xlsx", ".parquet")
"""Formats that may hold other units than those of files."""


def export(
    file: Annotated[
        str,
        typer.Argument(
            help="Result to convert: a NetCDF file or Zarr group written by `vibrafeed run`.",
            show_default=False,
        ),
    ],
    output: Annotated[
        str,
        typer.Option(
            "-o",
            "--output",
            help="File to write; its suffix sets the format: .csv, .xlsx, .parquet, .mat, "
            ".nc, or .zarr for a Zarr group.",
        ),
    ],
    units: Annotated[
        str | None,
        typer.Option(
            help="Units of the values, for CSV, XLSX and Parquet only: trade (mm, mm/s, "
            "g), si, or a list such as 'm/min, mm'; by default the units of the "
            "result."
        ),
    ] = None,
    csv_style: CsvStyle = "plain",
    zarr_version: Annotated[
        Literal["2", "3"],
        typer.Option(help="Version of a Zarr group; some programs read only version 2."),
    ] = "3",
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Convert a result to another format, given by the suffix of the output.

    Nothing is computed again. Exit code 2 means that the file is not a result, or too large for
    the format, 1 that a file could not be read or written.
    """
    from vibrafeed.app.cli.targets import (
        check_suffix,
        make_folder_of,
        refuse_choices,
        write_or_exit,
    )
    from vibrafeed.app.cli.units import units_asked
    from vibrafeed.core.dataset.files import Storage
    from vibrafeed.core.dataset.formats import read_result, suffix_of
    from vibrafeed.core.dataset.shown import in_shown_units
    from vibrafeed.core.dataset.table import Table
    from vibrafeed.core.system import memory

    check_suffix(output)
    storage = Storage(csv_style=csv_style, zarr_version=3 if zarr_version == "3" else 2)
    refuse_choices(storage, [output])
    refuse_existing(file, output, force=force)
    shown = None if units is None else units_asked(units)
    if shown is not None and suffix_of(output) not in FOR_PEOPLE:
        message = f"the units of {suffix_of(output)} files cannot be chosen"
        fix = f"Remove --units, or export to {' or '.join(FOR_PEOPLE)}"
        refuse({Path(output): [Problem("--units", message, fix)]})
    try:
        table = read_result(file, most_bytes=memory())
    except LimitError as error:
        refuse({Path(file): [Problem("file", error.message, error.fix)]})
    except VibrafeedError as error:
        console.fail(f"{file}: {error}.")
        raise typer.Exit(INVALID_INPUT) from None
    except OSError as error:
        console.fail(f"{file} cannot be read: {error.strerror or error}.")
        raise typer.Exit(FAILED) from None
    if shown is not None:
        table = Table.of_xarray(in_shown_units(table.to_xarray(), shown))
    if "://" not in output:
        make_folder_of(output)
    old_history = str(table.attributes.get("history", ""))
    attributes = {name: value for name, value in table.attributes.items() if name != "history"}
    stamp = datetime.now(UTC).isoformat(timespec="seconds")
    history = f"{stamp} vibrafeed export {Path(file).name}\n{old_history}".rstrip()
    write_or_exit(Path(file), replace(table, attributes=attributes), output, history, storage)
    console.say(f"{file} -> {output}")
