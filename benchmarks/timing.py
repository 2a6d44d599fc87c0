"""How long a call takes."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, TypeVar

Result = TypeVar("Result")


def timed(function: Callable[..., Result], *arguments: Any, **named: Any) -> tuple[Result, float]:
    """Call a function; return its result and the wall time [s]."""
    started = time.perf_counter()
    result = function(*arguments, **named)
    return result, time.perf_counter() - started
