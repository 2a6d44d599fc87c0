"""The kernels that Python calls, each loaded with numba when it is asked for; cells over threads.

It stands outside of `kernels`: what is compiled there is kept for as long as what it imports stays
the same, and it imports none of this.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.deferred import lazily
from vibrafeed.core.motion.method import COLUMNS, STATUS
from vibrafeed.core.watch import Watch

if TYPE_CHECKING:
    from vibrafeed.core.motion.kernels import inputs, rows, track, tumbling
    from vibrafeed.core.motion.kernels.planar import flow, plane_cells, wave
else:
    _TOP = ("inputs", "rows", "track", "tumbling")
    _PLANAR = ("flow", "plane_cells", "wave")
    __getattr__ = lazily(
        f"{__package__}.kernels",
        {},
        {name: name for name in _TOP} | {name: f"planar.{name}" for name in _PLANAR},
    )

__all__ = ["flow", "inputs", "plane_cells", "rows", "run_cells", "track", "tumbling", "wave"]

Kernel = Callable[
    [NDArray[np.float64], NDArray[np.float64], NDArray[np.int8], NDArray[np.int8]], object
]
"""Takes groups (n, g), a table (n, columns), statuses (n,) and a flag (1,), and fills table and
statuses. It releases the interpreter's lock, and does not look across cells. Once the flag is
raised it leaves the cell that it was at and all after it as they were, or NaN."""


def run_cells(
    kernel: Kernel,
    groups: NDArray[np.float64],
    *,
    columns: int = COLUMNS,
    piece: int = 256,
    watch: Watch | None = None,
) -> tuple[NDArray[np.float64], NDArray[np.int8]]:
    """Return table (n, columns) and status (n,) of cells, by a kernel in pieces over threads.

    Equal rows of `groups`, shape (n, g), are computed once, and most `piece` of them in one call.
    What the watch did not let finish has status `not_computed`, and NaN.
    """
    watch = watch or Watch()
    distinct, row_indices = _distinct_rows(groups)
    count = distinct.shape[0]
    table = np.full((count, columns), np.nan)
    status = np.full(count, STATUS["not_computed"], dtype=np.int8)
    threads = watch.threads or os.cpu_count() or 1
    piece = max(1, min(piece, count // (4 * threads)))
    starts = range(0, count, piece)
    with watch.flag() as flag:

        def run(start: int) -> int:
            if watch.stopped():
                return 0
            end = min(start + piece, count)
            kernel(distinct[start:end], table[start:end], status[start:end], flag)
            return end - start

        if threads == 1 or len(starts) == 1:
            for start in starts:
                watch.advance(run(start) / count)
        else:
            with ThreadPoolExecutor(threads, thread_name_prefix="motion") as pool:
                for count_done in pool.map(run, starts):
                    watch.advance(count_done / count)
    return (table, status) if row_indices is None else (table[row_indices], status[row_indices])


def _distinct_rows(
    groups: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.intp] | None]:
    # The distinct rows, and for each row its index among them; all rows and None if all differ.
    rows = np.ascontiguousarray(groups + 0.0)  # -0.0 is 0.0
    # One number a row, by a sum of products of its bits: 64 bits sort faster than whole rows.
    factors = np.random.default_rng(0).integers(1, 2**63, rows.shape[1], dtype=np.uint64) * 2 + 1
    hashes = (rows.view(np.uint64) * factors).sum(axis=1, dtype=np.uint64)
    hashes ^= hashes >> np.uint64(29)
    sorted_hashes = np.sort(hashes)
    if (sorted_hashes[1:] != sorted_hashes[:-1]).all():
        return rows, None  # the usual case, for a tenth of the work below
    _, first_rows, row_indices = np.unique(hashes, return_index=True, return_inverse=True)
    order = np.argsort(first_rows, kind="stable")  # in the order of the grid, whatever the marks
    position = np.empty_like(order)
    position[order] = np.arange(order.size)
    distinct, row_indices = rows[first_rows[order]], position[row_indices]
    if not np.array_equal(distinct[row_indices], rows, equal_nan=True):
        return rows, None  # two rows share a mark
    return distinct, row_indices
