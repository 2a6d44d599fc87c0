"""The record of a method of motion: the one seam between following a part and all the rest."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.groups import Contacts, Groups
from vibrafeed.core.motion.waves import ALONG, NORMAL, position_at
from vibrafeed.core.scenes import Constraint
from vibrafeed.core.watch import Watch

TIME = "cycle_time"
"""The axis of a trajectory."""

Follow = Callable[..., Any]
"""An equation: takes by keyword a part's numbers, the settings that it needs and a `watch`; returns
a `Motion`, or a `Tumble` of a part that tumbles, or the `Energy` of a motion."""

Trajectory = dict[str, NDArray[Any]]
"""By name `TIME` [s], and what the part does at these times, in SI units."""


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

    def scale(self, name: str) -> float:
        """Return a scale of the drive in SI units by its name, such as `velocity_scale` [m s-1]."""
        return self.known[name].item()

    def times(self) -> tuple[Array, Array]:
        """Return the asked times [s] and drive phases [rad]; a number of them over one cycle."""
        circular_frequency = self.scale("velocity_scale") / self.scale("length_scale")
        if isinstance(self.samples, int):
            cycle = np.nan_to_num(self.known["motion"].multiple.item(), nan=1.0)
            phases = np.linspace(0.0, 2 * np.pi * max(1.0, cycle), self.samples + 1)
            return phases / circular_frequency, phases
        times = np.array(self.samples)
        return times, circular_frequency * times

    def trajectory(self, path: Path, modes: NDArray[np.int8], wall: bool) -> Trajectory:
        """Return the trajectory in SI units, with the displacement of the track.

        `modes` has one `MOTION_MODES` value a time. The distance from the wall is given if there is
        a `wall`.
        """
        times, phases = self.times()
        speed, length = self.scale("velocity_scale"), self.scale("length_scale")
        position, velocity, groups = path.position, path.velocity, self.groups
        if groups.wave is None:
            swing = length * np.sin(phases)
            along, normal = groups.drive_number_along * swing, groups.drive_number_normal * swing
        else:
            along, normal = (
                length * position_at(groups.wave, axis, phases) for axis in (ALONG, NORMAL)
            )
        values = {
            TIME: times,
            "position_along": position[:, 0] * length,
            "height_above_floor": position[:, 2] * length,
            "relative_velocity_along": velocity[:, 0] * speed,
            "relative_velocity_normal": velocity[:, 2] * speed,
            "track_along": along,
            "track_normal": normal,
        }
        if wall:
            values["distance_from_wall"] = position[:, 1] * length
        return {**values, "motion_mode": modes}


@dataclass(frozen=True)
class Method:
    """One way to follow the motion of a part: what it takes, costs, knows of its error, refuses.

    Attributes
    ----------
    name : str
        As a study names it.
    follow : callable
        Follows cells; its first sentence is that of the equation. It takes the `Contacts` of a
        conveying system, too.
    source : str
        Where the theory tells of it.
    accuracy : str
        What is known of its error, in words.
    seconds_a_cell : float
        Roughly the time of a cell on one core [s], for cells that it verifies, and where its code
        is not compiled yet; other prices are measured.
    defaults : mapping of str to float
        Its settings where a study leaves them out.
    course : callable or None
        Takes a `TrajectoryRequest` and the `Contacts` of a system; returns the `Trajectory` of one
        part. None if the method gives means only.
    energy : callable or None
        Gives the `Energy` of a `Motion`; takes the `Contacts` of a system, too. None if the method
        does not tell it.
    checked_by : tuple of str
        The methods by which it is verified, the most exact first.
    refuses : tuple of Constraint
        What a study must respect that asks for it.
    follows : callable
        Takes the `Contacts` of a system; returns whether the method can follow it.
    """

    name: str
    follow: Follow
    source: str
    accuracy: str
    seconds_a_cell: float
    defaults: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    course: Callable[[TrajectoryRequest, Contacts], Trajectory] | None = None
    energy: Follow | None = None
    checked_by: tuple[str, ...] = ()
    refuses: tuple[Constraint, ...] = ()
    follows: Callable[[Contacts], bool] = lambda contacts: True
