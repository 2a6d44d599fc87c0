"""Shares of sweeps: one of them, all on a Dask scheduler elsewhere, and their joining."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED
from vibrafeed.app.cli.studies import interruption, refuse
from vibrafeed.app.cli.targets import refuse_others
from vibrafeed.core.dataset.records import Records
from vibrafeed.core.errors import Problem, StoppedError, VibrafeedError
from vibrafeed.core.plan.shares import ARRAYS, MAX_SHARES, SHARDS, SharesMissingError, ranges
from vibrafeed.core.sweep.targets import is_zarr
from vibrafeed.core.watch import Watch

if TYPE_CHECKING:
    from vibrafeed.core.plan.prepared import Prepared
    from vibrafeed.core.plan.shares import Shares

_OF = re.compile(r"\d+-of-(\d+)")
_SHARE = re.compile(r"(\d{1,9})/(\d{1,9})")


def run_share(studies: Mapping[Path, Prepared], targets: Mapping[Path, str], share: str) -> None:
    """Compute one share of a study and store its record; a share with a record is skipped.

    Shares are computed by separate runs, perhaps on other machines, and joined later. `share` is
    typed as `k/n`, with k from 0. `studies` and `targets` (paths or URLs of results) are by the
    study's file, and have one entry.
    """
    path, target = single_study(studies, targets)
    number, count = _numbers(path, share)
    shares = shares_of(path, studies[path], target, count)
    name = f"share {number} of {count:,}"
    with report_errors(path, target):
        if shares.is_there(number):
            console.say(f"{path}: {name} exists already")
            return
        started = time.perf_counter()
        with console.progress(f"{path.name}, {name}") as advance, interruption() as interrupted:
            record = shares.compute(number, Watch(advance, interrupted))
        shares.keep(number, record)
    first, last = shares.ends(number)
    seconds = time.perf_counter() - started
    console.say(f"{path}: {name}, {last - first:,} boxes: {seconds:.1f} s")


def run_on_scheduler(
    studies: Mapping[Path, Prepared],
    targets: Mapping[Path, str],
    address: str,
    count: int | None,
    history: str,
) -> None:
    """Compute all missing shares of a study on a Dask cluster, and join them into its result.

    Parameters
    ----------
    studies, targets : mapping
        The study and the path or URL of its result, by the study's file; one entry.
    address : str
        Address of the Dask scheduler.
    count : int or None
        Number of shares; by default that of stored shares, else one that suits the study.
    history : str
        The CF attribute of the result.
    """
    import distributed

    from vibrafeed.app.jobs.shares import compute_share, sensible_count

    path, target = single_study(studies, targets)
    target = target if "://" in target else str(Path(target).resolve())
    sweep = studies[path]
    shares_of(path, sweep, target, 1)  # which it may not have there
    begun = counts_of(target)
    if count is None:
        count = begun.pop() if len(begun) == 1 else sensible_count(sweep)
    shares = shares_of(path, sweep, target, count)
    missing = [share for share in range(count) if not shares.is_there(share)]
    console.say(f"{path}: {len(missing):,} of {count:,} shares to compute on {address}")
    with (
        report_errors(path, target),
        distributed.Client(address, timeout=20) as client,  # type: ignore[no-untyped-call]
        interruption() as interrupted,
        console.progress(path.name) as advance,
    ):
        study = sweep.study.canonical()
        numbers = {
            client.submit(compute_share, study, target, count, share, pure=False, retries=2): share
            for share in missing
        }
        done = distributed.as_completed(list(numbers), with_results=True)  # type: ignore[no-untyped-call]
        for future, record in done:
            if interrupted():
                client.cancel(list(numbers))
                raise StoppedError(
                    "the sweep was stopped; run the same command again to compute what is missing"
                )
            shares.keep(numbers.pop(future), record)
            advance(1 / len(missing))
    join_shares(path, shares, history)


def join_if_there(
    studies: Mapping[Path, Prepared], targets: Mapping[Path, str], count: int | None, *, force: bool
) -> dict[str, Any] | None:
    """Join the shares that lie beside the result of a single study; return facts, None without any.

    Parameters
    ----------
    studies, targets : mapping
        The studies and the paths or URLs of their results, by the study's file.
    count : int or None
        Number of shares; None if that of the stored ones is the only one.
    force : bool
        True to replace the result of another study.
    """
    if len(studies) > 1:
        return None
    ((path, target),) = targets.items()
    asked = set() if count is None else {count}  # an object store is not looked at unasked
    counts = asked if "://" in target else counts_of(target)
    if not counts:
        return None
    if count is None and len(counts) > 1:
        told = f"there are shares of {', '.join(map(str, sorted(counts)))} beside {target}"
        refuse({path: [Problem("shares", told, "Give --shares")]})
    refuse_others(studies, targets, force=force)
    stamp = datetime.now(UTC).isoformat(timespec="seconds")
    shares = shares_of(path, studies[path], target, count or counts.pop())
    join_shares(path, shares, f"{stamp} vibrafeed run {path.name}")
    facts = {"study": str(path), "result": shares.where, "cells": shares.cells}
    return facts | {"shares": shares.count}


def join_shares(path: Path, shares: Shares, history: str) -> None:
    """Join the computed shares of a study into its result, and print the size of the result.

    A share are those cells that a process of its own, such as a job of a cluster, has computed
    and stored. If shares are missing or damaged, their numbers are printed, and the command exits.

    Parameters
    ----------
    path : Path
        The study's file, for messages.
    shares : Shares
        The shares, which know the place of the result (`where`).
    history : str
        The attribute `history` of the result: time and command.
    """
    with report_errors(path, shares.where):
        try:
            with console.progress(f"{path.name}, joining") as advance, interruption() as stopped:
                table = shares.join(Watch(advance, stopped), history=history)
        except SharesMissingError as error:
            console.fail(f"{path}: of {shares.count:,} shares {error}.")
            again = ranges(error.numbers)
            console.fail(f"Compute these again (--array={again}), then run the study again.")
            raise typer.Exit(FAILED) from None
    console.say(
        f"{path} -> {shares.where}: {shares.cells:,} cells in {shares.count:,} shares, "
        f"{len(table.variables)} variables"
    )


def single_study(studies: Mapping[Path, Prepared], targets: Mapping[Path, str]) -> tuple[Path, str]:
    """Return the study's file and the result's path for a command that takes one study.

    `studies` and `targets`, the paths or URLs of results, are by the study's file. Exit if there
    are several.
    """
    if len(studies) > 1:
        problem = Problem(
            "share",
            f"this command computes the shares of one study, not of {len(studies)} studies",
            "Give one study file",
        )
        refuse({path: [problem] for path in studies})
    return next(iter(targets.items()))


def shares_of(path: Path, prepared: Prepared, target: str, count: int) -> Shares:
    """Divide the cells of a study into `count` shares that separate processes compute.

    Exits with the problem if that is impossible: a study that is no sweep, a result that is not
    Zarr (of a plain sweep) or not NetCDF (of a reduced one), or a count outside 1 to `MAX_SHARES`.

    Parameters
    ----------
    path : Path
        The study's file, for messages.
    prepared : Prepared
        The study, ready to be computed.
    target : str
        Path or URL of the result.
    count : int
        Number of shares.
    """
    problem = None
    if not prepared.shares_as:
        problem = Problem(
            "kind",
            "only sweeps can be computed in shares, not studies of this kind",
            "Leave out --share or --scheduler",
        )
    elif prepared.shares_as == SHARDS and not is_zarr(target):
        message = "the shares of a sweep are written as shards of one Zarr group"
        problem = Problem(
            "output",
            message,
            "Write the result to a Zarr group: -o result.zarr, or -o s3://bucket/key",
        )
    elif prepared.shares_as == ARRAYS and is_zarr(target):
        problem = Problem(
            "output",
            "the shares of a reduced sweep ([reduce]) are joined in a NetCDF file, not "
            "in a Zarr group",
            "Write -o result.nc",
        )
    elif not 1 <= count <= MAX_SHARES:
        problem = Problem("share", f"{count:,} shares", f"Take 1 to {MAX_SHARES:,}")
    else:
        return prepared.shares(target, count)
    return refuse({path: [problem]})


def _numbers(path: Path, share: str) -> tuple[int, int]:
    """Return the numbers k and n of a share typed as `k/n`; exit if the text is not of this form.

    `path` is the study's file, which the message names.
    """
    found = _SHARE.fullmatch(share)
    number, count = (int(found[1]), int(found[2])) if found else (0, 0)
    if number < count:
        return number, count
    message = f"'{share[:40]}' is not a share"
    fix = "Shares are numbered from 0: write 0/4096 for the first, 4095/4096 for the last"
    return refuse({path: [Problem("share", message, fix)]})


def counts_of(target: str) -> set[int]:
    """Return the counts of shares that results of this target were cut into, from their records."""
    names = Records(target).names()
    return {int(found[1]) for name in names if (found := _OF.fullmatch(name))}


@contextmanager
def report_errors(path: Path, target: str) -> Iterator[None]:
    """Print errors of files and clusters that are raised in the block, and exit with code 1.

    `path` is the study's file; `target` is the path or URL of its result.
    """
    try:
        yield
    except OSError as error:
        console.fail(f"{target} cannot be written: {error.strerror or error}.")
    except VibrafeedError as error:
        console.fail(f"{path}: {error}.")
    else:
        return
    raise typer.Exit(FAILED)
