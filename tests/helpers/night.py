"""How far a test searches: a little by day, in `make test`; far by night, in `make night`."""

from __future__ import annotations

import os

NIGHT = os.environ.get("VIBRAFEED_NIGHT") == "1"


def count(day: int, night: int, name: str = "VIBRAFEED_LAW_CELLS") -> int:
    """Return how many cells, cases or tries a test takes; the environment variable has its way."""
    return int(os.environ.get(name, night if NIGHT else day))
