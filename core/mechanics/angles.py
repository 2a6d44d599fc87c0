"""Sines and cosines of angles, exact at whole multiples of 90 degrees.

Angles are degrees for people and radians inside, and no float is pi/2: its cosine is 6e-17. A part
on a plane would roll for that, and an infinite throw number be 8e15. Therefore an angle is reduced
while it is in degrees, where that is exact, and the float that a multiple of 90 degrees becomes
counts as that multiple. Every other float has numpy's sine and cosine, to the bit.

`sine` and `cosine` are made of numpy's functions alone: numbers of 50 digits go through them
as arrays do.
"""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask

QUARTER = np.pi / 2
TINY = 2.0**-200  # far below the distance of any other float from a multiple of 90 degrees


def radians(degrees: Array) -> Array:
    """Return angles in radians for angles in degrees.

    Whole turns go first, in degrees, where that is exact: the result lies between -pi and pi, and a
    multiple of 90 degrees becomes the float nearest to it.
    """
    turn = np.fmod(degrees, 360.0)
    turn = turn - np.where(np.abs(turn) > 180.0, np.copysign(360.0, turn), 0.0)
    return np.asarray(np.deg2rad(turn + 0.0))  # -0.0 is 0


def sine(angle: Array) -> Array:
    """Return sin(angle), exactly 0 at the floats that are nearest to multiples of pi."""
    nearest, apart, on_axis = _axis(angle)
    slope = np.rint(np.cos(nearest))
    return np.where(on_axis & (slope != 0), 0.0 + slope * apart, np.sin(angle))


def cosine(angle: Array) -> Array:
    """Return cos(angle), exactly 0 at the floats that are nearest to odd multiples of pi/2."""
    nearest, apart, on_axis = _axis(angle)
    slope = np.rint(np.sin(nearest))
    return np.where(on_axis & (slope != 0), 0.0 - slope * apart, np.cos(angle))


def _axis(angle: Array) -> tuple[Array, Array, Mask]:
    """Return the nearest multiple of pi/2, the angle less it, and a mask where both are equal.

    All in radians.
    """
    nearest = np.rint(angle / QUARTER) * QUARTER
    apart = angle - nearest
    return nearest, apart, np.rint(apart / TINY) == 0
