"""Shares cells out among threads, whatever the kernel."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.motion.result import COLUMNS, STATUS
from vibrafeed.core.watch import Watch

Kernel = Callable[
    [NDArray[np.float64], NDArray[np.float64], NDArray[np.int8], NDArray[np.int8]], object
]


def run_cells(
    kernel: Kernel,
    groups: NDArray[np.float64],
    *,
    columns: int = COLUMNS,
    piece: int = 256,
    watch: Watch | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.int8]]:
    """Run a kernel once for each distinct cell, in pieces distributed over threads.

    Parameters
    ----------
    kernel : callable
        Takes groups (n, g), a table (n, columns), statuses (n,) and a flag (1,), and fills table
        and statuses. It must release the interpreter's lock, and may not look across cells. Once
        the flag is raised it returns, and leaves the cell that it was at and all after it as they
        were, or NaN.
    groups : ndarray, shape (n, g)
        The dimensionless groups of each cell; equal rows are computed once.
    columns : int
        Columns of the table.
    piece : int
        Most cells of one call.
    watch : Watch, optional
        Asked before each piece and, by the flag, within cells; what is not finished has status
        `not_computed`, and NaN.

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

    starts = range(0, cells, piece)
    with watch.flag() as flag:

        def run(start: int) -> int:
            """Run the kernel on the piece that begins at a cell.

            Return the number of cells done.
            """
            if watch.stopped():
                return 0
            end = min(start + piece, cells)
            kernel(different[start:end], table[start:end], status[start:end], flag)
            return end - start

        if threads == 1 or len(starts) == 1:
            for start in starts:
                watch.advance(run(start) / cells)
        else:
            with ThreadPoolExecutor(threads, thread_name_prefix="motion") as pool:
                for done in pool.map(run, starts):
                    watch.advance(done / cells)
    return (table, status) if where is None else (table[where], status[where])


def _different(
    groups: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.intp] | None]:
    """Return the distinct rows of `groups` and, for each row, its index among them.

    `groups` has a row of numbers for each cell, shape (n, g): cells with equal numbers need be
    computed once only. The indices are None, with all rows returned, if all differ.
    """
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
