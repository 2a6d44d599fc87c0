"""How far a test searches: a little by day, far by night, in `make night`."""

import os
from collections.abc import Iterable
from typing import TypeVar

NIGHT = os.environ.get("VIBRAFEED_NIGHT") == "1"

Case = TypeVar("Case")


def count(day: int, night: int, name: str = "VIBRAFEED_LAW_CELLS") -> int:
    """Return how many cells, cases or tries a test takes; the environment variable has its way."""
    return int(os.environ.get(name, night if NIGHT else day))


def spread(every: Iterable[Case], day: int) -> list[Case]:
    """Return all cases of a test by night, and `day` of them, evenly spread, by day."""
    listed = list(every)
    if NIGHT or day >= len(listed):
        return listed
    return [listed[round(k * len(listed) / day)] for k in range(day)]
