"""How far a test searches: a little by day, in `make test`; far by night, in `make night`."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any

import pytest

NIGHT = os.environ.get("VIBRAFEED_NIGHT") == "1"


def count(day: int, night: int, name: str = "VIBRAFEED_LAW_CELLS") -> int:
    """Return how many cells, cases or tries a test takes; the environment variable has its way."""
    return int(os.environ.get(name, night if NIGHT else day))


def first_by_day(cases: Iterable[Any], day: int = 1) -> list[Any]:
    """Return the cases of a test, of which all but the first run by night only."""
    every = list(cases)
    later = [one if isinstance(one, tuple) else (one,) for one in every[day:]]
    return every[:day] + [pytest.param(*one, marks=pytest.mark.night) for one in later]
