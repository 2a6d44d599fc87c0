"""Sizes of results, and limits on them."""

from dataclasses import dataclass

from vibrafeed.core.errors import LimitError


@dataclass(frozen=True)
class Size:
    """The size of a result.

    Attributes
    ----------
    rows, columns : int
        Number of cells, and of variables with coordinates.
    value_bytes : int
        Bytes of all values, those of flags as doubles.
    """

    rows: int = 0
    columns: int = 0
    value_bytes: int = 0


def check_limit(limit: str, asked: int, allowed: int | None, fix: str) -> None:
    """Raise `LimitError` if a figure is larger than a limit; None allows any."""
    if allowed is not None and asked > allowed:
        raise LimitError(limit, asked, allowed, fix)
