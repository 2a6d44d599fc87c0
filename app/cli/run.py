"""`vibrafeed run`: studies in, NetCDF files out."""

from __future__ import annotations

import time
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer

from app.cli.studies import FAILED, interruption, prepare_all, refuse, refuse_clashes
from core.errors import Problem

MOST_CELLS = 100_000_000
MOST_BYTES = 8_000_000_000


def run(
    files: Annotated[list[Path], typer.Argument(help="Studies, TOML or JSON.", show_default=False)],
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", help="File (one study) or folder; beside the study if left out."
        ),
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would run, and how large it is.")
    ] = False,
    max_cells: Annotated[
        int, typer.Option(help="Largest number of cells of one study.")
    ] = MOST_CELLS,
    max_bytes: Annotated[
        int, typer.Option(help="Largest number of bytes of one study.")
    ] = MOST_BYTES,
    time_limit: Annotated[
        float | None,
        typer.Option(
            help="Seconds after which no further cell is started or verified; a sweep is computed "
            "as a whole.",
            min=0,
        ),
    ] = None,
) -> None:
    """Carry out studies and write one NetCDF file each.

    All files are checked before the first is run. Exit code 2 means that a file is wrong, 1 that
    a result could not be written, that a verification failed, or that a study was stopped, by
    Ctrl-C or the time limit, while it was computed or verified: what was finished is written.
    """
    from app.cli import console, tables

    studies = prepare_all(files, cells=max_cells, bytes_=max_bytes)
    if dry_run:
        for path, prepared in studies.items():
            tables.show_plan(path, prepared)
        return
    targets = _targets(list(studies), output)
    from core.dataset.netcdf import write_netcdf
    from core.kinds import is_whole, not_verified, tabulate
    from core.watch import Watch

    deadline = None if time_limit is None else time.monotonic() + time_limit
    sound, left = True, list(studies)
    for path, prepared in studies.items():
        with (
            console.progress(path.name) as advance,
            interruption(prepared.study.kind) as interrupted,
        ):
            table = tabulate(prepared, Watch(advance, interrupted, deadline))
        evaluated = time.perf_counter()
        stamp = datetime.now(UTC).isoformat(timespec="seconds")
        try:
            write_netcdf(table, targets[path], history=f"{stamp} vibrafeed run {path.name}")
        except OSError as error:
            console.fail(f"{targets[path]} cannot be written: {error.strerror or error}.")
            raise typer.Exit(FAILED) from None
        written = time.perf_counter()
        seconds = float(table.price["elapsed_seconds"])
        tables.show_table(path, targets[path], table, prepared.cells, seconds, written - evaluated)
        sound &= is_whole(table) and not not_verified(table)
        left.remove(path)
        if interrupted():
            break
    if left:
        console.fail(f"It was stopped: not carried out are {', '.join(map(str, left))}.")
    if left or not sound:
        raise typer.Exit(FAILED)


def _targets(files: Sequence[Path], output: Path | None) -> dict[Path, Path]:
    """Return where each result goes; exit if two would go to one place."""
    if output is not None and len(files) == 1 and not output.is_dir() and output.suffix == ".nc":
        targets = {files[0]: output}
    else:
        targets = {file: (output or file.parent) / f"{file.stem}.nc" for file in files}
    refuse_clashes(targets)
    for target in targets.values():
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            place = Problem("output", f"{target.parent} cannot be made", str(error.strerror))
            refuse({target: [place]})
    return targets
