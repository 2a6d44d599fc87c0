"""Studies carried out one after the other: progress, Ctrl-C, results written and shown."""

from __future__ import annotations

import shutil
import threading
import time
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.by_kind import describe_nearest, has_status
from vibrafeed.app.cli.options import FAILED
from vibrafeed.app.cli.results import facts_of, show_result, verbose_lines
from vibrafeed.app.cli.studies import (
    INTERRUPTED,
    interruptible_compiler,
    interruption,
    refuse,
    refuse_beyond_memory,
)
from vibrafeed.app.cli.targets import REMOVE, is_complete, kept_apart, write_or_exit
from vibrafeed.app.cli.units import units_asked
from vibrafeed.core import kinds, lazy
from vibrafeed.core.compiling import stopwatch
from vibrafeed.core.dataset.files import Storage, partial
from vibrafeed.core.dataset.formats import NETCDF, is_zarr, suffix_of
from vibrafeed.core.dataset.read import read_zarr
from vibrafeed.core.errors import Problem, StoppedError, VibrafeedError
from vibrafeed.core.kinds.results import outline
from vibrafeed.core.plan.pieces import cells_of, run_cost
from vibrafeed.core.watch import Watch

if TYPE_CHECKING:
    from vibrafeed.core.dataset.table import Table
    from vibrafeed.core.plan.prepared import Prepared


@dataclass
class Running:
    """Studies that are carried out one after the other.

    Attributes
    ----------
    resume : bool
        True to go on with stopped runs.
    storage : Storage
        The choices that the formats of results leave.
    units : str or None
        Units for printing.
    checked : float or None
        Seconds that checking the studies took; given with `--verbose` only, which prints more.
    deadline : float or None
        Time of `time.monotonic` at which to stop [s].
    facts : list of dict
        The results so far, as JSON documents.
    solved : bool
        True if every optimisation so far has a solution for some design.
    """

    resume: bool
    storage: Storage
    units: str | None
    checked: float | None
    deadline: float | None
    facts: list[dict[str, Any]] = field(default_factory=list)
    solved: bool = True

    def carry_out(
        self,
        studies: Mapping[Path, Prepared],
        targets: Mapping[Path, str],
        complete: Collection[Path],
    ) -> bool:
        """Compute the studies of a command one after another, and write their results.

        The facts on every result are appended to `self.facts`. A study that is interrupted ends the
        run; the studies that were not carried out are then printed.

        Parameters
        ----------
        studies : mapping of Path to Prepared
            The studies by their files.
        targets : mapping of Path to str
            Path or URL of each study's result, by the study's file.
        complete : collection of Path
            Files of studies whose results exist already, which are not computed again.

        Returns
        -------
        bool
            True if all results are complete and verified.
        """
        verified, remaining = True, list(studies)
        for path, prepared in studies.items():
            target = targets[path]
            if path in complete:
                console.say(f"{path}: {target} is complete already")
                self.facts.append({"study": str(path), "result": target, "complete_before": True})
                remaining.remove(path)
                continue
            if is_stored_in_blocks(prepared, target):
                remaining.remove(path)  # if it is stopped, its own message says how to go on
                whole, is_verified, facts = run_large(
                    path,
                    prepared,
                    target,
                    compression=self.storage.compression,
                    resume=self.resume,
                    history=history_of(path),
                    deadline=self.deadline,
                    units=self.units,
                )
                if facts:
                    self.facts.append(facts)
                    self._say_more(prepared)
                verified &= is_verified
                if not whole:
                    break
                continue
            computed = self._carry_out_study(path, prepared, target)
            if computed is None:
                break
            is_verified, interrupted = computed
            verified &= is_verified
            remaining.remove(path)
            if interrupted:
                break
        if remaining:
            console.fail(
                f"The run was stopped: not carried out are {', '.join(map(str, remaining))}."
            )
        return verified and not remaining

    def _carry_out_study(
        self, path: Path, prepared: Prepared, target: str
    ) -> tuple[bool, bool] | None:
        """Compute and write one result; None if nothing was written.

        Parameters
        ----------
        path : Path
            The study's file.
        prepared : Prepared
            The study, ready to be computed.
        target : str
            The path or URL of the result.

        Returns
        -------
        tuple of bool
            True if the result is complete and verified; True if Ctrl-C was pressed.
        """
        refuse_beyond_memory(path, prepared)
        compiling_before = stopwatch.spent
        begun = threading.Event()
        stopped_early = f"{path}: it was stopped before a cell was computed; nothing is written."
        with (
            console.progress(path.name) as advance,
            interruption(gently=prepared.can_stop, has_begun=begun.is_set) as interrupted,
            interruptible_compiler(stopped_early),
        ):

            def progress(fraction: float) -> None:
                begun.set()  # from now on Ctrl-C keeps what is computed
                advance(fraction)

            try:
                table = kinds.tabulate(prepared, Watch(progress, interrupted, self.deadline))
            except StoppedError as stopped:
                console.fail(f"{path}: {stopped}; nothing is written.")
                return None
            except KeyboardInterrupt:
                stopped_amid = f"{path}: it was stopped at once; nothing is written."
                console.fail(stopped_amid if begun.is_set() else stopped_early)
                raise typer.Exit(INTERRUPTED) from None
        if kinds.share_left_out(table) == 1:
            console.fail(stopped_early)
            return None
        target = kept_apart(target) if not kinds.is_whole(table) else target
        began_writing = time.perf_counter()
        write_or_exit(path, table, target, history_of(path), self.storage)
        seconds = {
            "computing": float(table.price["elapsed_seconds"]),
            "compiling": stopwatch.spent - compiling_before,
            "writing": time.perf_counter() - began_writing,
        }
        facts = facts_of(path, target, table, cells_of(prepared, table)) | {"seconds": seconds}
        self.facts.append(facts)
        self.solved &= not has_status(table, "infeasible")
        console.say(f"{path} -> {target}")
        show_result(facts, table, self.units, everything=self.checked is not None)
        began_searching = time.perf_counter()
        if lines := describe_nearest(table, units_asked(self.units), self.deadline):
            seconds["searching"] = time.perf_counter() - began_searching
        for line in lines:
            console.tell(f"  {line}")
        if facts["cells_computed"] < facts["cells"]:
            options = "--resume" if target.endswith(".nc") else "--resume --force"
            console.fail(f"  The same command with {options} computes the whole study again.")
            if prepared.not_lazy is None:
                console.fail("  A run to Zarr (-o result.zarr) goes on where it was stopped.")
        _say_seconds(facts)
        self._say_more(prepared)
        return kinds.is_whole(table) and not kinds.not_verified(table), interrupted()

    def _say_more(self, prepared: Prepared) -> None:
        if self.checked is not None:
            for line in verbose_lines(prepared, self.checked):
                console.tell(line)


def _say_seconds(facts: Mapping[str, Any]) -> None:
    done, cells, seconds = facts["cells_computed"], facts["cells"], facts["seconds"]
    evaluated = f"{done:,} of {cells:,}" if done < cells else f"{cells:,}"
    noun = "cell" if cells == 1 else "cells"
    searching = seconds.get("searching", 0.0)
    searched = f"nearest designs searched in {searching:.3f} s, " if searching else ""
    console.say(
        f"  {evaluated} {noun} evaluated in {seconds['computing']:.3f} s, {searched}"
        f"written in {seconds['writing']:.3f} s"
    )
    if seconds["compiling"]:
        console.say(f"  compiled in {seconds['compiling']:.1f} s: once, it is kept")


def history_of(path: Path) -> str:
    """Return the first line of the CF attribute `history`: time, program and study."""
    return f"{datetime.now(UTC).isoformat(timespec='seconds')} vibrafeed run {path.name}"


# --- results of any size, block by block

LARGE_BYTES = 1 << 28
"""Bytes of a result above which NetCDF is written block by block, and no ranges are printed."""


def is_stored_in_blocks(prepared: Prepared, target: str) -> bool:
    """True if a result is computed and written block by block."""
    is_large = suffix_of(target) == NETCDF and prepared.bytes > LARGE_BYTES
    return prepared.not_lazy is None and (is_zarr(target) or is_large)


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
        if not kinds.is_whole(table):
            console.fail(f"{path}: it was stopped while cells were verified; nothing is written.")
            return False, False, None
        with (
            console.progress(path.name, prepared.bytes) as advance,
            _reporting(path, target),
        ):
            watch = Watch(advance, interrupted, deadline)
            try:
                if is_zarr(target):
                    _store_zarr(prepared, table, target, watch, history, resume=resume)
                else:
                    lazy.store.store_netcdf(
                        prepared, table, Path(target), watch,
                        history=history, compression=compression,
                    )  # fmt: skip
            except (StoppedError, KeyboardInterrupt):
                _say_how_to_go_on(path, target, prepared)
                return False, False, None
    seconds = time.perf_counter() - started
    is_short = prepared.bytes <= LARGE_BYTES
    table = read_zarr(target) if is_short else replace(table, variables={})
    facts = facts_of(path, target, table, prepared.cells)
    facts["seconds"] = {"computing_and_writing": seconds}
    console.say(f"{path} -> {target}")
    if not is_short:
        console.say(f"  Ranges of values are not printed above {_gb(LARGE_BYTES)}.")
    show_result(facts, table, units)
    console.say(f"  {prepared.cells:,} cells, {_gb(prepared.bytes)}: {seconds:.3f} s")
    return True, not kinds.not_verified(table), facts


def _store_zarr(
    prepared: Prepared, table: Table, target: str, watch: Watch, history: str, *, resume: bool
) -> None:
    group = lazy.store.ZarrStore(prepared, target)
    started = time.perf_counter()
    group.begin(table, resume=resume)
    blocks, missing = len(group.blocks), len(group.missing())
    if missing < blocks:
        done = blocks - missing
        console.say(f"  continuing: {done:,} of {blocks:,} blocks were done before")
    group.store(watch)
    # What the study took is known only if all of it was computed now.
    cost = run_cost(prepared.cells, time.perf_counter() - started) if missing == blocks else {}
    group.finish({"history": history, **cost})


@contextmanager
def _reporting(path: Path, target: str) -> Iterator[None]:
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
        fix = "Write the result as NetCDF: -o result.nc"
        refuse({path: [Problem("output", str(error), fix)]})


def _check_disk_space(path: Path, prepared: Prepared, target: str) -> None:
    """Print the size of a result; exit if even compressed it would not fit on the disk."""
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
    unfinished = partial(file)
    if unfinished.exists():  # what it takes is used again, or given back
        free += sum(part.stat().st_size for part in unfinished.rglob("*") if part.is_file())
    if size > MAX_TIMES_FREE * free:
        message = f"the result takes {_gb(size)} before compression; {file.parent} has only "
        fix = prepared.what_fits(MAX_TIMES_FREE * free / size)
        refuse({path: [Problem("output", f"{message}{_gb(free)} free", fix)]})


MAX_TIMES_FREE = 8.0
"""Times the free space that a result may have before compression: no result was packed better."""


def _say_how_to_go_on(path: Path, target: str, prepared: Prepared) -> None:
    if not is_zarr(target):
        console.fail(f"{path}: it was stopped; nothing is written. A run to Zarr would go on.")
        return
    group = lazy.store.ZarrStore(prepared, target)
    blocks = len(group.blocks)
    done = blocks - len(group.missing())
    cells_done = round(prepared.cells * done / blocks)
    console.fail(
        f"{path}: it was stopped; {done:,} of {blocks:,} blocks are done, about "
        f"{cells_done:,} of {prepared.cells:,} cells."
    )
    location = target if "://" in target else partial(Path(target))
    console.fail(
        f"What is done is kept in {location}. To go on, give the same command with --resume."
    )


def _gb(size: float) -> str:
    return f"{size / 1e9:,.3g} GB"
