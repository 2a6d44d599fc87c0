"""Rates that people use: parts a minute, and the effective distance behind a speed."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.mechanics.arrays import Array
from vibrafeed.core.mechanics.travel import distance_bound
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.study.units import UnitError, in_own_unit, problem

_MEASURED: Final = {
    "velocity": "conveying_velocity", "gap": "part_gap", "parts_per_minute": "feed_rate"
}  # fmt: skip
"""The quantities of arguments that have a name of their own."""


def parts_per_minute(*, velocity: Array, length: Array, gap: Array | float = 0.0) -> Array:
    """Return the number of parts that arrive per minute at a mean velocity, theory 13.12 [min-1].

    Parameters
    ----------
    velocity : ndarray
        Mean conveying velocity [m s-1].
    length, gap : ndarray
        Length of a part along the track, and free length between two parts [m]; together above 0.

    Raises
    ------
    StudyError
        If a part takes no length, or an array carries the unit of another quantity.

    Examples
    --------
    >>> float(round(vibrafeed.parts_per_minute(velocity=0.03, length=0.012, gap=0.003), 9))
    120.0
    """
    velocity, length, gap = _in_own_units(velocity=velocity, length=length, gap=gap)
    return 60.0 * velocity / _spacing(length, gap)


def velocity_for(*, parts_per_minute: Array, length: Array, gap: Array | float = 0.0) -> Array:
    """Return the mean velocity that a rate needs; inverse of `parts_per_minute` [m s-1].

    Examples
    --------
    >>> round(vibrafeed.velocity_for(parts_per_minute=120, length=0.012, gap=0.003), 15)
    0.03
    """
    rate, length, gap = _in_own_units(parts_per_minute=parts_per_minute, length=length, gap=gap)
    return rate * _spacing(length, gap) / 60.0


def effective_distance(
    *, velocity: Array, starting_acceleration: Array, friction_kinetic: Array, radius: Array
) -> Array:
    """Return the distance x at which (3.18) from rest gives a speed (theory 13.12) [m].

    The speed may be simulated or measured. Infinite where (3.18) never reaches it: at or above the
    terminal velocity, where the part does not start, and for a speed the other way, below 0.

    Parameters
    ----------
    velocity : ndarray
        The speed [m s-1].
    starting_acceleration : ndarray
        Acceleration of the part from rest [m s-2].
    friction_kinetic : ndarray
        Coefficient of friction in sliding.
    radius : ndarray
        Radius of the bowl's wall [m].

    Examples
    --------
    >>> distance = vibrafeed.effective_distance(
    ...     velocity=0.03, starting_acceleration=4.0, friction_kinetic=0.3, radius=0.2
    ... )
    >>> round(1e6 * float(distance))
    113
    """
    velocity, starting_acceleration, friction_kinetic, radius = _in_own_units(
        velocity=velocity,
        starting_acceleration=starting_acceleration,
        friction_kinetic=friction_kinetic,
        radius=radius,
    )
    distance = distance_bound(
        starting_acceleration=starting_acceleration,
        velocity_bound=velocity,
        friction_kinetic=friction_kinetic,
        radius=radius,
    )
    return np.where(velocity < 0, np.inf, distance)


def _in_own_units(**values: Any) -> list[Any]:
    """Return arguments of a function here, converted where an array carries another unit.

    Raises `StudyError` for a unit of another quantity.
    """
    read, problems = [], []
    for name, value in values.items():
        try:
            read.append(in_own_unit(name, QUANTITIES[_MEASURED.get(name, name)], value))
        except UnitError as error:
            problems.append(problem(name, error))
    if problems:
        raise StudyError(problems)
    return read


def _spacing(length: Array, gap: Array | float) -> Array:
    """Return the length of track that one part occupies, `length` plus `gap` [m].

    Raises `StudyError` if it is not above 0.
    """
    spacing = length + gap
    if np.any(spacing <= 0.0):
        fix = "Give length or gap above 0"
        raise StudyError(
            [
                Problem(
                    "length", "length plus gap, the track that one part takes, is not above 0", fix
                )
            ]
        )
    return spacing
