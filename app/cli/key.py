"""`vibrafeed key`: keys for the HTTP interface, made and withdrawn while it serves, and the audit.

They work on the ledger that `vibrafeed serve` has with the same settings.
"""

import os
import sqlite3
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import INVALID_INPUT, Group, Json
from vibrafeed.app.cli.studies import refuse
from vibrafeed.core.errors import Problem

if TYPE_CHECKING:
    from vibrafeed.app.jobs.database import Database

key = typer.Typer(
    cls=Group,
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Manage the access keys of the HTTP service: make, list and withdraw them.",
)

LIMITS = ("requests", "jobs", "cells", "bytes")
Name = Annotated[
    str, typer.Argument(help="Name of the key: up to 40 letters, digits, '.', '_' and '-'.")
]


@key.command()
def add(
    name: Name,
    role: Annotated[
        str,
        typer.Option(
            help="What the key may do. read: read results; run: also post studies and "
            "dismiss its own jobs; admin: everything."
        ),
    ] = "run",
    requests: Annotated[
        float | None,
        typer.Option(
            help="Maximum number of requests per second with this key; by default the key "
            "has no limit."
        ),
    ] = None,
    jobs: Annotated[
        float | None,
        typer.Option(
            help="Maximum number of jobs of this key that run or wait at once; by default "
            "the key has no limit."
        ),
    ] = None,
    cells: Annotated[
        float | None,
        typer.Option(
            help="Maximum number of cells (grid points) of one study of this key; by "
            "default the key has no limit, but the service has."
        ),
    ] = None,
    most_bytes: Annotated[
        float | None,
        typer.Option(
            "--bytes",
            help="Maximum size in bytes of the results that the service stores for this "
            "key; by default the key has no limit, but the service has.",
        ),
    ] = None,
    days: Annotated[
        float | None,
        typer.Option(
            help="Number of days until the key expires; by default the key does not expire."
        ),
    ] = None,
) -> None:
    """Make an access key of the HTTP service and print it; a running service accepts it in seconds.

    Without an option the key has no such limit of its own; limits in the settings of the service
    apply to all keys. The key is shown only once, since only its hash is stored.
    """
    from vibrafeed.app.jobs.keys import InvalidKeyError, Key, Keys

    new_key = Key(
        name,
        role,
        requests=_parse_limit(requests),
        jobs=_parse_limit(jobs),
        cells=_parse_limit(cells),
        bytes=_parse_limit(most_bytes),
    )
    with _database() as database:
        try:
            secret, stored = Keys(database).add(new_key, days)
        except InvalidKeyError as error:
            refuse({Path("key add"): list[Problem](error.problems)})
    typer.echo(secret)
    typer.echo(
        f"This key of {stored.name}, of the role {stored.role}, is stored nowhere: note it now. "
        "Clients send `Authorization: Bearer KEY`.",
        err=True,
    )


def _parse_limit(number: float | None) -> int | None:
    """Return a limit as a whole number, so that 1e9 may be typed; None for no limit.

    A number that is not whole becomes 0, which the check of the key refuses.
    """
    if number is None:
        return None
    return int(number) if abs(number) < float("inf") and number == int(number) else 0


@key.command("list")
def list_keys(as_json: Json = False) -> None:
    """List all keys, including expired and withdrawn ones."""
    from vibrafeed.app.jobs.keys import Keys

    with _database() as database:
        keys = Keys(database).all()
    now = time.time()
    if as_json:
        names = ("name", "role", "created", "ends", "withdrawn", *LIMITS)
        documents = [
            {**{name: getattr(row, name) for name in names}, "stands": row.in_force(now)}
            for row in keys
        ]
        console.document(documents)
        return
    rows = []
    for row in keys:
        until = (
            "withdrawn " + _format_day(row.withdrawn) if row.withdrawn else _format_day(row.ends)
        )
        if not row.withdrawn and not row.in_force(now):
            until = f"over since {until}"
        figures = (getattr(row, name) for name in LIMITS)
        limits = ["-" if figure is None else f"{figure:,}" for figure in figures]
        rows.append((row.name, row.role, _format_day(row.created), *limits, until))
    console.table(("name", "role", "made", *LIMITS, "until"), rows, right=LIMITS)


@key.command()
def withdraw(name: Name) -> None:
    """Withdraw a key: a running service refuses it within seconds.

    Studies and results posted with it stay.
    """
    from vibrafeed.app.jobs.keys import Keys, NoSuchKeyError

    with _database() as database:
        try:
            Keys(database).withdraw(name)
        except NoSuchKeyError as error:
            console.fail(str(error))
            raise typer.Exit(INVALID_INPUT) from None
    typer.echo(f"The key of {name} is withdrawn.")


@key.command("audit")
def tell_audit(
    most: Annotated[
        int,
        typer.Option(help="Number of entries of the audit log to print: the newest ones.", min=1),
    ] = 100,
) -> None:
    """Print the audit log: posts, dismissals, sharing, and keys made, withdrawn and refused."""
    from vibrafeed.app.jobs import audit

    with _database() as database:
        for entry in reversed(audit.latest(database, most)):
            when = datetime.fromtimestamp(entry.time, UTC).isoformat(timespec="seconds")
            typer.echo(f"{when}  {entry.name or '-':<24}{entry.action:<14}{entry.object}")


@contextmanager
def _database() -> "Iterator[Database]":
    """Yield the database of API keys, that of the ledger; if it cannot be used, print why and exit.

    It is closed at the end. Errors of the database that the block raises are treated alike.
    """
    from vibrafeed.app.cli.serve import PRIVATE, settings_in_force
    from vibrafeed.app.jobs.errors import LaterLedgerError
    from vibrafeed.app.jobs.ledger import Ledger

    settings = settings_in_force()
    os.umask(PRIVATE)  # it may be the one who makes the files
    ledger = Ledger(settings.ledger)
    try:
        yield ledger.database
    except (OSError, sqlite3.Error, LaterLedgerError) as error:
        text = error.strerror if isinstance(error, OSError) else None
        console.fail(f"The ledger cannot be used: {' '.join((text or str(error)).split())}.")
        raise typer.Exit(INVALID_INPUT) from None
    finally:
        ledger.close()


def _format_day(seconds: float | None) -> str:
    """Return a time [s since the epoch] as a date; `-` if there is none."""
    return "-" if seconds is None else datetime.fromtimestamp(seconds, UTC).date().isoformat()
