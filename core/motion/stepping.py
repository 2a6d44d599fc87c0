"""Motion of a part in three dimensions by time stepping (theory 13.1, 13.9).

The only method that knows walls, drives aslant to the track, curvature and rolling. It is of first
order in the step; planar motion has an exact method elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.mechanics.arrays import Array
from core.motion.motion import Motion, motion_of, run_cells
from core.watch import Watch

MOST_STEPS = 100_000_000
"""Steps of one path, and steps of one period times periods of one cell; more is refused."""


class Path(NamedTuple):
    """Positions and velocities of one part relative to the track, at given phases.

    Attributes
    ----------
    phase : ndarray, shape (n,)
    position : ndarray, shape (n, 3)
        Along, across (from the wall) and normal to the floor, in g/w^2.
    velocity : ndarray, shape (n, 3)
        In g/w. NaN, as is the position, where the contact laws had no solution.
    """

    phase: Array
    position: Array
    velocity: Array


def stepped_motion(
    *,
    drive_number_along: ArrayLike,
    drive_number_across: ArrayLike,
    drive_number_normal: ArrayLike,
    gravity_number_along: ArrayLike,
    gravity_number_across: ArrayLike,
    gravity_number_normal: ArrayLike,
    friction_static: ArrayLike,
    friction_kinetic: ArrayLike,
    curvature_number: ArrayLike = 0.0,
    restitution: ArrayLike = 0.0,
    wall_friction: ArrayLike = 0.0,
    wall_restitution: ArrayLike = 0.0,
    wall: bool = False,
    rolling: float = 0.0,
    absolute_speed: bool = True,
    steps_per_period: int = 1000,
    most_periods: int = 200,
    tolerance: float = 1.0,
    watch: Watch | None = None,
) -> Motion:
    """Return the motion of a part on the floor, and at the wall if there is one, in space.

    The part starts at rest on the floor, touching the wall, at phase 0. Each cell runs with n =
    `steps_per_period` steps and with 2n + 1. `velocity` and all else are those of the finer run,
    not extrapolated over the step: landings fall within steps at places that differ from run to
    run, so that the error, though of first order, is no smooth function of the step, and an
    extrapolation would amplify its irregular part. For the same reason there is a third run, with
    n steps from half a step earlier. `error` is three times the largest of the differences of the
    velocity to both coarser runs, the doubt about the transient's end, and `spread`; with hops a
    seventh of what a step changes is added, since all runs may agree by chance (theory 13.9).

    The motion is `periodic` if it comes back exactly, or over 16 periods to within a small part of
    what one step changes, or, after four times as many, to within what one step changes. A
    transient without hops that dies out slowly is extrapolated to its end. If it does not come
    back, means are over the last three quarters of the periods run, and `spread` is the standard
    deviation of the means of eight batches of them.

    Without hops the planar method is of second order: slips start and stop within a step. With
    hops, in space and in a curve, it is of first order. Where static friction exceeds kinetic, a
    slip in space that nearly stops, nearer than a step can tell, is taken to stop.

    Parameters
    ----------
    drive_number_along, drive_number_across, drive_number_normal : array_like
        Components of the drive's acceleration over g: A0 w^2/g times (cos(beta) cos(alpha),
        cos(beta) sin(alpha), sin(beta)).
    gravity_number_along, gravity_number_across, gravity_number_normal : array_like
        sin(gamma), cos(gamma) sin(delta), cos(gamma) cos(delta).
    friction_static, friction_kinetic : array_like
        Coefficients at the floor. Static friction holds what sticks and what stops.
    curvature_number : array_like
        g/(w^2 R); 0 for a straight track.
    restitution : array_like
        Of impacts on the floor, 0 to 1.
    wall_friction, wall_restitution : array_like
        Coefficients at the wall; they do nothing without one.
    wall : bool
        Whether there is a wall. Without, the position across is not carried.
    rolling : float
        m r^2/I for a cylinder whose axis lies along the track (2 if solid); 0 for a block. The
        contact then slips across with the speed of the centre less that of the surface.
    absolute_speed : bool
        Whether the centripetal acceleration is that of the speed in space; else of the speed
        relative to the track.
    steps_per_period : int
        Steps of the coarser run, at least 8.
    most_periods : int
        Periods after which a motion counts as aperiodic, at least 8.
    tolerance : float
        What counts as coming back, in terms of the largest change of velocity in one step.
    watch : Watch, optional
        May stop it between cells.

    Returns
    -------
    Motion
        Arrays of the shape of the arguments broadcast. `stick` is the share in which the floor
        contact does not move along the track; `flight` that in which the floor carries nothing.

    Raises
    ------
    ValueError
        If a count is out of its range.
    """
    from core.motion.kernels.stepping import FLOOR, WALL

    groups = (
        drive_number_along, drive_number_across, drive_number_normal,
        gravity_number_along, gravity_number_across, gravity_number_normal,
        curvature_number, friction_static, friction_kinetic, wall_friction, restitution,
        wall_restitution,
    )  # fmt: skip
    return _motion(
        WALL if wall else FLOOR, groups, rolling, absolute_speed, steps_per_period, most_periods,
        tolerance, watch,
    )  # fmt: skip


def planar_stepped_motion(
    *,
    drive_number_along: ArrayLike,
    drive_number_normal: ArrayLike,
    gravity_number_along: ArrayLike,
    gravity_number_normal: ArrayLike,
    friction_static: ArrayLike,
    friction_kinetic: ArrayLike,
    restitution: ArrayLike = 0.0,
    steps_per_period: int = 1000,
    most_periods: int = 200,
    tolerance: float = 1.0,
    watch: Watch | None = None,
) -> Motion:
    """Return the motion of a part in the plane of track and normal; nothing across is carried.

    For a drive along the track (alpha = 0), no wall and no lean. Parameters and result are those
    of `stepped_motion`, which with these values finds the same numbers.
    """
    from core.motion.kernels.stepping import PLANAR

    groups = (
        drive_number_along, 0.0, drive_number_normal,
        gravity_number_along, 0.0, gravity_number_normal,
        0.0, friction_static, friction_kinetic, 0.0, restitution, 0.0,
    )  # fmt: skip
    return _motion(PLANAR, groups, 0.0, False, steps_per_period, most_periods, tolerance, watch)


def stepped_path(
    *,
    drive_number_along: float,
    drive_number_across: float,
    drive_number_normal: float,
    gravity_number_along: float,
    gravity_number_across: float,
    gravity_number_normal: float,
    friction_static: float,
    friction_kinetic: float,
    phases: ArrayLike,
    curvature_number: float = 0.0,
    restitution: float = 0.0,
    wall_friction: float = 0.0,
    wall_restitution: float = 0.0,
    wall: bool = False,
    rolling: float = 0.0,
    absolute_speed: bool = True,
    steps_per_period: int = 1000,
    position: Sequence[float] = (0.0, 0.0, 0.0),
    velocity: Sequence[float] = (0.0, 0.0, 0.0),
    spin: float = 0.0,
) -> Path:
    """Return where one part is at given phases, from a given state at the first of them.

    Parameters
    ----------
    phases : array_like, shape (n,)
        Ascending; the steps, 2 pi/`steps_per_period` long, are counted from the first.
    position, velocity : sequence of 3 floats
        At the first phase: along, across and normal.
    spin : float
        Velocity across that the spin of a cylinder gives its lowest point; rolling has minus the
        velocity across. Of a block 0.

    Other parameters are those of `stepped_motion`.

    Returns
    -------
    Path

    Raises
    ------
    ValueError
        If phases are not finite and ascending, or need more than `MOST_STEPS` steps.
    """
    from core.motion.kernels.stepping import path

    asked = np.atleast_1d(np.asarray(phases, dtype=np.float64))
    if asked.ndim != 1 or asked.size == 0 or not np.all(np.isfinite(asked)):
        raise ValueError("phases must be a row of finite numbers")
    if np.any(np.diff(asked) < 0.0):
        raise ValueError("phases must ascend")
    _check(steps_per_period, 8, 1.0, rolling)
    step = 2.0 * math.pi / steps_per_period
    steps = (asked[-1] - asked[0]) / step
    if steps > MOST_STEPS:
        raise ValueError(f"phases need {steps:.3g} steps; the limit is {MOST_STEPS:,}")
    cell = np.array([
        drive_number_along, drive_number_across, drive_number_normal,
        gravity_number_along, gravity_number_across, gravity_number_normal,
        curvature_number, friction_static, friction_kinetic, wall_friction, restitution,
        wall_restitution,
    ], dtype=np.float64)  # fmt: skip
    start = np.array([*position, *velocity, spin], dtype=np.float64)
    if start.size != 7 or not (np.all(np.isfinite(cell)) and np.all(np.isfinite(start))):
        raise ValueError("groups, position (3) and velocity (3) must be finite")
    places, speeds = np.full((asked.size, 3), np.nan), np.full((asked.size, 3), np.nan)
    path(
        wall, float(rolling), absolute_speed, cell, asked, step, math.ceil(steps) + 1, start,
        places, speeds,
    )  # fmt: skip
    return Path(asked, places, speeds)


def _motion(
    scene: int,
    groups: Sequence[ArrayLike],
    rolling: float,
    absolute_speed: bool,
    steps_per_period: int,
    most_periods: int,
    tolerance: float,
    watch: Watch | None,
) -> Motion:
    """Return the motion of every cell of the groups broadcast."""
    from core.motion.kernels.stepping import step_cells

    _check(steps_per_period, most_periods, tolerance, rolling)
    arrays = np.broadcast_arrays(*(np.asarray(group, dtype=np.float64) for group in groups))
    shape = arrays[0].shape
    cells = np.stack([array.ravel() for array in arrays], axis=-1)
    coarse, shifted = _waves(steps_per_period), _waves(steps_per_period, shift=-0.5)
    fine = _waves(2 * steps_per_period + 1)  # odd, so that no middle of a step is one of both

    def kernel(
        piece: NDArray[np.float64], table: NDArray[np.float64], status: NDArray[np.int8]
    ) -> None:
        step_cells(
            scene, float(rolling), absolute_speed, coarse, shifted, fine, most_periods, tolerance,
            piece, table, status,
        )  # fmt: skip

    # A cell takes milliseconds: small pieces let a run be stopped soon and share out evenly.
    table, status = run_cells(kernel, cells, piece=32, watch=watch)
    return motion_of(table, status, shape)


def _waves(steps: int, shift: float = 0.0) -> Array:
    """Return sine and cosine of the drive at the middles of the steps of a period, (2, steps)."""
    phases = (np.arange(steps) + 0.5 + shift) * (2.0 * math.pi / steps)
    return np.stack([np.sin(phases), np.cos(phases)])


def _check(steps_per_period: int, most_periods: int, tolerance: float, rolling: float) -> None:
    """Raise if a count or a plain number is out of its range."""
    if steps_per_period < 8 or most_periods < 8:
        raise ValueError("steps_per_period and most_periods must be at least 8")
    if 4 * steps_per_period * most_periods > MOST_STEPS:
        raise ValueError(f"a cell may take {MOST_STEPS:,} steps at most")
    if not (tolerance >= 0.0 and rolling >= 0.0 and math.isfinite(rolling)):
        raise ValueError("tolerance and rolling must not be negative")
