"""Parts of a sweep, computed by a Dask scheduler elsewhere."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import distributed

from app.cli import console
from app.cli.parts import counts_of, join_parts, parts_of, report_errors, single_study
from app.cli.studies import interruption
from app.jobs.cluster import by_name
from app.jobs.parts import compute_part, sensible_count
from core.errors import StoppedError

if TYPE_CHECKING:
    from core.plan.prepared import Prepared


def run_on_scheduler(
    studies: Mapping[Path, Prepared],
    targets: Mapping[Path, str],
    address: str,
    count: int | None,
    history: str,
) -> None:
    """Compute all missing parts of a study on a Dask cluster, and join them into its result.

    Parameters
    ----------
    studies, targets : mapping
        The study and the path or URL of its result, by the study's file; one entry.
    address : str
        Address of the Dask scheduler.
    count : int or None
        Number of parts; by default that of stored parts, else one that suits the study.
    history : str
        The CF attribute of the result.
    """
    path, target = single_study(studies, targets)
    target = target if "://" in target else str(Path(target).resolve())
    sweep = studies[path]
    parts_of(path, sweep, target, 1)  # which it may not have there
    begun = counts_of(target)
    if count is None:
        count = begun.pop() if len(begun) == 1 else sensible_count(sweep)
    parts = parts_of(path, sweep, target, count)
    missing = [part for part in range(count) if not parts.is_there(part)]
    console.say(f"{path}: {len(missing):,} of {count:,} parts to compute on {address}")
    with (
        report_errors(path, target),
        distributed.Client(address, timeout=20) as client,  # type: ignore[no-untyped-call]
        interruption() as interrupted,
        console.progress(path.name) as advance,
    ):
        study = sweep.study.canonical()
        numbers = {
            client.submit(
                by_name(compute_part), study, target, count, part, pure=False, retries=2
            ): part
            for part in missing
        }
        done = distributed.as_completed(list(numbers), with_results=True)  # type: ignore[no-untyped-call]
        for future, record in done:
            if interrupted():
                client.cancel(list(numbers))
                raise StoppedError(
                    "the sweep was stopped; run the same command again to compute the missing parts"
                )
            parts.keep(numbers.pop(future), record)
            advance(1 / len(missing))
    join_parts(path, parts, history)
