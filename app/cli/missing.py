"""The message of a command if a package of an extra is not installed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import typer

from vibrafeed.app.cli import console
from vibrafeed.app.cli.options import FAILED
from vibrafeed.core.extras import installing


@contextmanager
def needing(extra: str, package: str = "") -> Iterator[None]:
    """Exit with the command that installs an extra, if the block misses a module.

    `package` is the one that is named where vibrafeed is installed from a wheel; by default all of
    the extra.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        if (error.name or "vibrafeed").partition(".")[0] == "vibrafeed":
            raise
        console.fail(f"{error.name} is missing. Install it: {installing(package, extra)}")
        raise typer.Exit(FAILED) from None
