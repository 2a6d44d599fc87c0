"""The track of a bowl: stretches of spirals, one after another from its start to the exit.

In a stretch the radius grows in proportion to the turned angle (spiral of Archimedes), and the
track climbs at one angle. Its length is that of the turn, 2 pi n r/cos(gamma); what the growth of
the radius adds, (dr/(2 pi n r))^2/2 of it, is left out: 1e-4 of a usual bowl (theory 15.6).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vibrafeed.core.mechanics.angles import cosine
from vibrafeed.core.mechanics.arrays import Array


class Stretches(NamedTuple):
    """The stretches of a track, from its start to its exit; tuples with an entry a stretch.

    Attributes
    ----------
    start, end : tuple of ndarray
        Radius at both ends [m].
    length : tuple of ndarray
        Length along the track [m].
    """

    start: tuple[Array, ...]
    end: tuple[Array, ...]
    length: tuple[Array, ...]


def stretches_of(
    start_radius: Array, radii: Sequence[Array], turns: Sequence[Array], climbs: Sequence[Array]
) -> Stretches:
    """Return the stretches of a bowl's track: their radii at both ends and their lengths [m].

    `radii` are those at the end of each stretch [m]; a stretch begins where the one before ends,
    the first at `start_radius` [m]. `turns` are turns n about the bowl, `climbs` angles gamma
    [rad]. The length of a stretch from radius r_1 to r_2 is pi n (r_1 + r_2)/cos(gamma) (theory
    15.6).
    """
    starts = (start_radius, *radii[:-1])
    lengths = tuple(
        np.pi * count * (first + last) / cosine(climb)
        for first, last, count, climb in zip(starts, radii, turns, climbs, strict=True)
    )
    return Stretches(tuple(starts), tuple(radii), lengths)


def total_length(stretches: Stretches) -> Array:
    """Return the length of the track [m]."""
    total: Array = sum(stretches.length[1:], stretches.length[0])
    return total


def bounds(stretches: Stretches) -> list[Array]:
    """Return the shares of the track's length at which stretches begin, then 1 for the exit [1].

    From the lengths of the `stretches`, in the order of travel. One array more than there are
    stretches; the first is 0.
    """
    total, passed = total_length(stretches), [0.0 * stretches.length[0]]
    for length in stretches.length:
        passed.append(passed[-1] + length)
    return [one / total for one in passed[:-1]] + [np.ones_like(total)]


def radius_at(fraction: Array, stretches: Stretches) -> Array:
    """Return the radius of the track at a share of its length [m].

    `fraction` is that share, 0 at the start and 1 at the exit. On a stretch from radius r_1 to r_2,
    r^2 = r_1^2 + (r_2^2 - r_1^2) x at the share x of its own length, since dr ~ dphi and ds ~ r
    dphi.
    """
    ends = bounds(stretches)
    radii = []
    for first, last, low, high in zip(
        stretches.start, stretches.end, ends[:-1], ends[1:], strict=True
    ):
        x = np.clip((fraction - low) / (high - low), 0.0, 1.0)
        radii.append(np.sqrt(np.square(first) + (np.square(last) - np.square(first)) * x))
    return picked(fraction, stretches, radii)


def picked(fraction: Array, stretches: Stretches, values: Sequence[Array]) -> Array:
    """Return the value, of one a stretch, that holds at a place of a bowl's track.

    `fraction` is the place as a share of the track's length, 0 to 1; `values` has an array for each
    of the `stretches` (climb, friction, ...). Where two stretches meet, the later one holds.
    """
    value = values[0]
    for low, later in zip(bounds(stretches)[1:-1], values[1:], strict=True):
        value = np.where(fraction >= low, later, value)
    return np.asarray(value)
