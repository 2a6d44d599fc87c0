"""From event to event in space, on floor and wall, by Taylor series (theory 13.13).

Between events each mode of contact has a smooth equation of motion; its solution is a power series
of high order, made term by term, and the first root of a polynomial ends it where something
happens.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion import compiled
from vibrafeed.core.motion.cells import run_cells
from vibrafeed.core.motion.course import TrajectoryRequest, TrajectoryValues
from vibrafeed.core.motion.groups import Contacts, Groups, cells_of
from vibrafeed.core.motion.path import Path
from vibrafeed.core.motion.result import Motion, motion_of
from vibrafeed.core.watch import Watch

MAX_TURNS = 100_000
"""Periods of the drive that a trajectory may show, as many as a study may follow a part."""


def spatial_motion(
    groups: Groups,
    contacts: Contacts,
    *,
    tolerance: ArrayLike,
    max_periods: ArrayLike,
    watch: Watch | None = None,
) -> Motion:
    """Return the motion of parts in space that start at rest on the floor, touching the wall.

    From event to event, by power series of each contact mode, until the state comes back (theory
    13.13). The field `error` is twice the difference to other runs (shorter series; with rebounds a
    slightly smaller restitution), plus the rest of the transient and 2e-10 of the drive's speed.

    Parameters
    ----------
    groups : Groups
        Dimensionless groups of the cells; those of the wall have no effect without a wall.
    contacts : Contacts
        What the part can touch, and m r^2/I of a cylinder.
    tolerance : array_like
        Of the state's return after a cycle, as a share of the drive's speed.
    max_periods : array_like
        Periods after which a motion counts as aperiodic.
    watch : Watch, optional
        May stop the work; cells not computed have the status `not_computed`.
    """
    cells, shape = cells_of(groups, tolerance=tolerance, max_periods=max_periods)

    def kernel(
        piece: NDArray[np.float64],
        rows: NDArray[np.float64],
        status: NDArray[np.int8],
        stop: NDArray[np.int8],
    ) -> None:
        """Run the kernel of motions in space on a piece of the cells."""
        compiled.track.solve_cells(
            contacts.wall, float(contacts.rolling), piece, rows, status, stop
        )

    return motion_of(*run_cells(kernel, cells, piece=32, watch=watch), shape)


def spatial_path(
    groups: Groups,
    contacts: Contacts,
    *,
    tolerance: float,
    max_periods: float,
    phases: Array,
    watch: Watch | None = None,
) -> tuple[Path, NDArray[np.int8]]:
    """Return positions and modes of one part at ascending phases from the start of its cycle.

    A motion that does not repeat is shown after as many periods as it is followed for. What the
    watch did not let it reach is NaN.

    Parameters
    ----------
    groups : Groups
        Dimensionless numbers of the part.
    contacts : Contacts
        What the part can touch, and if it rolls.
    tolerance : float
        Largest error of a periodic state, as a share of the drive.
    max_periods : float
        Most periods to follow.
    phases : ndarray
        Phases in rad.
    watch : Watch, optional
        May stop the work.

    Raises
    ------
    ValueError
        If phases are negative, do not ascend, or are beyond `MAX_TURNS` periods.
    """
    if phases.size and (phases[0] < 0.0 or np.any(np.diff(phases) < 0.0)):
        raise ValueError("the argument phases has to hold numbers of at least 0 in ascending order")
    if phases.size and phases[-1] > MAX_TURNS * 2 * np.pi:
        raise ValueError(f"phases reach beyond {MAX_TURNS:,} periods")
    (cell,), _ = cells_of(groups, tolerance=tolerance, max_periods=max_periods)
    with (watch or Watch()).flag() as stop:
        samples = compiled.track.follow(contacts.wall, float(contacts.rolling), cell, phases, stop)
    return Path(phases, samples[:, :3], samples[:, 3:6]), samples[:, 6].astype(np.int8)


def spatial_trajectory(
    asked: TrajectoryRequest, contacts: Contacts, *, tolerance: float, max_periods: float
) -> TrajectoryValues:
    """Return the trajectory of one part over a cycle, or at the times of the request.

    `asked` is the request, `contacts` what the part can touch, `tolerance` and `max_periods` are
    those of `spatial_path`.
    """
    settings = {"tolerance": tolerance, "max_periods": max_periods}
    _, phases = asked.times()
    path, modes = spatial_path(asked.groups, contacts, **settings, phases=phases, watch=asked.watch)
    start = path.position[0, 0]
    return asked.trajectory(path.position, path.velocity, modes, contacts.wall, start)
