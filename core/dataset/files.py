"""Files that appear complete or not at all, and the choices in which they are stored."""

import contextlib
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, TypeAlias

from vibrafeed.core.system import replace, sync

PART = ".part"  # ends the names of files that are being written
PARTIAL = ".partial"  # ends the names of folders with which a stopped run can go on


CsvStyle: TypeAlias = Literal["plain", "excel"]
"""The style of CSV files: that for Excel in Europe has semicolons and decimal commas."""
ZarrVersion: TypeAlias = Literal[2, 3]


@dataclass(frozen=True)
class Storage:
    """The choices that formats of results leave.

    Attributes
    ----------
    compression : bool
        True to compress NetCDF and MAT files; the other formats always do, or never.
    csv_style : str
        The style of CSV files.
    zarr_version : int
        The version of Zarr groups; 2 is for programs that do not read 3.
    """

    compression: bool = True
    csv_style: CsvStyle = "plain"
    zarr_version: ZarrVersion = 3


USUAL: Final = Storage()


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Yield a temporary path; the file takes its final name when the block ends without error.

    `path` is the final name. A reader sees either the complete file or none; after an error nothing
    is left behind.

    Raises
    ------
    OSError
        If the file cannot be written, with its final name.
    """
    temporary = path.with_name(f".{path.name}.{os.urandom(8).hex()}{PART}")
    try:
        # Touch the file first: the system's error says more than those of some libraries.
        temporary.touch(exist_ok=True)
        yield temporary
        settle(temporary, path)
    except OSError as error:
        if error.errno is None:
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        with contextlib.suppress(OSError):  # a library still holds it, after an error of its own
            temporary.unlink(missing_ok=True)


def settle(temporary: Path, path: Path) -> None:
    """Move a finished file or folder from a temporary to its final path, flushed to disk."""
    sync(temporary)
    replace(temporary, path)
    sync(path.parent)


def partial(path: Path) -> Path:
    """Return the folder for the pieces of an incomplete result."""
    return path.with_name(f".{path.name}{PARTIAL}")
