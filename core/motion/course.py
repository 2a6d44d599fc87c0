"""The trajectory of one part in time, as a study asks for it by `trajectory`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.groups import Groups
from vibrafeed.core.motion.waves import ALONG, NORMAL, position_at
from vibrafeed.core.quantities import MOTION_MODES, Flag
from vibrafeed.core.watch import Watch

TRAJECTORY_FLAGS: dict[str, Mapping[str, Flag]] = {"motion_mode": MOTION_MODES}
"""The flags of trajectories, with their meanings."""


class TrajectoryValues(NamedTuple):
    """Times [s] and what the part does at them: quantities, and flags of `TRAJECTORY_FLAGS`."""

    times: Array
    values: Mapping[str, Array]
    flags: Mapping[str, NDArray[np.int8]]


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


class TrajectoryRequest(NamedTuple):
    """The times at which a study asks for a trajectory, and the scales of it.

    Attributes
    ----------
    samples : int or tuple of float
        Equal steps of the cycle, or times [s].
    arguments : mapping
        Those of the equation that followed the part, each of one value.
    known : mapping
        Every quantity of the plan.
    watch : Watch
        May stop it; what was not reached is NaN.
    """

    samples: int | tuple[float, ...]
    arguments: Mapping[str, Any]
    known: Mapping[str, Any]
    watch: Watch

    @property
    def groups(self) -> Groups:
        """The dimensionless numbers of the part that is followed."""
        return self.arguments["groups"].single()

    def setting(self, name: str) -> float:
        """Return a setting of the method by its name, such as `tolerance`."""
        return np.asarray(self.arguments[name]).item()

    def scale(self, name: str) -> float:
        """Return a scale of the drive in SI units by its name, such as `velocity_scale` [m s-1]."""
        return self.known[name].item()

    def times(self) -> tuple[Array, Array]:
        """Return the times [s] and drive phases [rad] at which a trajectory is wanted.

        Equally spaced over one cycle of the motion if the study gives a number of samples, else the
        times that it gives.
        """
        # Circular frequency.
        pace = self.scale("velocity_scale") / self.scale("length_scale")
        if isinstance(self.samples, int):
            cycle = np.nan_to_num(self.known["motion"].multiple.item(), nan=1.0)
            phases = np.linspace(0.0, 2 * np.pi * max(1.0, cycle), self.samples + 1)
            return phases / pace, phases
        times = np.array(self.samples)
        return times, pace * times

    def track(self) -> dict[str, Array]:
        """Return the displacement of the track along and normal at the times of a trajectory [m].

        By the names of both quantities, `track_along` and `track_normal`.
        """
        (_, phases), length, groups = self.times(), self.scale("length_scale"), self.groups
        if groups.wave is None:
            swing = length * np.sin(phases)
            along, normal = groups.drive_number_along * swing, groups.drive_number_normal * swing
        else:
            along, normal = (
                length * position_at(groups.wave, axis, phases) for axis in (ALONG, NORMAL)
            )
        return {"track_along": along, "track_normal": normal}

    def trajectory(
        self,
        position: Array,
        velocity: Array,
        modes: NDArray[np.int8],
        wall: bool,
        start: float = 0.0,
    ) -> TrajectoryValues:
        """Return the trajectory in SI units, by the names of its quantities.

        `position` and `velocity`, shape (n, 3), along, across and normal, are in g/w^2 (w = 2 pi f)
        and g/w; `modes` has one `MOTION_MODES` value a time. Positions along are measured from
        `start`, in g/w^2; the distance from the wall is given if there is a `wall`. The motion of
        the track is added.
        """
        speed, length = self.scale("velocity_scale"), self.scale("length_scale")
        values = {
            "position_along": (position[:, 0] - start) * length,
            "height_above_floor": position[:, 2] * length,
            "relative_velocity_along": velocity[:, 0] * speed,
            "relative_velocity_normal": velocity[:, 2] * speed,
            **self.track(),
        }
        if wall:
            values["distance_from_wall"] = position[:, 1] * length
        return TrajectoryValues(self.times()[0], values, {"motion_mode": modes})
