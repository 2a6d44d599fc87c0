"""A sweep of any size from the command line: room, progress, stopping and going on."""

from __future__ import annotations

import shutil
import time
from pathlib import Path
from typing import Any

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED
from vibrafeed.app.cli.results import show_result, streamed_facts
from vibrafeed.app.cli.studies import interruption, refuse
from vibrafeed.app.cli.targets import REMOVE
from vibrafeed.core.dataset.files import partial
from vibrafeed.core.errors import Problem, VibrafeedError
from vibrafeed.core.kinds import is_whole, not_verified
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.sweep.size import bytes_in_file
from vibrafeed.core.sweep.stream import outline_table, stream
from vibrafeed.core.sweep.targets import is_complete, is_zarr, open_target
from vibrafeed.core.watch import Watch


def run_streamed(
    path: Path,
    sweep: Prepared,
    target: str,
    *,
    compression: bool,
    resume: bool,
    history: str,
    deadline: float | None,
    units: str | None,
) -> tuple[bool, bool, dict[str, Any] | None]:
    """Compute a sweep too large for memory tile by tile, and write each tile to its file at once.

    A tile is a block of cells. If the run is stopped, the finished tiles are kept, and a line says
    how to continue.

    Parameters
    ----------
    path, sweep, target : Path, Prepared, str
        The study's file, the sweep, and the path or URL of its result (NetCDF or Zarr).
    compression, resume : bool
        True to compress NetCDF; True to continue with the tiles of an earlier run.
    history : str
        The attribute `history` of the result: time and command.
    deadline : float or None
        Time of `time.monotonic` at which to stop [s]; None for no limit.
    units : str or None
        Units for printing; None for those of studies.

    Returns
    -------
    tuple of (bool, bool, dict or None)
        True if the result is complete; True if it is verified, too; facts on it for the JSON
        output, None if it is incomplete or existed before.
    """
    if resume and is_complete(target, sweep):
        console.say(f"{path}: {target} is complete already")
        return True, True, None
    size = _check_disk_space(path, sweep, target, compression=compression, resume=resume)
    started = time.perf_counter()
    with interruption() as interrupted:
        with console.progress(f"{path.name}, verifying") as advance:
            table = outline_table(sweep, Watch(advance, interrupted, deadline))
        if not is_whole(table):
            console.fail(f"{path}: it was stopped while cells were verified; nothing is written.")
            return False, False, None
        try:
            growing = open_target(
                target, sweep, table, compression=compression, resume=resume, history=history
            )
        except BlockingIOError:
            refuse({path: [Problem("output", f"another run is writing {target}", "Wait for it")]})
        except FileExistsError as error:
            refuse({path: [Problem("output", str(error), REMOVE)]})
        except OSError as error:
            console.fail(f"{target} cannot be written: {error.strerror or error}.")
            raise typer.Exit(FAILED) from None
        except VibrafeedError as error:
            refuse(
                {
                    path: [
                        Problem("output", str(error), "Or write the result as NetCDF: -o result.nc")
                    ]
                }
            )
        begun, tiles = growing.done, growing.tiles
        if begun:
            console.say(f"  continuing: {begun:,} of {len(tiles):,} tiles were done before")
        try:
            with console.progress(path.name, size) as advance:
                passed, whole = stream(sweep, growing, Watch(advance, interrupted, deadline))
        except OSError as error:
            console.fail(f"{target} cannot be written: {error.strerror or error}.")
            _say_how_to_go_on(target)
            raise typer.Exit(FAILED) from None
        except KeyboardInterrupt:
            whole = False
        finally:
            growing.close()
    if not whole:
        share = growing.done / len(tiles)
        console.fail(
            f"{path}: it was stopped; {growing.done:,} of {len(tiles):,} tiles are done, about "
            f"{round(sweep.cells * share):,} of {sweep.cells:,} cells."
        )
        _say_how_to_go_on(target)
        return False, False, None
    seconds = time.perf_counter() - started
    share = passed.cells / tiles.cells
    facts = streamed_facts(path, target, table, sweep.cells, passed)
    facts |= {"share_of_this_run": share, "seconds": {"computing_and_writing": seconds}}
    console.say(f"{path} -> {target}")
    if share < 1:
        console.say(f"  of the {share:.1%} that this run has computed:")
    show_result(facts, table, units)
    told = f"{sweep.cells:,} cells in {len(tiles):,} tiles, {size / 1e9:.3g} GB: {seconds:.3f} s"
    console.say(f"  {told}")
    return True, not not_verified(table), facts


def _check_disk_space(
    path: Path, sweep: Prepared, target: str, *, compression: bool, resume: bool
) -> int:
    """Print the size of a result and return its bytes; exit if the disk has too little room.

    Space that a stopped run of the same result takes counts as free. `path` is the study's file,
    `target` the path or URL of the result. With `compression`, and for Zarr, the size is an
    estimate; `resume` is not used.
    """
    compressed = compression or is_zarr(target)
    size = bytes_in_file(sweep, compressed=compressed)
    about = "about " if compressed else ""
    line = f"{path}: {sweep.cells:,} cells, {sweep.bytes:,} bytes, {about}{_gb(size)} in the file"
    if "://" in target:
        console.say(line)
        return size
    file = Path(target)
    if is_zarr(target) and file.exists():
        refuse({path: [Problem("output", f"{target} exists already", REMOVE)]})
    free = shutil.disk_usage(file.parent).free
    begun = partial(file)
    if begun.exists():  # what it takes is used again, or given back
        free += sum(one.stat().st_size for one in begun.rglob("*") if one.is_file())
    console.say(f"{line}, {_gb(free)} are free")
    if size > free:
        fix = sweep.what_fits(free / size)
        if not compressed:
            fix += ", or perhaps without --plain"
        message = f"it takes {about}{_gb(size)}, and the disk of {file.parent} has {_gb(free)}"
        refuse({path: [Problem("output", message, fix)]})
    return size


def _say_how_to_go_on(target: str) -> None:
    """Print where the finished tiles are kept, and that `--resume` continues."""
    where = target if "://" in target else partial(Path(target))
    console.fail(f"What is done is kept in {where}. To go on, give the same command with --resume.")


def _gb(size: int) -> str:
    """Return a number of bytes in GB."""
    return f"{size / 1e9:,.3g} GB"
