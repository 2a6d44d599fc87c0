"""`vibrafeed scrub`: whether the results of a service are what was written."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED, INVALID_INPUT, Json
from vibrafeed.app.cli.studies import interruption

SHOWN = 12  # letters of an identifier, as in the names of downloads
COLUMNS = ("study", "state", "files")
MAX_FILES = 3  # that are named of one study


def scrub(
    directory: Annotated[
        Path | None,
        typer.Argument(
            help="Data directory of the service to check; by default that of "
            "VIBRAFEED_DATA_DIRECTORY."
        ),
    ] = None,
    repair: Annotated[
        bool,
        typer.Option(
            "--repair",
            help="Remove damaged results; the service computes them again when they are requested.",
        ),
    ] = False,
    as_json: Json = False,
) -> None:
    """Compare all results of a service with their digests; exit with code 1 if one is damaged.

    The service may run meanwhile.
    """
    from vibrafeed.app.cli.serve import settings_in_force
    from vibrafeed.app.jobs.scrub import BROKEN, ORPHANED, damages
    from vibrafeed.app.jobs.store import Store

    directory = directory or settings_in_force().data_directory
    store = Store(directory)
    if not directory.is_dir():
        console.fail(f"There is no folder {directory}.")
        raise typer.Exit(INVALID_INPUT)
    rows: list[tuple[str, str, str]] = []
    counts: dict[str, int] = {}
    read = 0
    with interruption() as interrupted:
        for damage in damages(store, stopped=interrupted):
            counts[damage.state] = counts.get(damage.state, 0) + 1
            read += damage.bytes
            if damage.state in (BROKEN, ORPHANED):
                more = len(damage.files) - MAX_FILES
                named = ", ".join(damage.files[:MAX_FILES]) + (f" and {more:,} more" * (more > 0))
                rows.append((damage.name[:SHOWN], damage.state, named))
            if damage.state == BROKEN and repair:
                store.remove_file(damage.name, store.folder(damage.name) / damage.files[0])
        if interrupted():
            console.fail("The scrub was stopped; the remaining results are not checked.")
    if as_json:
        wrong = [dict(zip(COLUMNS, row, strict=True)) for row in rows]
        told_of = {"directory": str(directory), "studies": counts, "bytes": read, "wrong": wrong}
        console.document(told_of)
    else:
        _tell(directory, rows, counts, read, repair=repair)
    if counts.get(BROKEN) or interrupted():
        raise typer.Exit(FAILED)


def _tell(
    directory: Path,
    rows: list[tuple[str, str, str]],
    counts: Mapping[str, int],
    read: int,
    *,
    repair: bool,
) -> None:
    """Print the damaged folders, the counts, and what was repaired.

    Parameters
    ----------
    directory : Path
        The data directory.
    rows : list of tuple
        Study, state and files of each damaged folder.
    counts : mapping
        Number of folders in each state.
    read : int
        Bytes that were read.
    repair : bool
        True if damaged results were removed.
    """
    from vibrafeed.app.jobs.scrub import BROKEN, WHOLE

    if rows:
        console.table(COLUMNS, rows)
    told = ", ".join(f"{count:,} {state}" for state, count in sorted(counts.items()))
    console.say(f"{directory}: {told or f'0 {WHOLE}'}; {read:,} bytes read")
    if counts.get(BROKEN):
        if repair:
            console.say("The damaged results are removed; they are computed again on request.")
        else:
            console.say(
                "To remove the damaged results, so that they are computed "
                "again: vibrafeed scrub --repair"
            )
