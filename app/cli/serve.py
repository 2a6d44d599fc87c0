"""`vibrafeed serve`: the HTTP interface, once its settings and its directory are looked at."""

from __future__ import annotations

import errno
import logging
import os
import socket
import sqlite3
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import INVALID_INPUT
from vibrafeed.app.cli.studies import refuse
from vibrafeed.core.errors import Problem

if TYPE_CHECKING:
    from vibrafeed.app.jobs.ledger import Ledger
    from vibrafeed.app.settings import Settings

logger = logging.getLogger("vibrafeed")

PRIVATE = 0o077  # what others on the machine may not do with files
OLDER_DATA = Path("data")  # what the data directory was by default
LEDGER_BYTES = 256 * 1024  # bytes that the ledger needs to begin with, and some more


def serve(
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="Port to listen on.", min=0, max=65535)] = 8000,
    behind_proxy: Annotated[
        bool,
        typer.Option(
            "--behind-proxy",
            help="Take the client's address and scheme from X-Forwarded-For and X-Forwarded-Proto, "
            "as a proxy such as nginx sends them.",
        ),
    ] = False,
    show_settings: Annotated[
        bool,
        typer.Option(
            "--show-settings",
            help="Print the settings in force and exit, without starting the service.",
        ),
    ] = False,
    new_ledger: Annotated[
        bool,
        typer.Option(
            "--new-ledger",
            help="Start with an empty ledger although the data directory contains studies, whose "
            "jobs and keys are lost.",
        ),
    ] = False,
) -> None:
    """Serve the HTTP interface.

    Other machines can use the service only with an access key: `vibrafeed key add` makes one.
    Exit code 2 means that a setting is wrong, or that the data directory cannot be used.
    """
    from vibrafeed.app import logs

    settings = settings_in_force()
    if show_settings:
        typer.echo(settings.model_dump_json(indent=2))
        return
    _check_keys(settings, host, new_ledger)
    # Settings are shown, and keys kept, without what serves.
    from vibrafeed.app.main import create_app
    from vibrafeed.app.web.guard import is_loopback
    from vibrafeed.app.web.server import serve_until_stopped

    os.umask(PRIVATE)  # studies and results are their owner's, those of the workers too
    _check_address(host, port)
    service = create_app(settings)
    _check_directory(settings.data_directory.absolute())
    _choose_temporary_folder(settings.data_directory.absolute())
    _check_ledger(settings, service.state.admission.ledger, new_ledger)
    logs.configure()
    if not (behind_proxy or is_loopback(host)):
        logger.warning(
            "other machines reach the service without a proxy, which would add TLS and hold slow "
            "clients: see docs/operations.md, and start with --behind-proxy behind one"
        )
    if port and sys.stdout.isatty():  # else it would be a line among those of the log
        _welcome(settings, host, port)
    _tell_of_older_data(settings)
    serve_until_stopped(service, settings, host, port, behind_proxy=behind_proxy)


def _welcome(settings: Settings, host: str, port: int) -> None:
    """Print the address of the web page and further hints at the start of a service.

    `host` and `port` are where it listens; `settings` has the data directory.
    """
    address = "http://" + (f"[{host}]:{port}/" if ":" in host else f"{host}:{port}/")
    typer.echo(
        f"Open {address} in a browser; Ctrl-C stops the service.\n"
        f"Programs use the same address: {address}docs describes the requests.\n"
        f"Studies and results are kept in {settings.data_directory.absolute()}."
    )


def _tell_of_older_data(settings: Settings) -> None:
    """Print a hint if the folder that older versions used by default still holds studies."""
    is_default = "data_directory" not in settings.model_fields_set
    if is_default and (OLDER_DATA / "jobs.sqlite3").is_file():
        console.fail(
            f"Studies of an earlier version are in {OLDER_DATA.absolute()}. To go on with them, "
            "set VIBRAFEED_DATA_DIRECTORY to that folder."
        )


def settings_in_force() -> Settings:
    """Return the service's settings from the environment; print every invalid one and exit.

    Variables that begin with `VIBRAFEED_` and name no setting are invalid, too.
    """
    from pydantic import ValidationError

    from vibrafeed.app.settings import PREFIX, Settings, unknown_variables

    problems = unknown_variables(os.environ)
    try:
        settings = Settings()
    except ValidationError as error:
        for item in error.errors():
            name = PREFIX + ".".join(map(str, item["loc"])).upper()
            problems.append(
                Problem(name, item["msg"].removeprefix("Value error, "), "Correct the value")
            )
    if problems:
        refuse({Path("environment"): problems})
    return settings


def _check_address(host: str, port: int) -> None:
    """Open and close a socket at the address; if that fails, print why and exit."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        socket.create_server((host, port), family=family).close()
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            reason = (
                f"Port {port} of {host} is taken. Stop what listens there, or give another --port"
            )
        else:
            reason = f"{host}, port {port}, cannot be listened on: {error.strerror or error}"
        console.fail(f"{reason}.")
        raise typer.Exit(INVALID_INPUT) from None


def _check_keys(settings: Settings, host: str, new_ledger: bool) -> None:
    """Exit if the service would be reachable from other machines and no API key exists.

    `host` is the address to listen on. An empty ledger beside studies is refused, too, unless
    `new_ledger` is True.
    """
    from vibrafeed.app.jobs.errors import LaterLedgerError
    from vibrafeed.app.jobs.keys import Keys
    from vibrafeed.app.jobs.ledger import Ledger
    from vibrafeed.app.web.guard import is_loopback  # with all that serves

    if is_loopback(host):
        return
    location = settings.ledger
    if isinstance(location, str) or location.exists():
        ledger = Ledger(location)
        keys = Keys(ledger.database)
        try:
            if not new_ledger:  # a key made now would hide that others are lost
                _check_entries(settings, ledger)
            keys.refresh()
        except (OSError, sqlite3.DatabaseError, LaterLedgerError):
            return  # `_check_ledger` says why, and nothing is served
        finally:
            ledger.close()
        if keys.are_needed:
            return
    fix = "Make a key with `vibrafeed key add NAME`"
    message = "other machines can reach this address, but no API key exists"
    refuse({Path("serve"): [Problem(f"--host {host}", message, fix)]})


def _check_directory(directory: Path) -> None:
    """Write a test file into the data directory; if that fails, print why and exit."""
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory) as file:
            file.write(bytes(LEDGER_BYTES))
            file.flush()
            os.fsync(file.fileno())  # some disks tell only then that they are full
    except FileExistsError:
        _refuse_directory(directory, "it is not a directory", "Set")
    except OSError as error:
        is_full = error.errno in (errno.ENOSPC, errno.EDQUOT)
        advice = f"Make room there, {LEDGER_BYTES:,} bytes at least, or set" if is_full else "Set"
        _refuse_directory(directory, error.strerror or str(error), advice)


def _choose_temporary_folder(directory: Path) -> None:
    """Use a folder in the data directory for temporary files if the system has none."""
    try:
        tempfile.gettempdir()
    except FileNotFoundError:  # as on a read-only root
        temporary = directory / "tmp"
        try:
            temporary.mkdir(exist_ok=True)
        except OSError as error:
            reason = f"it can hold no folder for temporary files: {error.strerror}"
            _refuse_directory(directory, reason, "Set TMPDIR to another folder, or set")
        os.environ["TMPDIR"] = str(temporary)  # of the workers too


def _check_ledger(settings: Settings, ledger: Ledger, new_ledger: bool) -> None:
    """Exit with a message if the ledger, the database of jobs, cannot be written or is damaged.

    So it is if the ledger is empty beside studies, unless `new_ledger` is True. Whether it can be
    written is found out by the begin of a write transaction. `settings` say where the ledger is,
    for the message.
    """
    from vibrafeed.app.jobs.errors import DamagedLedgerError, LaterLedgerError

    try:
        with ledger.transaction():
            pass  # a ledger in which a write transaction begins can be opened and written
        ledger.database.check()
    except DamagedLedgerError as error:
        console.fail(
            f"The ledger is damaged: {' '.join(str(error).split())}. Restore the backup of "
            f"{_ledger_location(settings)}; studies and results are not affected."
        )
        raise typer.Exit(INVALID_INPUT) from None
    except (OSError, sqlite3.DatabaseError, LaterLedgerError) as error:
        text = error.strerror if isinstance(error, OSError) else None
        reason = " ".join((text or str(error)).split())
        if settings.ledger_url is None:
            directory = settings.data_directory.absolute()
            _refuse_directory(
                directory, f"its jobs.sqlite3: {reason}", "Free, fix or move that file, or set"
            )
        console.fail(
            f"The ledger of VIBRAFEED_LEDGER_URL cannot be used: {reason}. Start or fix that "
            "database, or leave the setting out to keep the ledger in the data directory."
        )
        raise typer.Exit(INVALID_INPUT) from None
    if not new_ledger:
        _check_entries(settings, ledger)


def _check_entries(settings: Settings, ledger: Ledger) -> None:
    """Exit with a message if the ledger is empty and the data directory holds studies."""
    studies = settings.data_directory / "studies"
    if studies.is_dir() and any(studies.iterdir()) and ledger.is_empty():
        console.fail(
            f"The ledger is empty, but {studies.absolute()} holds studies: restore the backup of "
            f"{_ledger_location(settings)}, or start once with `vibrafeed serve --new-ledger`, "
            "which gives up the jobs and keys of before."
        )
        raise typer.Exit(INVALID_INPUT)


def _ledger_location(settings: Settings) -> str:
    if settings.ledger_url is None:
        return str(settings.data_directory.absolute() / "jobs.sqlite3")
    return "the database of VIBRAFEED_LEDGER_URL"


def _refuse_directory(directory: Path, reason: str, advice: str) -> NoReturn:
    """Print why the data directory cannot be used and which setting to change; exit.

    `advice` is its beginning, such as "Set".
    """
    fix = f"{advice} VIBRAFEED_DATA_DIRECTORY to a directory that can be written"
    console.fail(f"The data directory {directory} cannot be used: {reason}. {fix}.")
    raise typer.Exit(INVALID_INPUT)
