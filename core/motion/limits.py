"""The demands of a drive on the machine, by axis: largest acceleration, stroke, largest jerk.

Of the plain sine in closed form; of any other wave as `vibrafeed.core.motion.waves` finds it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, ratio
from vibrafeed.core.motion import waves
from vibrafeed.core.motion.groups import Contacts, Groups, in_plane
from vibrafeed.core.motion.waves import Wave
from vibrafeed.core.quantities.drives import AXES, WHERE
from vibrafeed.core.scenes.scene import Equation, arguments_of


@dataclass(frozen=True)
class Limit:
    """A demand of a drive on the machine along one axis, such as its stroke.

    Attributes
    ----------
    says
        Its description, with {} for the axis, and its unit.
    scale
        Function that gives its scale from quantities by name, SI units.
    of_sine
        Its value for a sine in that scale, over the drive number of the axis.
    of_wave
        Function that gives its value in that scale from a wave and an axis.
    """

    says: str
    scale: Callable[..., Array]
    of_sine: float
    of_wave: Callable[[Wave, int], Array]


LIMITS = {
    "largest_acceleration": Limit(
        "largest acceleration of the track {} over a period [m s-2]",
        lambda *, gravity: gravity,
        1.0,
        lambda wave, axis: waves.largest_over_period(wave, axis, "push size"),
    ),
    "stroke": Limit(
        "stroke of the drive {}, peak to peak [m]",
        lambda *, length_scale: length_scale,
        2.0,
        waves.stroke,
    ),
    "largest_jerk": Limit(
        "largest jerk of the drive {}, infinite where its acceleration jumps [m s-3]",
        lambda *, gravity, frequency: gravity * (waves.TURN * frequency),
        1.0,
        waves.jerk,
    ),
}


def equations(drive: str, axes: tuple[str, ...] = AXES) -> tuple[Equation, ...]:
    """Return the equations of the limits of the drive, such as its stroke, for a sine or a wave.

    `drive` is "sine" or "wave"; there is one equation for each limit and each of the `axes` (along,
    across, normal), by which a study may ask for it.
    """
    return tuple(
        _equation(name, limit, axis, drive) for name, limit in LIMITS.items() for axis in axes
    )


def _equation(name: str, limit: Limit, axis: str, drive: str) -> Equation:
    number, place = f"drive_number_{axis}", AXES.index(axis)
    drive_input = "wave" if drive == "wave" else number

    def value(**known: Array) -> Array:
        drive_value = known.pop(drive_input)
        scale = limit.scale(**known)
        if isinstance(drive_value, Wave):
            return limit.of_wave(drive_value, place) * scale
        return limit.of_sine * np.abs(drive_value) * scale

    needs = (drive_input, *arguments_of(limit.scale))
    says = f"Return the {limit.says.format(WHERE[axis])}."
    return Equation(f"{name}_{axis}", value, "theory 13.14", needs=needs, says=says)


# --- the fastest that any drive along the track conveys a part (docs/best-wave.md)


def fastest_velocity(
    *, groups: Groups, largest_acceleration_along: Array, frequency: Array, gravity: Array
) -> Array:
    """Return the largest mean velocity that any drive with a bounded acceleration gives [m s-1].

    `largest_acceleration_along` bounds the acceleration of the track [m s-2], `frequency` [Hz] is
    that of the drive, `groups` are the dimensionless groups of the part. A study's own drive is
    compared with it. 0 where no such drive frees the part forward. NaN where the bound does not
    hold: something drives the part off the floor or across, the track falls, or it is too steep for
    the part to lie on.
    """
    along, onto = (
        np.asarray(groups.gravity_number_along),
        np.asarray(groups.gravity_number_normal),
    )
    most = largest_acceleration_along / gravity
    holding, braking = groups.friction_static * onto - along, groups.friction_kinetic * onto + along
    share = ratio(holding, holding + braking, 0.0)
    best = share**2 * ratio(most**2 - braking**2, 4 * most, 0.0) * gravity / frequency
    freed = most > groups.friction_static * onto + along
    holds = (along >= 0.0) & (holding >= 0.0) & (np.asarray(groups.drive_number_normal) == 0.0)
    holds = holds & in_plane(groups, Contacts(wall=True))
    return np.where(holds & ~np.isnan(most), np.where(freed, best, 0.0), np.nan)


def share_of_fastest(*, conveying_velocity: Array, fastest_velocity: Array) -> Array:
    """Return the conveying velocity over the largest that the same acceleration can give [1]."""
    return ratio(conveying_velocity, fastest_velocity, np.nan)
