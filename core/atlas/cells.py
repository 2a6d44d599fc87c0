"""Exact values at some numbers: the events kernel, in the units of the atlas."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.atlas.numbers import Numbers, groups_at
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.motion.methods.events import EVENTS, planar_motion
from vibrafeed.core.motion.result import SHARES, STATUS, Motion
from vibrafeed.core.quantities import REGIMES
from vibrafeed.core.watch import Watch

BITS = {name: 1 << position for position, name in enumerate(SHARES)}
"""The ways of moving as bits of a pattern; 0 where there is no answer."""


class Cells(NamedTuple):
    """Exact values of cells, arrays of one shape.

    Attributes
    ----------
    velocity : ndarray
        Mean velocity, in the unit of `numbers_of`; NaN where there is none.
    stick, forward, backward, flight : ndarray
        Shares of the period in which the part sticks, slides forward or backward, or flies.
    pattern : ndarray of int8
        The ways of moving that have a share, as bits; 0 where there is no answer.
    """

    velocity: Array
    stick: Array
    forward: Array
    backward: Array
    flight: Array
    pattern: NDArray[np.int8]


def follow(numbers: Numbers, watch: Watch | None = None) -> Motion:
    """Return the exact motion of parts, given by the four numbers of the atlas."""
    return planar_motion(groups_at(numbers), **EVENTS.defaults, watch=watch)


def exact(numbers: Numbers, watch: Watch | None = None) -> Cells:
    """Return the exact motion of parts, as reference values for the cells of an atlas.

    Parameters
    ----------
    numbers : Numbers
        The four dimensionless numbers of each part and drive, arrays of one shape: throw, angle,
        slope and ratio of the friction coefficients.
    watch : Watch, optional
        May stop the simulation.

    Returns
    -------
    Cells
        Mean velocity, in units of the drive's speed as friction sees it (`numbers_of`); shares of
        the period that the part sticks, slides and flies; pattern of these as bits. Arrays of the
        same shape.
    """
    motion = follow(numbers, watch)
    unit = np.hypot(numbers.throw_number, numbers.throw_number / numbers.angle_number)
    shares = [getattr(motion, name) for name in SHARES]
    return Cells._make((motion.velocity / unit, *shares, pattern_of(motion)))


def pattern_of(motion: Motion) -> NDArray[np.int8]:
    """Return the pattern of each motion: the sum of a bit for each way of moving that occurs.

    The ways are sticking, sliding forwards, sliding backwards and flying (`BITS`). The pattern is 0
    if the part neither rests nor repeats its motion in every single period. An atlas interpolates
    only between nodes of one pattern, since velocity has kinks where the pattern changes.
    """
    bits = sum(np.where(getattr(motion, name) > 0, bit, 0) for name, bit in BITS.items())
    sound = np.isin(motion.status, [STATUS["periodic"], STATUS["at_rest"]])
    ways: NDArray[np.int8] = np.where(sound & (motion.multiple == 1), bits, 0).astype(np.int8)
    return ways


def _regime(pattern: int) -> int:
    """Return the number of the regime that a pattern of motion belongs to.

    `pattern` is the sum of the bits (`BITS`) of the ways of moving that occur in a period; 0, where
    they are unknown, is the regime `unresolved`.
    """
    name = "slip"
    if pattern == 0:
        name = "unresolved"
    elif pattern == BITS["stick"]:
        name = "stick"
    elif pattern & BITS["flight"]:
        name = "hop_after_hop" if pattern == BITS["flight"] else "hopping"
    elif pattern & BITS["stick"]:
        name = "stick_slip"
    return REGIMES[name].value


_OF_PATTERN = np.array([_regime(pattern) for pattern in range(1 << len(BITS))], dtype=np.int8)

REGIMES_STORED = ("stick", "slip", "stick_slip", "hopping", "hop_after_hop", "unresolved")
"""The regimes that an atlas can hold."""


def regime_of(pattern: NDArray[np.int8]) -> NDArray[np.int8]:
    """Return the regime of each pattern, with the names that simulations use."""
    return np.asarray(_OF_PATTERN[pattern])
