"""Motion along the track and normal to it, from event to event (theory 13.2 to 13.8)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.mechanics.arrays import Array
from core.motion.motion import Motion, motion_of, run_cells
from core.quantities import MOTION_MODES
from core.watch import Watch


class Path(NamedTuple):
    """The motion of one part at asked phases of its cycle, in the scales of `Motion`.

    Attributes
    ----------
    phase : ndarray, shape (n,)
        Phase of the drive, from the start of a period.
    along, height : ndarray, shape (n,)
        Position on the track, from that at the first phase, and distance from the floor.
    velocity_along, velocity_normal : ndarray, shape (n,)
        Velocities relative to the track.
    mode : ndarray of int8, shape (n,)
        Value of a `MOTION_MODES` entry.
    """

    phase: Array
    along: Array
    height: Array
    velocity_along: Array
    velocity_normal: Array
    mode: NDArray[np.int8]


def planar_motion(
    *,
    drive_number_along: Array,
    drive_number_normal: Array,
    gravity_number_along: Array,
    gravity_number_normal: Array,
    friction_static: Array,
    friction_kinetic: Array,
    restitution: Array,
    tolerance: Array,
    most_periods: Array,
    watch: Watch | None = None,
) -> Motion:
    """Return the motion that a part falls into from rest on the floor, theory 13.2 to 13.8.

    Exact but for rounding where the motion repeats: every flow is closed, every event is isolated.
    `tolerance` bounds the error of the sliding velocity at the start of the cycle, as a share of
    the drive; `most_periods` bounds how long an aperiodic motion is followed. Equal cells are
    computed once; restitution plays no part in a cell that never lifts off.
    """
    arrays = np.broadcast_arrays(
        drive_number_along,
        drive_number_normal,
        gravity_number_along,
        gravity_number_normal,
        friction_static,
        friction_kinetic,
        np.where(np.abs(drive_number_normal) > gravity_number_normal, restitution, 0.0),
        tolerance,
        most_periods,
    )
    from core.motion.kernels.planar import solve_cells

    groups = np.stack([array.ravel() for array in arrays], axis=-1)
    return motion_of(*run_cells(solve_cells, groups, watch=watch), arrays[0].shape)


def planar_path(
    *,
    drive_number_along: float,
    drive_number_normal: float,
    gravity_number_along: float,
    gravity_number_normal: float,
    friction_static: float,
    friction_kinetic: float,
    restitution: float,
    tolerance: float,
    most_periods: float,
    phases: Array,
) -> Path:
    """Return the motion of one part at phases since the start of its cycle, exact at each.

    Parameters
    ----------
    phases : ndarray, shape (n,)
        Phases from the start of a period of the drive, at least 0; beyond the cycle's end it goes
        on with the next one. An aperiodic motion is shown over the last stretch that was followed,
        some periods long; beyond it all is NaN, and the mode is unknown.
    """
    from core.motion.kernels.planar import follow, sample

    group = np.array(
        [
            drive_number_along,
            drive_number_normal,
            gravity_number_along,
            gravity_number_normal,
            friction_static,
            friction_kinetic,
            restitution,
            tolerance,
            most_periods,
        ]
    )
    pieces, shift, way, repeats = follow(group)
    samples = sample(pieces, group, shift, phases, repeats)
    return Path(
        phases,
        way * samples[:, 0],
        samples[:, 1],
        way * samples[:, 2],
        samples[:, 3],
        _modes(samples[:, 4], way),
    )


def _modes(values: Array, way: float) -> NDArray[np.int8]:
    modes = values.astype(np.int8)
    forward, backward = MOTION_MODES["forward"].value, MOTION_MODES["backward"].value
    if way < 0:
        turned = {forward: backward, backward: forward}
        modes = np.array([turned.get(mode, mode) for mode in modes.tolist()], dtype=np.int8)
    return modes
