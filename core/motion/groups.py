"""The groups: the dimensionless numbers of a part, one bundle from the plan to a method's edge.

Lengths are in g/w^2, velocities in g/w and accelerations in g, where w is the circular frequency of
the drive (theory 13.8): equal groups move alike, whatever their size.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.waves import Wave, of_columns

Numbers: TypeAlias = Any
"""An array of many parts, or the plain number of one."""


class Groups(NamedTuple):
    """The numbers that the motion of a part depends on; fields broadcast.

    What a scene has not is left at 0, which costs no array.

    Attributes
    ----------
    drive_number_along, drive_number_across, drive_number_normal : array_like
        Components of the drive's acceleration over g: A0 w^2/g times (cos(beta) cos(alpha),
        cos(beta) sin(alpha), sin(beta)).
    gravity_number_along, gravity_number_across, gravity_number_normal : array_like
        sin(gamma), cos(gamma) sin(delta), cos(gamma) cos(delta); the last with all that presses the
        part onto the floor at all times, as a magnet does.
    curvature_number : array_like
        g/(w^2 R); 0 for a straight track.
    friction_static, friction_kinetic : array_like
        Coefficients at the floor.
    wall_friction : array_like
        Coefficient at the wall.
    restitution, wall_restitution : array_like
        Of impacts on the floor and on the wall, 0 to 1.
    impact_damping : array_like
        Of a floor whose restitution falls with the speed of impact, by Hunt and Crossley's law, per
        g/w; `restitution` then plays no part.
    wave : Wave or None
        The drive where it is no plain sine; the drive numbers are then what its push does not
        exceed.
    """

    drive_number_along: Numbers
    drive_number_normal: Numbers
    gravity_number_along: Numbers
    gravity_number_normal: Numbers
    friction_static: Numbers
    friction_kinetic: Numbers
    restitution: Numbers = 0.0
    drive_number_across: Numbers = 0.0
    gravity_number_across: Numbers = 0.0
    curvature_number: Numbers = 0.0
    wall_friction: Numbers = 0.0
    wall_restitution: Numbers = 0.0
    impact_damping: Numbers = 0.0
    wave: Wave | None = None

    @property
    def numbers(self) -> tuple[Numbers, ...]:
        """All fields except the wave."""
        return self[:-1]

    @property
    def drive(self) -> tuple[Numbers, Numbers, Numbers]:
        """The drive numbers along, across and normal."""
        return self.drive_number_along, self.drive_number_across, self.drive_number_normal

    def flat(self) -> Groups:
        """Return the groups with the numbers set to 0 that planar motion does not use."""
        nothing: dict[str, Any] = dict.fromkeys(ACROSS, 0.0)
        return self._replace(**nothing)

    def single(self) -> Groups:
        """Return the groups of one part as plain numbers; raise if there are several cells."""
        (part,), _ = each(self)
        return part


ACROSS = (
    "drive_number_across", "gravity_number_across", "curvature_number", "wall_friction",
    "wall_restitution",
)  # fmt: skip
"""Fields that play no part where nothing pushes the part across the track."""


class Contacts(NamedTuple):
    """The surfaces that a part can touch, and how: no number of a cell but what a system is.

    A wall beside the floor, or none; rolling m r^2/I for a cylinder whose axis lies along the
    track, 0 for a block.
    """

    wall: bool = False
    rolling: float = 0.0


BLOCK_ON_FLOOR = Contacts()
SOLID_CYLINDER = 2.0  # m r^2/I of a solid cylinder about its axis


def in_plane(groups: Groups, contacts: Contacts) -> NDArray[np.bool_]:
    """Return a mask of the cells whose motion stays in the vertical plane along the track.

    Nothing pushes such a part across: no drive, no lean and, with a wall, no curve.
    """
    pushed = np.not_equal(groups.drive_number_across, 0.0) | np.not_equal(
        groups.gravity_number_across, 0.0
    )
    if contacts.wall:
        pushed = pushed | np.not_equal(groups.curvature_number, 0.0)
    return np.asarray(~pushed)


def table(columns: Iterable[ArrayLike]) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    """Return the columns broadcast to one row per cell, and the shape of the cells."""
    arrays = np.broadcast_arrays(*(np.asarray(column, dtype=np.float64) for column in columns))
    return np.stack([array.ravel() for array in arrays], axis=-1), arrays[0].shape


def cells_of(groups: Groups, **settings: ArrayLike) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    """Return the input of kernels, a row of numbers for each cell, and the shape of the cells.

    The columns are the `groups`, the `settings` of a method, as in `kernels.cells.Cell`, and those
    of the wave, if there is one; all are broadcast.
    """
    columns, wave = (*groups.numbers, *settings.values()), groups.wave
    if wave is None:
        return table(columns)
    rows, shape = table((*columns, np.zeros(wave.cells)))
    return np.concatenate([rows[:, :-1], wave.columns(shape)], axis=1), shape


def groups_of(
    rows: NDArray[np.float64], waved: bool, more: int = 0
) -> tuple[Groups, NDArray[np.float64]]:
    """Return the groups of cells, and `more` settings, an array each; inverse of `cells_of`."""
    numbers = len(Groups._fields) - 1
    columns = rows.T
    wave = of_columns(rows[:, numbers + more :]) if waved else None
    return Groups._make((*columns[:numbers], wave)), columns[numbers : numbers + more]


def each(groups: Groups) -> tuple[Iterator[Groups], tuple[int, ...]]:
    """Return an iterator over the groups of each cell as plain numbers, and the cells' shape."""
    rows, shape = cells_of(groups)
    whole, _ = groups_of(rows, groups.wave is not None)

    def of(cell: int) -> Groups:
        own = None if whole.wave is None else Wave(*(part[..., cell] for part in whole.wave))
        return Groups._make((*(float(number[cell]) for number in whole.numbers), own))

    return map(of, range(len(rows))), shape


def of_quantities(*, load_number: Array, **numbers: Any) -> Groups:
    """Return the groups from quantities of their names; `load_number` is gravity onto the floor."""
    return Groups(gravity_number_normal=load_number, **numbers)
