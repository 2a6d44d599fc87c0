"""How long calls take."""

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


def in_turns(
    count: int,
    *functions: Callable[[], object],
    clock: Callable[[], float] = time.perf_counter,
) -> list[list[float]]:
    """Return the seconds of each call of each function; they take turns, so that load falls on all.

    Parameters
    ----------
    count : int
        Calls of each.
    functions : callable
        What is timed.
    clock : callable
        Returns seconds: of the wall, or `time.process_time` of the processor.
    """
    times: list[list[float]] = [[] for _ in functions]
    for _ in range(count):
        for function, taken in zip(functions, times, strict=True):
            started = clock()
            function()
            taken.append(clock() - started)
    return times


def least(
    count: int,
    function: Callable[[], object],
    clock: Callable[[], float] = time.perf_counter,
) -> float:
    """Return the shortest of some calls [s]."""
    return min(in_turns(count, function, clock=clock)[0])
