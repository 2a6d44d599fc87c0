"""The price of a study: 64 of its cells are computed and timed, once, with a margin of two.

Nobody knows beforehand whether a motion repeats, so the samples are followed for more and more
periods while a budget of time lasts. What has not repeated by then counts as if it never did.
Closed forms have a fixed price for each cell.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from vibrafeed.core.errors import StoppedError
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.plan.equations import run_equations
from vibrafeed.core.plan.grid import Grid, positions_of
from vibrafeed.core.plan.plan import Plan
from vibrafeed.core.quantities import MOTION_STATUSES
from vibrafeed.core.study.sweep_and_simulate import FEWEST_PERIODS
from vibrafeed.core.watch import Watch

SAMPLED = 64
"""Most cells that are computed for a price."""
MARGIN = 2.0
"""Factor on the measured time."""
BUDGET, PATIENCE = 0.3, 4.0
"""Longest time of the processor that a round of the sample takes [s], and the longest by the clock
over it, since others may use the core."""
MORE = 4.0
"""Factor from the number of periods of one round to that of the next."""
SURPRISE = 3.0 * MORE
"""Ratio of the times of a cell in two rounds from which on the second is repeated."""
LIMIT = "max_periods"

ENDED = [MOTION_STATUSES[name].value for name in ("periodic", "at_rest", "neutral")]
"""Statuses of motions that more periods do not prolong."""
NOT_COMPUTED = MOTION_STATUSES["not_computed"].value


class Price(NamedTuple):
    """The price of a study in seconds of one core: to begin, and for each cell."""

    start: float
    cell: float

    def of(self, cells: float) -> float:
        """Return the price of a number of cells [s]; more cells never cost less."""
        return self.start + self.cell * cells


class _Round(NamedTuple):
    seconds: float
    done: int
    open: bool

    @property
    def each(self) -> float:
        return self.seconds / max(self.done, 1)


def price(
    plan: Plan,
    grid: Grid,
    rough: float | None = None,
    free: Mapping[str, tuple[float, float]] | None = None,
) -> Price:
    """Return the price of evaluating a plan on a grid, from some cells that are evenly spread.

    `rough` is that of a cell where nothing is timed [s], the scene's if left out: of closed forms,
    and of motions whose code is not compiled yet. `free` are the ends of parameters that are not on
    the grid, SI units.
    """
    each = plan.scene.seconds_a_cell if rough is None else rough
    if not any(one.takes_long for one in plan.equations) or not _is_compiled():
        return Price(0.0, MARGIN * each)
    known, count, share = _spread_cells(plan, grid, free or {})
    start, each = _timed(plan, known, count)
    return Price(MARGIN * start, MARGIN * each * share)


def _is_compiled() -> bool:
    from vibrafeed.core.kernel_cache import are_kept, packages

    return bool(are_kept(name for name in packages() if name.startswith("motion-")))


def _spread_cells(
    plan: Plan, grid: Grid, free: Mapping[str, tuple[float, float]]
) -> tuple[dict[str, Array], int, float]:
    depends = plan.depends_on(grid.axes)
    moved = frozenset().union(*(depends[one.gives] for one in plan.equations if one.takes_long))
    dims = {name: grid.shape[name] for name in grid.dims(moved)}
    cells = math.prod(dims.values())
    count = SAMPLED if free else min(SAMPLED, cells)
    points = _evenly(count, len(dims) + len(free))
    if cells <= count and not free:
        order = np.concatenate([np.arange(0, count, 2), np.arange(1, count, 2)])
        positions = positions_of(dims, order)
    else:
        along = np.floor(points[:, : len(dims)] * [*dims.values()]).astype(np.int64)
        positions = dict(zip(dims, along.T, strict=True))
    positions |= dict.fromkeys(set(grid.axes) - set(dims), np.zeros(count, dtype=np.int64))
    known = grid.at(positions, count, plan.parameters)
    for k, (name, (low, high)) in enumerate(free.items(), start=len(dims)):
        known[name] = low + (high - low) * points[:, k]
    return known, count, cells / grid.cells


def _evenly(count: int, axes: int) -> Array:
    g = 2.0
    for _ in range(64):
        g = (1.0 + g) ** (1.0 / (axes + 1))
    steps = g ** -np.arange(1.0, axes + 1)
    return np.asarray((0.5 + np.arange(count)[:, np.newaxis] * steps) % 1.0)


def _timed(plan: Plan, known: Mapping[str, Any], count: int) -> tuple[float, float]:
    allowed = float(np.max({**plan.defaults, **known}.get(LIMIT, 0.0)))
    periods = before = reached = 0.0
    while True:
        periods = min(allowed, max(float(FEWEST_PERIODS), MORE * periods))
        latest = _follow(plan, known, count, periods)
        if latest.each > SURPRISE * before:  # it may have loaded code
            latest = _follow(plan, known, count, periods)
        goes_on = latest.open and periods < allowed
        if not goes_on or latest.done < count or MORE * latest.seconds > BUDGET:
            break
        before, reached = latest.each, periods
    if goes_on:  # as if it never repeated
        growth = (latest.each - before) / (periods - reached)
        return 0.0, latest.each + max(growth, 0.0) * (allowed - periods)
    if latest.done < count or count == 1:
        return 0.0, latest.each
    # A call takes a time of its own, which more cells do not lengthen.
    half = count // 2
    slope = (latest.seconds - _follow(plan, known, half, periods).seconds) / (count - half)
    slope = min(max(slope, 0.1 * latest.each), latest.each)
    return count * (latest.each - slope), slope


def _follow(plan: Plan, known: Mapping[str, Any], count: int, periods: float) -> _Round:
    cells = {name: value[:count] if np.ndim(value) else value for name, value in known.items()}
    if LIMIT in plan.defaults or LIMIT in known:
        cells[LIMIT] = np.asarray(periods)
    busy, since = time.process_time(), time.thread_time()
    watch = Watch(
        threads=1,
        stop=lambda: time.process_time() - busy > BUDGET,
        deadline=time.monotonic() + PATIENCE * BUDGET,
    )
    try:
        outcome = run_equations(plan, cells, watch)
    except StoppedError:
        return _Round(time.thread_time() - since, 0, open=True)
    seconds = time.thread_time() - since
    long = (outcome[one.gives] for one in plan.equations if one.takes_long)
    statuses = [np.broadcast_to(one.status, count) for one in long if hasattr(one, "status")]
    left_out = np.any([one == NOT_COMPUTED for one in statuses], axis=0)
    done = count - int(np.sum(left_out))
    is_open = not done or not all(np.isin(one[~left_out], ENDED).all() for one in statuses)
    return _Round(seconds, done, is_open)


def in_words(seconds: float) -> str:
    """Return a time [s] in words with two digits, as users see it: ``3.2 minutes``."""
    for unit, length in (("days", 86_400), ("hours", 3600), ("minutes", 60)):
        if seconds >= 2 * length:
            return f"{float(f'{seconds / length:.2g}'):,g} {unit}"
    return f"{float(f'{seconds:.2g}'):g} s"
