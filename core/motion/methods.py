"""Every method of motion of a point part, as equations of a system call it.

Each takes the dimensionless groups and settings that it needs, and no others; modules with kernels
and integrators are loaded when they are called.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any

import numpy as np

from core.mechanics.arrays import Array
from core.motion.motion import STATUS, Motion
from core.motion.stepping import planar_stepped_motion, stepped_motion
from core.watch import Watch

SOLID_CYLINDER = 2.0  # m r^2/I about its axis


def stepped_on_plane(rolling: float) -> Callable[..., Motion]:
    """Return the time stepping of a part on a floor without a wall.

    `rolling` is 0 for a block, m r^2/I for a cylinder along the track.
    """

    def steps(
        *,
        drive_number_along: Array,
        drive_number_across: Array,
        drive_number_normal: Array,
        gravity_number_along: Array,
        gravity_number_normal: Array,
        friction_static: Array,
        friction_kinetic: Array,
        restitution: Array,
        steps_per_period: Array,
        most_periods: Array,
        watch: Watch | None = None,
    ) -> Motion:
        """Return the motion from rest by the midpoint rule of Moreau and Jean, theory 13.9.

        Where no cell is driven across the track, nothing across is carried.
        """
        shared: dict[str, Any] = {
            "drive_number_along": drive_number_along,
            "drive_number_normal": drive_number_normal,
            "gravity_number_along": gravity_number_along,
            "gravity_number_normal": gravity_number_normal,
            "friction_static": friction_static,
            "friction_kinetic": friction_kinetic,
            "restitution": restitution,
            "steps_per_period": int(steps_per_period),
            "most_periods": int(most_periods),
            "watch": watch,
        }
        if not np.any(drive_number_across):
            return planar_stepped_motion(**shared)
        return stepped_motion(
            drive_number_across=drive_number_across,
            gravity_number_across=0.0,
            rolling=rolling,
            **shared,
        )

    return steps


def stepped_on_track(
    *,
    drive_number_along: Array,
    drive_number_across: Array,
    drive_number_normal: Array,
    gravity_number_along: Array,
    gravity_number_across: Array,
    gravity_number_normal: Array,
    curvature_number: Array,
    friction_static: Array,
    friction_kinetic: Array,
    restitution: Array,
    steps_per_period: Array,
    most_periods: Array,
    watch: Watch | None = None,
) -> Motion:
    """Return the motion from rest on floor and wall by time stepping, theory 13.1, 13.9.

    The wall has the kinetic friction and the restitution of the floor.
    """
    return stepped_motion(
        drive_number_along=drive_number_along,
        drive_number_across=drive_number_across,
        drive_number_normal=drive_number_normal,
        gravity_number_along=gravity_number_along,
        gravity_number_across=gravity_number_across,
        gravity_number_normal=gravity_number_normal,
        curvature_number=curvature_number,
        friction_static=friction_static,
        friction_kinetic=friction_kinetic,
        restitution=restitution,
        wall_friction=friction_kinetic,
        wall_restitution=restitution,
        wall=True,
        steps_per_period=int(steps_per_period),
        most_periods=int(most_periods),
        watch=watch,
    )


def reference_on_plane(rolling: float) -> Callable[..., Motion]:
    """Return the reference method of a part on a floor without a wall; see `stepped_on_plane`."""

    def reference(
        *,
        drive_number_along: Array,
        drive_number_across: Array,
        drive_number_normal: Array,
        gravity_number_along: Array,
        gravity_number_normal: Array,
        friction_static: Array,
        friction_kinetic: Array,
        restitution: Array,
        most_periods: Array,
        watch: Watch | None = None,
    ) -> Motion:
        """Return the motion from rest by integration of order 8 between events, theory 13.1.

        For single points: a cell takes up to some seconds.
        """
        return _one_by_one(
            {
                "drive_number_along": drive_number_along,
                "drive_number_across": drive_number_across,
                "drive_number_normal": drive_number_normal,
                "gravity_number_along": gravity_number_along,
                "gravity_number_across": np.zeros(()),
                "gravity_number_normal": gravity_number_normal,
                "friction_static": friction_static,
                "friction_kinetic": friction_kinetic,
                "restitution": restitution,
            },
            {"rolling": rolling, "most_periods": int(most_periods)},
            watch,
        )

    return reference


def reference_on_track(
    *,
    drive_number_along: Array,
    drive_number_across: Array,
    drive_number_normal: Array,
    gravity_number_along: Array,
    gravity_number_across: Array,
    gravity_number_normal: Array,
    curvature_number: Array,
    friction_static: Array,
    friction_kinetic: Array,
    restitution: Array,
    most_periods: Array,
    watch: Watch | None = None,
) -> Motion:
    """Return the motion on floor and wall by integration of order 8 between events, theory 13.1.

    For single points: a cell takes up to some seconds.
    """
    return _one_by_one(
        {
            "drive_number_along": drive_number_along,
            "drive_number_across": drive_number_across,
            "drive_number_normal": drive_number_normal,
            "gravity_number_along": gravity_number_along,
            "gravity_number_across": gravity_number_across,
            "gravity_number_normal": gravity_number_normal,
            "curvature_number": curvature_number,
            "friction_static": friction_static,
            "friction_kinetic": friction_kinetic,
            "restitution": restitution,
            "wall_friction": friction_kinetic,
            "wall_restitution": restitution,
        },
        {"wall": True, "most_periods": int(most_periods)},
        watch,
    )


def _one_by_one(groups: dict[str, Array], fixed: dict[str, Any], watch: Watch | None) -> Motion:
    """Return the reference motion of every cell of the groups broadcast."""
    from core.motion.reference import reference_motion

    watch = watch or Watch()
    arrays = np.broadcast_arrays(*groups.values())
    shape, cells = arrays[0].shape, arrays[0].size
    found: dict[str, Array] = {name: np.full(cells, np.nan) for name in Motion._fields}
    status = np.full(cells, STATUS["not_computed"], dtype=np.int8)
    for cell, values in enumerate(zip(*(array.ravel() for array in arrays), strict=True)):
        if watch.stopped():
            break
        numbers: dict[str, Any] = dict(zip(groups, map(float, values), strict=True))
        motion = reference_motion(**numbers, **fixed)
        for name in Motion._fields[:-1]:
            found[name][cell] = getattr(motion, name)
        status[cell] = motion.status
        watch.advance(1 / cells)
    columns = [found[name].reshape(shape) for name in Motion._fields[:-1]]
    return Motion._make([*columns, status.reshape(shape)])


def regularised_on_plane(
    *,
    drive_number_along: Array,
    drive_number_across: Array,
    drive_number_normal: Array,
    gravity_number_along: Array,
    gravity_number_normal: Array,
    friction_static: Array,
    friction_kinetic: Array,
    restitution: Array,
    slip_speed: Array,
    contact_stiffness: Array,
    tolerance: Array,
    most_periods: Array,
    solver: str = "Radau",
    watch: Watch | None = None,
) -> Motion:
    """Return the motion with regularised friction on a stiff floor, by a stiff integrator.

    A comparison for the methods that keep the exact laws: a cell takes seconds.
    """
    from core.motion.regularised import regularised_motion

    return regularised_motion(
        drive_number_along=drive_number_along,
        drive_number_across=drive_number_across,
        drive_number_normal=drive_number_normal,
        gravity_number_along=gravity_number_along,
        gravity_number_across=0.0,
        gravity_number_normal=gravity_number_normal,
        friction_kinetic=friction_kinetic,
        friction_static=friction_static,
        restitution=restitution,
        slip_speed=slip_speed,
        contact_stiffness=contact_stiffness,
        tolerance=tolerance,
        most_periods=most_periods,
        solver=solver,
        planar=not np.any(drive_number_across),
        watch=watch,
    )


def regularised_by(solver: str) -> Callable[..., Motion]:
    """Return the regularised motion by one of scipy's implicit integrators."""

    @wraps(regularised_on_plane)
    def regularised(**arguments: Any) -> Motion:
        return regularised_on_plane(**arguments, solver=solver)

    return regularised
