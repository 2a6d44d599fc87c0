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

COLUMNS = len(Motion._fields) - 1
"""Columns of a kernel's table, one a field of `Motion` in its order, without the status."""

Kernel = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.int8]], object]


def run_cells(
    kernel: Kernel, groups: NDArray[np.float64], *, piece: int = 256, columns: int = COLUMNS
) -> tuple[NDArray[np.float64], NDArray[np.int8]]:
    """Run a kernel over cells, in pieces shared out among as many threads as there are cores.

    Parameters
    ----------
    kernel : callable
        Takes groups (n, g), a table (n, columns) and statuses (n,), and fills the last two. It
        must release the interpreter's lock, and may not look across cells.
    groups : ndarray, shape (n, g)
        The dimensionless groups of each cell.
    piece : int
        Cells of one call.
    columns : int
        Columns of the kernel's table.

    Returns
    -------
    table : ndarray, shape (n, columns)
    status : ndarray of int8, shape (n,)
    """
    cells = groups.shape[0]
    table = np.empty((cells, columns))
    status = np.zeros(cells, dtype=np.int8)

    def run(start: int) -> None:
        end = start + piece
        kernel(groups[start:end], table[start:end], status[start:end])

    starts = range(0, cells, piece)
    threads = min(os.cpu_count() or 1, len(starts))
    if threads <= 1:
        for start in starts:
            run(start)
    else:
        with ThreadPoolExecutor(threads, thread_name_prefix="motion") as pool:
            for _ in pool.map(run, starts):
                pass
    return table, status
