"""`vibrafeed join`: the result of the shares of a sweep."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer

from vibrafeed.app.cli.studies import prepare_all, refuse
from vibrafeed.core.errors import Problem


def join(
    file: Annotated[
        Path,
        typer.Argument(
            help="Study file (TOML or JSON) whose shares are joined.", show_default=False
        ),
    ],
    output: Annotated[
        str,
        typer.Option(
            "-o",
            "--output",
            help="Path of the joined result: the same -o as in `vibrafeed run --share`.",
        ),
    ],
    shares: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="Number of shares into which the study was divided; by default read from "
            "the folder of shares.",
        ),
    ] = None,
    force: Annotated[
        bool,
        typer.Option(
            "--force", help="Replace the output file even if it holds the result of another study."
        ),
    ] = False,
) -> None:
    """Join the shares computed by `vibrafeed run --share` into one result.

    Each share is checked by its digest. Exit code 1 means that some shares are missing or damaged;
    their numbers are printed as a job queue takes them: compute these again, and join again.
    """
    from vibrafeed.app.cli.existing import refuse_others
    from vibrafeed.app.cli.shares import counts_of, join_shares, shares_of

    studies = prepare_all([file])
    refuse_others(studies, {file: output}, force=force)
    counts = {shares} if shares is not None else counts_of(output)
    if len(counts) != 1:
        told = (
            f"there are shares of {', '.join(map(str, sorted(counts)))}" if counts else "no share"
        )
        message = f"{told} beside {output}" if counts else f"there is no share beside {output}"
        fix = "Give --shares" if counts else "Compute them with vibrafeed run --share 0/N, 1/N, ..."
        refuse({file: [Problem("shares", message, fix)]})
    stamp = datetime.now(UTC).isoformat(timespec="seconds")
    history = f"{stamp} vibrafeed join {file.name}"
    join_shares(file, shares_of(file, studies[file], output, counts.pop()), history)
