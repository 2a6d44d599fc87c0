"""The result of every method, and how cells are shared out among threads."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.mechanics.arrays import Array
from core.quantities import MOTION_STATUSES
from core.watch import Watch


class Motion(NamedTuple):
    """Motion over a period of the drive once it repeats, in the scales of the drive.

    All arrays have one shape, that of the arguments broadcast. Lengths are in g/w^2, velocities in
    g/w, times in 1/w, where w is the circular frequency (theory 13.8).

    Attributes
    ----------
    velocity : ndarray
        Mean velocity along the track; NaN where there is none.
    spread : ndarray
        Standard deviation of the means of runs from several phases; 0 where the motion repeats.
    error : ndarray
        Estimate of the error of `velocity` by the method itself.
    stick, forward, backward, flight : ndarray
        Fractions of the period; they add up to 1.
    impacts : ndarray
        Impacts on the floor per period; a run of ever smaller hops counts as those resolved.
    landing_speed : ndarray
        Largest speed normal to the floor before an impact.
    hop_height : ndarray
        Largest distance from the floor.
    multiple : ndarray
        Periods of the drive after which the motion repeats; 0 where it does not.
    status : ndarray of int8
        Value of a `MOTION_STATUSES` entry.
    """

    velocity: Array
    spread: Array
    error: Array
    stick: Array
    forward: Array
    backward: Array
    flight: Array
    impacts: Array
    landing_speed: Array
    hop_height: Array
    multiple: Array
    status: NDArray[np.int8]


STATUS: Mapping[str, int] = {name: flag.value for name, flag in MOTION_STATUSES.items()}

ANSWERED = ("periodic", "at_rest", "aperiodic", "neutral")
"""Statuses of cells that have a mean velocity."""

COLUMNS = len(Motion._fields) - 1
"""Columns of a kernel's table, one a field of `Motion` in its order, without the status."""

Kernel = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.int8]], object]


def run_cells(
    kernel: Kernel,
    groups: NDArray[np.float64],
    *,
    columns: int = COLUMNS,
    piece: int = 256,
    watch: Watch | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.int8]]:
    """Run a kernel over the different cells, in pieces shared out among threads, one a core.

    Parameters
    ----------
    kernel : callable
        Takes groups (n, g), a table (n, columns) and statuses (n,), and fills the last two. It
        must release the interpreter's lock, and may not look across cells.
    groups : ndarray, shape (n, g)
        The dimensionless groups of each cell; equal rows are computed once.
    columns : int
        Columns of the table.
    piece : int
        Most cells of one call.
    watch : Watch, optional
        Asked before each piece; what is not started has status `not_computed`, and NaN.

    Returns
    -------
    table : ndarray, shape (n, columns)
    status : ndarray of int8, shape (n,)
    """
    watch = watch or Watch()
    different, where = _different(groups)
    cells = different.shape[0]
    table = np.full((cells, columns), np.nan)
    status = np.full(cells, STATUS["not_computed"], dtype=np.int8)
    threads = watch.threads or os.cpu_count() or 1
    piece = max(1, min(piece, cells // (4 * threads)))

    def run(start: int) -> int:
        if watch.stopped():
            return 0
        end = min(start + piece, cells)
        kernel(different[start:end], table[start:end], status[start:end])
        return end - start

    starts = range(0, cells, piece)
    if threads == 1 or len(starts) == 1:
        for start in starts:
            watch.advance(run(start) / cells)
    else:
        with ThreadPoolExecutor(threads, thread_name_prefix="motion") as pool:
            for done in pool.map(run, starts):
                watch.advance(done / cells)
    return (table, status) if where is None else (table[where], status[where])


def motion_of(
    table: NDArray[np.float64], status: NDArray[np.int8], shape: tuple[int, ...]
) -> Motion:
    """Return a kernel's table as a `Motion` of arrays of a shape."""
    columns = [np.ascontiguousarray(column).reshape(shape) for column in table.T]
    return checked(Motion._make([*columns, status.reshape(shape)]))


def checked(motion: Motion) -> Motion:
    """Return the motion with no value passed off as an answer that is none.

    A cell that overflowed, or that was in the air all along without landing, has `limit_reached`.
    """
    answered = np.isin(motion.status, [STATUS[name] for name in ANSWERED])
    finite = np.logical_and.reduce([np.isfinite(field) for field in motion[:-1]])
    never_landed = (motion.flight > 0) & (motion.impacts == 0)
    lost = answered & (~finite | never_landed)
    fields = [np.where(lost, np.nan, field) for field in motion[:-1]]
    status = np.where(lost, np.int8(STATUS["limit_reached"]), motion.status)
    return Motion._make([*fields, status])


def _different(
    groups: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.intp] | None]:
    """Return the different rows, and the place of each row among them; None if all differ."""
    rows = np.ascontiguousarray(groups + 0.0)  # -0.0 is 0.0
    # One number a row, by a sum of products of its bits: 64 bits sort faster than whole rows.
    factors = np.random.default_rng(0).integers(1, 2**63, rows.shape[1], dtype=np.uint64) * 2 + 1
    marks = (rows.view(np.uint64) * factors).sum(axis=1, dtype=np.uint64)
    marks ^= marks >> np.uint64(29)
    ordered = np.sort(marks)
    if (ordered[1:] != ordered[:-1]).all():
        return rows, None  # the usual case, for a tenth of the work below
    _, first, where = np.unique(marks, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")  # in the order of the grid, whatever the marks
    place = np.empty_like(order)
    place[order] = np.arange(order.size)
    different, where = rows[first[order]], place[where]
    if not np.array_equal(different[where], rows, equal_nan=True):
        return rows, None  # two rows share a mark
    return different, where
