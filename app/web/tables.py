"""Results as tables in files that people open, sent in pieces as they are written."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from importlib.metadata import version
from importlib.util import find_spec
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

from anyio import CapacityLimiter, to_thread
from fastapi.responses import Response, StreamingResponse

from vibrafeed.app.settings import Settings
from vibrafeed.core.dataset.formats import FORMATS
from vibrafeed.core.dataset.frame import Frame
from vibrafeed.core.system import installing

NOTE: Final = "Vibrafeed-Note"
TABLES: Final = {suffix[1:]: form.media for suffix, form in FORMATS.items() if form.media}
PACKAGES: Final = {form: one.package for form in TABLES if (one := FORMATS[f".{form}"]).package}
if TYPE_CHECKING:
    ResultForm: TypeAlias = str
    SliceForm: TypeAlias = str
else:
    ResultForm = Literal[("netcdf", "json", *TABLES)]
    SliceForm = Literal[("json", "binary", *TABLES)]


def available_tables() -> dict[str, str]:
    """Return the media types of the table formats that this installation can write."""
    return {form: kind for form, kind in TABLES.items() if form not in _missing()}


def missing_packages() -> str:
    """Return sentences that say how to install the packages of unavailable table formats."""
    lacking = [f"{form}: {installing(*PACKAGES[form])}." for form in _missing()]
    return " ".join(lacking)


def _missing() -> list[str]:
    return [form for form, (package, _) in PACKAGES.items() if find_spec(package) is None]


def writer_version(form: str) -> str:
    """Return a table format with the version of the package that writes it, such as `parquet 17.0`.

    The ETag of a table holds it, as the bytes depend on the package. `form` is csv, parquet or
    xlsx. Raises `MissingPackageError` if the package is not installed.
    """
    if form not in PACKAGES:
        return form
    FORMATS[f".{form}"].needs()
    return f"{form} {version(PACKAGES[form][0])}"


def most_rows(settings: Settings, form: str, most: int) -> int:
    """Return the largest number of rows of a table in a format; Excel sheets have a lower limit.

    `most` is the limit of the other formats.
    """
    return min(most, settings.max_sheet_rows) if form == "xlsx" else most


def table_reply(frame: Frame, form: str, *, limiter: CapacityLimiter | None) -> Response:
    """Return a table as a reply in pieces, each written in a thread.

    Parameters
    ----------
    frame : Frame
        The table as rows.
    form : str
        The format: csv, parquet or xlsx.
    limiter : CapacityLimiter or None
        Limits the threads that write; None takes those of the event loop.
    """
    write = FORMATS[f".{form}"].pieces
    assert write is not None
    pieces = write(frame)
    note = frame.note
    reply = StreamingResponse(_in_threads(pieces, limiter), media_type=TABLES[form])
    if note:
        reply.headers[NOTE] = note
    return reply


async def _in_threads(
    pieces: Iterator[bytes], limiter: CapacityLimiter | None
) -> AsyncIterator[bytes]:
    """Yield the pieces of a table, each made in a thread."""
    while (piece := await to_thread.run_sync(next, pieces, None, limiter=limiter)) is not None:
        if piece:  # none comes while rows are added to a workbook
            yield piece
