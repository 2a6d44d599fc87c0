"""Random cells of a study's grid, and how long they take."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterable

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.grid import Grid, random_positions

SEED = 2004
REPEATS = 5
LEAST_SECONDS = 2e-3  # of one repeat: the clock and the start of a call do not matter then


def random_cells(
    grid: Grid, count: int, names: Iterable[str], seed: int = SEED
) -> dict[str, Array]:
    """Return the parameters of random distinct cells of a grid; equal seeds give equal cells.

    SI units, shape (`sample_size`,).
    """
    return grid.at(random_positions(grid, count, seed), sample_size(grid, count), names)


def sample_size(grid: Grid, count: int) -> int:
    """Return the number of distinct cells to sample from a grid, at most `count`."""
    return min(count, grid.cells)


def median_seconds(
    run: Callable[[], object], repeats: int = REPEATS, least: float = LEAST_SECONDS
) -> float:
    """Return the median wall time of one call of a function [s].

    Two calls before the first measurement warm up and give the length of a repeat.

    Parameters
    ----------
    run : callable
        The function, called without arguments.
    repeats : int
        Number of repeats, over which the median is taken; each gives the mean of its calls.
    least : float
        Time that a repeat takes at least [s], as the clock cannot measure a short call by itself.
    """
    started = time.perf_counter()
    run()
    first = time.perf_counter() - started
    started = time.perf_counter()
    run()
    second = min(first, time.perf_counter() - started)
    calls = max(1, int(least / max(second, 1e-7)))

    def repeat() -> float:
        """Return the mean time of some calls [s]."""
        started = time.perf_counter()
        for _ in range(calls):
            run()
        return (time.perf_counter() - started) / calls

    return statistics.median(repeat() for _ in range(repeats))
