"""`vibrafeed run`: studies in, results out, in the format that a suffix names."""

from __future__ import annotations

import time
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.studies import (
    FAILED,
    interruption,
    prepare_all,
    refuse_beyond_memory,
)
from app.cli.targets import targets_of, write_or_exit
from core.compiling import stopwatch
from core.errors import StoppedError

if TYPE_CHECKING:
    from core.sweep import Sweep


def run(
    files: Annotated[list[Path], typer.Argument(help="Studies, TOML or JSON.", show_default=False)],
    output: Annotated[
        str | None,
        typer.Option(
            "-o",
            "--output",
            help="Of one study a file .nc, .csv, .xlsx, .parquet or .mat, or a group .zarr or "
            "s3://bucket/key; or a folder. Beside the study if left out.",
        ),
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would run, and how large it is.")
    ] = False,
    plain: Annotated[
        bool,
        typer.Option("--plain", help="Do not compress NetCDF and MAT files: faster, and larger."),
    ] = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with large sweeps that were stopped or killed.")
    ] = False,
    max_cells: Annotated[
        int | None, typer.Option(help="Largest number of cells of one study.")
    ] = None,
    max_bytes: Annotated[
        int | None, typer.Option(help="Largest number of bytes of one study.")
    ] = None,
    time_limit: Annotated[
        float | None,
        typer.Option(
            help="Seconds after which no further cell is started or verified; a sweep that is not "
            "large is computed as a whole.",
            min=0,
        ),
    ] = None,
    part: Annotated[
        str | None,
        typer.Option(
            help="Compute one part of a sweep, such as 17/4096, from 0 on; `vibrafeed join` makes "
            "the result of all."
        ),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(help="Have the parts of a sweep computed by the Dask scheduler there."),
    ] = None,
    parts: Annotated[
        int | None, typer.Option(min=1, help="Number of parts, with --scheduler.")
    ] = None,
) -> None:
    """Carry out studies and write one file each: NetCDF, or what the suffix of the output names.

    All files are checked before the first is run. Exit code 2 means that a file is wrong, 1 that
    a result could not be written, that a verification failed, or that a study was stopped, by
    Ctrl-C or the time limit, while it was computed or verified: what was finished is written, of a
    large sweep where --resume finds it.
    """
    from app.cli import console, tables

    studies = prepare_all(files, cells=max_cells, bytes_=max_bytes)
    if dry_run:
        for path, prepared in studies.items():
            tables.show_plan(path, prepared)
        return
    targets = targets_of(studies, output)
    if part is not None or scheduler is not None:
        from app.cli.parts import run_on_scheduler, run_part

        if part is not None:
            run_part(studies, targets, part)
        elif scheduler is not None:
            run_on_scheduler(studies, targets, scheduler, parts, _history(files[0]))
        return
    from core.kinds import is_whole, not_verified, tabulate
    from core.sweep import Sweep
    from core.watch import Watch

    deadline = None if time_limit is None else time.monotonic() + time_limit
    sound, left, compiled = True, list(studies), stopwatch.spent
    for path, prepared in studies.items():
        history = _history(path)
        target = targets[path]
        if isinstance(prepared, Sweep) and _is_streamed(prepared, target):
            from app.cli.streamed import run_streamed

            left.remove(path)
            whole, is_sound = run_streamed(
                path,
                prepared,
                target,
                compression=not plain,
                resume=resume,
                history=history,
                deadline=deadline,
            )
            sound &= is_sound
            if not whole:
                break
            continue
        refuse_beyond_memory(path, prepared)
        with (
            console.progress(path.name) as advance,
            interruption(gently=not isinstance(prepared, Sweep)) as interrupted,
        ):
            try:
                table = tabulate(prepared, Watch(advance, interrupted, deadline))
            except StoppedError as stopped:
                console.fail(f"{path}: {stopped}; nothing is written.")
                break
        evaluated = time.perf_counter()
        write_or_exit(path, table, target, history, compression=not plain)
        written = time.perf_counter()
        seconds = float(table.price["elapsed_seconds"])
        tables.show_table(path, target, table, prepared.cells, seconds, written - evaluated)
        if stopwatch.spent > compiled:
            console.say(f"  compiled in {stopwatch.spent - compiled:.1f} s: once, it is kept")
            compiled = stopwatch.spent
        sound &= is_whole(table) and not not_verified(table)
        left.remove(path)
        if interrupted():
            break
    if left:
        console.fail(f"It was stopped: not carried out are {', '.join(map(str, left))}.")
    if left or not sound:
        raise typer.Exit(FAILED)


def _is_streamed(sweep: Sweep, target: str) -> bool:
    """Return whether a sweep is written tile by tile, in place of being held in memory."""
    from core.dataset.formats import NETCDF, ZARR, suffix_of
    from core.dataset.netcdf import is_large
    from core.plan.tiles import Tiled

    suffix = suffix_of(target)
    return suffix == ZARR or (suffix == NETCDF and is_large(Tiled(sweep).tiles))


def _history(path: Path) -> str:
    return f"{datetime.now(UTC).isoformat(timespec='seconds')} vibrafeed run {path.name}"
