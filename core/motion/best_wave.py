"""The fastest that any drive along the track conveys a part under a limit of its acceleration.

A part on a track that is level or climbs, which nothing pushes off the floor or across: friction
holds it while the track gains less than h, and b brakes it while it slides forward,

    h = mu_s g cos(gamma) - g sin(gamma),    b = mu_k g cos(gamma) + g sin(gamma).

With |a| <= a_m over the period T no mean velocity is above

    v = T h^2 (a_m^2 - b^2)/(4 a_m (h + b)^2),

and one wave comes as near as one likes: +h over b T/(h + b), which carries the part, then -a_m,
then +a_m until the part is caught at the end of the period. That there is a best wave, and its
three phases, were found by Umbanhowar and Lynch (2008); value and proof (docs/best-wave.md) are our
own.
"""

from __future__ import annotations

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, ratio
from vibrafeed.core.motion.groups import Contacts, Groups, in_plane


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
