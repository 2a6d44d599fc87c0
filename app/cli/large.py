"""A result of any size from the command line: room, progress, stopping and going on."""

from __future__ import annotations

import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED
from vibrafeed.app.cli.results import large_facts, show_result
from vibrafeed.app.cli.studies import interruption, refuse
from vibrafeed.app.cli.targets import REMOVE, is_complete
from vibrafeed.core import lazy
from vibrafeed.core.dataset.files import partial
from vibrafeed.core.dataset.formats import NETCDF, is_zarr, suffix_of
from vibrafeed.core.errors import Problem, StoppedError, VibrafeedError
from vibrafeed.core.kinds import is_whole, not_verified
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.plan.pieces import run_cost
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.watch import Watch

if TYPE_CHECKING:
    from vibrafeed.core.dataset.table import Table
    from vibrafeed.core.lazy.store import Written

LARGE_BYTES = 1 << 28
"""Bytes of a result from which on NetCDF is written block by block."""


def is_stored_in_blocks(prepared: Prepared, target: str) -> bool:
    """True if a result is computed and written block by block."""
    if prepared.not_lazy is not None:
        return False
    return is_zarr(target) or (suffix_of(target) == NETCDF and prepared.bytes > LARGE_BYTES)


def run_large(
    path: Path,
    prepared: Prepared,
    target: str,
    *,
    compression: bool,
    resume: bool,
    history: str,
    deadline: float | None,
    units: str | None,
) -> tuple[bool, bool, dict[str, Any] | None]:
    """Compute a study block by block, and write each block to its file at once.

    If the run is stopped, the finished blocks of a Zarr group are kept, and a line says how to
    continue.

    Parameters
    ----------
    path, prepared, target : Path, Prepared, str
        The study's file, the study, and the path or URL of its result (NetCDF or Zarr).
    compression, resume : bool
        True to compress NetCDF; True to continue with the blocks of an earlier run.
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
    if resume and is_complete(target, prepared):
        console.say(f"{path}: {target} is complete already")
        return True, True, None
    _check_disk_space(path, prepared, target)
    started = time.perf_counter()
    with interruption() as interrupted:
        with console.progress(f"{path.name}, verifying") as advance:
            table = outline(prepared, Watch(advance, interrupted, deadline))
        if not is_whole(table):
            console.fail(f"{path}: it was stopped while cells were verified; nothing is written.")
            return False, False, None
        with console.progress(path.name, prepared.bytes) as advance, _explained(path, target):
            watch = Watch(advance, interrupted, deadline)
            try:
                if is_zarr(target):
                    written = _to_zarr(prepared, table, target, watch, history, resume=resume)
                else:
                    written = lazy.store.store_netcdf(
                        prepared, table, Path(target), watch,
                        history=history, compression=compression,
                    )  # fmt: skip
            except (StoppedError, KeyboardInterrupt):
                _say_how_to_go_on(path, target, prepared)
                return False, False, None
    seconds = time.perf_counter() - started
    table = lazy.store.whole_table(prepared, table)
    facts = large_facts(path, target, table, prepared.cells, written)
    share = min(1.0, written.cells / lazy.store.points_of(prepared))
    facts |= {"share_of_this_run": share, "seconds": {"computing_and_writing": seconds}}
    console.say(f"{path} -> {target}")
    if share < 1:
        console.say(f"  of the {share:.1%} that this run has computed:")
    show_result(facts, table, units)
    console.say(f"  {prepared.cells:,} cells, {_gb(prepared.bytes)}: {seconds:.3f} s")
    return True, not not_verified(table), facts


def _to_zarr(
    prepared: Prepared, table: Table, target: str, watch: Watch, history: str, *, resume: bool
) -> Written:
    group = lazy.store.ZarrStore(prepared, target)
    started = time.perf_counter()
    group.begin(table, resume=resume)
    blocks, missing = len(lazy.store.Blocks(prepared)), len(group.missing())
    if missing < blocks:
        done = blocks - missing
        console.say(f"  continuing: {done:,} of {blocks:,} blocks were done before")
    written = group.store(watch)
    cost = run_cost(prepared.cells, time.perf_counter() - started) if missing == blocks else {}
    group.finish({"history": history, **cost})
    return written


@contextmanager
def _explained(path: Path, target: str) -> Iterator[None]:
    """Print errors of files and stores that are raised in the block, and exit."""
    try:
        yield
    except FileExistsError as error:
        refuse({path: [Problem("output", str(error), REMOVE)]})
    except OSError as error:
        console.fail(f"{target} cannot be written: {error.strerror or error}.")
        if is_zarr(target):
            console.fail("What is done is kept; the same command with --resume goes on.")
        raise typer.Exit(FAILED) from None
    except VibrafeedError as error:
        fix = "Or write the result as NetCDF: -o result.nc"
        refuse({path: [Problem("output", str(error), fix)]})


def _check_disk_space(path: Path, prepared: Prepared, target: str) -> None:
    """Print the size of a result; exit if the disk has less room than a quarter of it."""
    size = prepared.bytes
    line = f"{path}: {prepared.cells:,} cells, {size:,} bytes before compression"
    if not is_zarr(target):
        line += "; a run to NetCDF that is stopped begins anew, one to Zarr (-o x.zarr) goes on"
    if "://" in target:
        console.say(line)
        return
    file = Path(target)
    free = shutil.disk_usage(file.parent).free
    console.say(f"{line}; {_gb(free)} are free")
    begun = partial(file)
    if begun.exists():  # what it takes is used again, or given back
        free += sum(one.stat().st_size for one in begun.rglob("*") if one.is_file())
    if size > SMALLEST_SHARE * free:
        message = f"it takes {_gb(size)} before compression; the disk of {file.parent} has "
        fix = prepared.what_fits(SMALLEST_SHARE * free / size)
        refuse({path: [Problem("output", message + _gb(free), fix)]})


SMALLEST_SHARE = 8.0
"""Times the free space that a result may have before compression: no result was packed better."""


def _say_how_to_go_on(path: Path, target: str, prepared: Prepared) -> None:
    if not is_zarr(target):
        console.fail(f"{path}: it was stopped; nothing is written. A run to Zarr would go on.")
        return
    blocks = len(lazy.store.Blocks(prepared))
    done = blocks - len(lazy.store.ZarrStore(prepared, target).missing())
    share = round(prepared.cells * done / blocks)
    console.fail(
        f"{path}: it was stopped; {done:,} of {blocks:,} blocks are done, about "
        f"{share:,} of {prepared.cells:,} cells."
    )
    where = target if "://" in target else partial(Path(target))
    console.fail(f"What is done is kept in {where}. To go on, give the same command with --resume.")


def _gb(size: float) -> str:
    """Return a number of bytes in GB."""
    return f"{size / 1e9:,.3g} GB"
