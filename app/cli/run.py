"""`vibrafeed run`: studies in, NetCDF files or Zarr groups out."""

from __future__ import annotations

import time
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from app.cli.studies import (
    FAILED,
    interruption,
    prepare_all,
    refuse,
    refuse_beyond_memory,
    refuse_clashes,
)
from core.compiling import stopwatch
from core.errors import MissingPackageError, Problem, StoppedError

if TYPE_CHECKING:
    from core.dataset.table import Table
    from core.plan.prepared import Prepared
    from core.sweep import Sweep


def run(
    files: Annotated[list[Path], typer.Argument(help="Studies, TOML or JSON.", show_default=False)],
    output: Annotated[
        str | None,
        typer.Option(
            "-o",
            "--output",
            help="File .nc, .csv or .parquet, or .zarr or s3://bucket/key (one study), or folder; "
            "beside the study if left out.",
        ),
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would run, and how large it is.")
    ] = False,
    plain: Annotated[
        bool, typer.Option("--plain", help="Do not compress NetCDF files: faster, and larger.")
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
    """Carry out studies and write one NetCDF file, or Zarr group, each.

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
    targets = _targets(studies, output)
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
        try:
            _write(table, Path(target), history, plain)
        except OSError as error:
            console.fail(f"{target} cannot be written: {error.strerror or error}.")
            raise typer.Exit(FAILED) from None
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
    from core.dataset.frame import FORMS
    from core.dataset.netcdf import is_large
    from core.plan.tiles import Tiled
    from core.sweep.targets import is_zarr

    if Path(target).suffix in FORMS:
        return False
    return is_zarr(target) or is_large(Tiled(sweep).tiles)


def _write(table: Table, target: Path, history: str, plain: bool) -> None:
    from core.dataset.frame import FORMS, write_frame
    from core.dataset.netcdf import write_netcdf

    if target.suffix in FORMS:
        write_frame(table, target)
    else:
        write_netcdf(table, target, history=history, compression=not plain)


def _history(path: Path) -> str:
    return f"{datetime.now(UTC).isoformat(timespec='seconds')} vibrafeed run {path.name}"


def _is_file(output: str) -> bool:
    return Path(output).suffix in (".nc", ".csv", ".parquet") and not Path(output).is_dir()


def _targets(studies: Mapping[Path, Prepared], output: str | None) -> dict[Path, str]:
    """Return where each result goes; exit if two would go to one place."""
    from core.dataset.frame import pyarrow
    from core.sweep import Sweep
    from core.sweep.targets import is_zarr

    if output is not None and is_zarr(output):
        problem = None
        if len(studies) > 1:
            problem = Problem("output", "a Zarr group is of one study", "Give a folder")
        elif not all(isinstance(one, Sweep) for one in studies.values()):
            problem = Problem(
                "output",
                "only sweeps that keep their cells go to Zarr",
                "Give a name that ends in .nc",
            )
        if problem is not None:
            refuse({path: [problem] for path in studies})
        targets = dict.fromkeys(studies, output)
    elif len(studies) == 1 and output and _is_file(output):
        if output.endswith(".parquet"):
            try:
                pyarrow()
            except MissingPackageError as error:
                refuse({path: [Problem("output", str(error), "Or give .csv")] for path in studies})
        targets = dict.fromkeys(studies, output)
    else:
        targets = {file: str(Path(output or file.parent) / f"{file.stem}.nc") for file in studies}
    refuse_clashes(targets)
    for target in targets.values():
        if "://" in target:
            continue
        folder = Path(target).parent
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            place = Problem("output", f"{folder} cannot be made", str(error.strerror))
            refuse({Path(target): [place]})
    return targets
