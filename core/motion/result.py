"""The result of every method."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.mechanics.arrays import Array, Mask
from vibrafeed.core.quantities import MOTION_STATUSES
from vibrafeed.core.scenes.scene import Condition


class Motion(NamedTuple):
    """Motion over a period of the drive once it repeats, in the scales of the drive.

    All arrays have one shape, that of the arguments broadcast. Lengths are in g/w^2, velocities in
    g/w, times in 1/w, where w is the circular frequency (theory 13.8).

    Attributes
    ----------
    velocity : ndarray
        Mean velocity along the track; NaN where there is none.
    spread : ndarray
        Standard deviation of the means of runs from several phases, or of batches of periods; 0
        where the motion repeats.
    error : ndarray
        Estimate of the error of `velocity` by the method itself.
    stick, forward, backward, flight : ndarray
        Fractions of the period; they add up to 1.
    impacts : ndarray
        Impacts on the floor per period; a run of ever smaller hops counts as those resolved.
    landing_speed : ndarray
        Largest speed normal to the floor before an impact.
    hop_height : ndarray
        Largest distance from the floor.
    multiple : ndarray
        Periods of the drive after which the motion repeats; 0 where it does not.
    across : ndarray
        Mean velocity across the track, away from the wall; 0 where the part comes back to a wall,
        and of one that rolls, which keeps the speed that it happens to have.
    status : ndarray of int8
        Value of a `MOTION_STATUSES` entry.
    """

    velocity: Array
    spread: Array
    error: Array
    stick: Array
    forward: Array
    backward: Array
    flight: Array
    impacts: Array
    landing_speed: Array
    hop_height: Array
    multiple: Array
    across: Array
    status: NDArray[np.int8]

    def only(self, name: str) -> Mask:
        """True where a part moves in one way all the time; every other way has share 0.

        `name` is one of `SHARES`.
        """
        others = [getattr(self, other) for other in SHARES if other != name]
        moves = np.asarray(getattr(self, name) > 0)
        return np.logical_and.reduce([moves, *(other == 0 for other in others)])


class Energy(NamedTuple):
    """Means over the cycle of a motion that repeats, per mass, in g^2/w; NaN of any other motion.

    All arrays have the shape of the arguments broadcast.

    Attributes
    ----------
    friction : ndarray
        What friction takes while contacts slip.
    impact : ndarray
        What impacts take, the friction in them included.
    drive : ndarray
        The work of the track: friction, impacts, and what lifts the part.
    swing : ndarray
        Mean of u.b', u the velocity relative to the track, b' the derivative of the push by the
        phase: what of the part swings with the track. NaN under a drive that is no plain sine.
    """

    friction: Array
    impact: Array
    drive: Array
    swing: Array


STATUS: Mapping[str, int] = {name: flag.value for name, flag in MOTION_STATUSES.items()}

ANSWERED = ("periodic", "at_rest", "aperiodic", "sensitive", "neutral")
"""Statuses of cells that have a mean velocity."""

SHARES = ("stick", "forward", "backward", "flight")
"""The modes of motion; each has a share of the period, exactly 0 where it never came."""

COLUMNS = len(Motion._fields) - 1
"""Columns of a kernel's table, one a field of `Motion` in its order, without the status."""


def motion_of(
    table: NDArray[np.float64], status: NDArray[np.int8], shape: tuple[int, ...]
) -> Motion:
    """Return a kernel's result table as a `Motion` of arrays of a shape.

    `table` has a row a cell and a column a field, `status` one value a cell.
    """
    columns = [np.ascontiguousarray(column).reshape(shape) for column in table.T]
    return checked(Motion._make([*columns, status.reshape(shape)]))


def checked(motion: Motion) -> Motion:
    """Return the motion with NaN wherever the status says that there is no result.

    A cell with a value that is not finite, or that was in the air all along without landing, gets
    the status `limit_reached`. With this status all values are NaN, since a method may have got
    some way.
    """
    answered = np.isin(motion.status, [STATUS[name] for name in ANSWERED])
    finite = np.logical_and.reduce([np.isfinite(field) for field in motion[:-1]])
    on_floor = motion.stick + motion.forward + motion.backward
    never_landed = (motion.flight > 0) & (motion.impacts == 0) & (on_floor == 0)
    lost = answered & (~finite | never_landed)
    status = np.where(lost, np.int8(STATUS["limit_reached"]), motion.status)
    none = status == STATUS["limit_reached"]
    fields = [np.where(none, np.nan, field) for field in motion[:-1]]
    return with_whole_shares(Motion._make([*fields, status]))


def with_whole_shares(motion: Motion) -> Motion:
    """Return the motion with a share of exactly 1 where a part moves in one way only.

    The stretches of a period add up to the whole of it but for rounding, and rounding differs from
    one processor to the next.
    """
    whole = {name: np.where(motion.only(name), 1.0, getattr(motion, name)) for name in SHARES}
    return motion._replace(**whole)


def where(
    regime: str,
    says: str,
    holds: Callable[..., Mask],
    outputs: Collection[str],
    otherwise: str = "",
) -> Condition:
    """Return the condition of a regime; `says` is as one says after "True where"."""
    holds.__doc__ = f"True where {says}."
    return Condition(regime, holds, frozenset(outputs), otherwise)


def with_status(
    regime: str, names: tuple[str, ...], outputs: Collection[str], otherwise: str = ""
) -> Condition:
    """Return the condition of a regime in which the motion has one of some statuses."""
    values = [STATUS[name] for name in names]
    says = f"the status is {' or '.join(names)}"
    return where(regime, says, lambda *, motion: np.isin(motion.status, values), outputs, otherwise)
