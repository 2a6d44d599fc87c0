"""The four numbers that planar motion without restitution depends on (theory 13.8, 13.10).

The equation along the track is u' = c sin(tau) - g_s -+ mu N(tau), and N, the load on the floor,
knows nothing of the motion along it. Divided by mu times the mean load, friction is gone but for
the ratio of its two coefficients. So equal numbers move alike, with velocities in units of

    A0 w sqrt(cos(beta)^2 + (mu_k sin(beta))^2),

the drive's speed as friction sees it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.motion.groups import Groups


class Numbers(NamedTuple):
    """The four numbers; fields broadcast."""

    throw_number: Array
    angle_number: Array
    slope_number: Array
    friction_ratio: Array


@dataclass(frozen=True)
class AtlasAxis:
    """One of the four numbers of an atlas: label, definition, and least and largest value."""

    label: str
    definition: str
    least: float
    largest: float

    def attributes(self) -> dict[str, Any]:
        """Return the attributes of the axis in a dataset."""
        return {"units": "1", "long_name": self.label, "comment": self.definition}


AXES: Mapping[str, AtlasAxis] = {
    "throw_number": AtlasAxis(
        "Throw number",
        "A0 w^2 sin(beta) / (g cos(gamma)), with a hold-down added to g cos(gamma)",
        0.02, 3.72,
    ),
    "angle_number": AtlasAxis(
        "Friction times tan(beta)", "friction_kinetic tan(beta)", 0.008, 5.0
    ),
    "slope_number": AtlasAxis(
        "Slope over friction",
        "tan(gamma) / friction_kinetic, less if a hold-down presses the part on", -0.9, 0.9,
    ),
    "friction_ratio": AtlasAxis(
        "Static over kinetic friction", "friction_static / friction_kinetic", 1.0, 1.6,
    ),
}  # fmt: skip

HOP = 1.0
"""Throw number above which the part leaves the floor."""

HOP_AFTER_HOP = float(np.hypot(1.0, np.pi))
"""Throw number above which it takes off where it lands (theory 13.7)."""


def numbers_of(groups: Groups) -> tuple[Numbers, Array]:
    """Return the four atlas numbers of parts and drives, and the unit of their velocity numbers.

    `groups` are the dimensionless groups of the motion: drive and gravity along the track and
    normal to it, over g, and the friction coefficients. The unit is the drive's speed as friction
    sees it, in units of g/w. It is negative where the drive pushes backwards: the part is then the
    mirror image, with forwards and backwards exchanged. Numbers without a value are infinite or
    NaN. All arrays have the shape of the groups, broadcast.
    """
    c, s = np.asarray(groups.drive_number_along), np.asarray(groups.drive_number_normal)
    slope, load = np.asarray(groups.gravity_number_along), groups.gravity_number_normal
    # A drive that points down pushes up half a turn later.
    turn = np.where(s < 0, -1.0, 1.0)
    c, s = c * turn, s * turn
    way = np.where(c < 0, -1.0, 1.0)
    friction = np.asarray(groups.friction_kinetic)
    with np.errstate(divide="ignore", invalid="ignore"):
        numbers = Numbers(
            s / load,
            friction * s / np.abs(c),
            way * slope / (friction * load),
            groups.friction_static / friction,
        )
    return numbers, way * np.hypot(c, friction * s)


def groups_at(numbers: Numbers) -> Groups:
    """Return dimensionless groups of a motion that have the given four numbers of the atlas.

    The values of an atlas are simulated with these groups. Many groups have the same numbers; these
    have the load normal to the track and the kinetic friction 1. Groups are drive and gravity along
    and normal to the track over g, and both friction coefficients, in the shape of `numbers` or
    scalars.
    """
    throw, angle, slope, ratio = numbers
    return Groups(
        drive_number_along=throw / angle,
        drive_number_normal=throw,
        gravity_number_along=slope,
        gravity_number_normal=1.0,
        friction_static=ratio,
        friction_kinetic=1.0,
    )


def rests(numbers: Numbers) -> Mask:
    """True where friction holds the part on the track all the time (theory 13.8 iv).

    `numbers` are the four atlas numbers, which broadcast; the mask has their shape. Push and load
    are linear in sin(tau), tau being the phase of the drive: it is enough to compare them at the
    ends, sin(tau) = 1 (`up`) and -1 (`down`), and the throw number has to be at most 1.
    """
    throw, angle, slope, ratio = numbers
    with np.errstate(divide="ignore", invalid="ignore"):
        along = throw / angle
    up = along + ratio * throw <= ratio + slope
    down = np.abs(along - ratio * throw) <= ratio - slope
    return np.asarray((throw <= HOP) & up & down)


def out_of_range(numbers: Numbers) -> dict[str, NDArray[np.bool_]]:
    """Return masks of the values that an atlas does not cover, by name of the dimensionless number.

    `numbers` are the four dimensionless numbers of the atlas; each mask has the shape of its number
    and is True outside the range of that axis, and for NaN.
    """
    return {
        name: ~((values >= axis.least) & (values <= axis.largest))
        for (name, axis), values in zip(AXES.items(), numbers, strict=True)
    }
