"""Shares of a sweep, computed by a Dask scheduler elsewhere."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import distributed

from vibrafeed.app.cli import console
from vibrafeed.app.cli.shares import counts_of, join_shares, report_errors, shares_of, single_study
from vibrafeed.app.cli.studies import interruption
from vibrafeed.app.jobs.shares import compute_share, sensible_count
from vibrafeed.core.errors import StoppedError

if TYPE_CHECKING:
    from vibrafeed.core.plan.prepared import Prepared


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
