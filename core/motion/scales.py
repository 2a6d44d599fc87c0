"""The numbers that a motion depends on, and the way back to metres (theory 13.8, 13.10).

With length g/w^2 and velocity g/w only the drive's share of gravity, angles, friction, restitution
and the curvature are left. All functions take and return broadcastable float64 arrays.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask, cosine, ratio, sine
from vibrafeed.core.mechanics.floor import throw
from vibrafeed.core.motion.result import Energy, Motion
from vibrafeed.core.scenes.scene import Condition, Equation


def drive_number(*, vibration_acceleration: Array, gravity: Array) -> Array:
    """Return the drive number, p = P/g [1]."""
    return vibration_acceleration / gravity


def drive_number_along(*, drive_number: Array, alpha: Array, beta: Array) -> Array:
    """Return the drive number along the track, p cos(beta) cos(alpha) [1]."""
    return drive_number * (cosine(beta) * cosine(alpha))


def drive_number_across(*, drive_number: Array, alpha: Array, beta: Array) -> Array:
    """Return the drive number across the track, p cos(beta) sin(alpha) [1]."""
    return drive_number * (cosine(beta) * sine(alpha))


def drive_number_normal(*, drive_number: Array, beta: Array) -> Array:
    """Return the drive number normal to the floor, p sin(beta) [1]."""
    return drive_number * sine(beta)


def gravity_number_along(*, gamma: Array) -> Array:
    """Return the share of gravity along the track, sin(gamma) [1]."""
    return sine(gamma)


def gravity_number_across(*, gamma: Array, delta: Array) -> Array:
    """Return the share of gravity towards the wall, cos(gamma) sin(delta) [1]."""
    return cosine(gamma) * sine(delta)


def gravity_number_normal(*, gamma: Array) -> Array:
    """Return the share of gravity onto a floor without lean, cos(gamma) [1]."""
    return cosine(gamma)


def leaning_gravity_number_normal(*, gamma: Array, delta: Array) -> Array:
    """Return the share of gravity onto the floor, cos(gamma) cos(delta) [1]."""
    return cosine(gamma) * cosine(delta)


def wall_friction(*, friction_kinetic: Array) -> Array:
    """Return the floor's kinetic friction, for a wall of the same material [1]."""
    return friction_kinetic


def wall_restitution(*, restitution: Array) -> Array:
    """Return the floor's restitution, for a wall of the same material [1]."""
    return restitution


def acceleration_scale(*, gravity: Array) -> Array:
    """Return the acceleration of gravity, g [m s-2]."""
    return gravity


def hold_down(*, hold_down_force: Array, mass: Array) -> Array:
    """Return the force per mass that holds the part down [m s-2]."""
    return hold_down_force / mass


def hold_down_number(*, hold_down: Array, acceleration_scale: Array) -> Array:
    """Return the force per mass that holds the part down, over gravity [1]."""
    return hold_down / acceleration_scale


def load_number(*, gravity_number_normal: Array, hold_down_number: Array) -> Array:
    """Return the mean load on the floor: gravity's, and what holds the part down, over m g [1]."""
    return gravity_number_normal + hold_down_number


def throw_number(*, drive_number_normal: Array, load_number: Array) -> Array:
    """Return the throw number, drive over load normal to the floor [1]."""
    return throw(drive_number_normal, load_number)


def velocity_scale(*, gravity: Array, frequency: Array) -> Array:
    """Return the velocity scale, g/w with w = 2 pi f [m s-1]."""
    return gravity / (2 * np.pi * frequency)


def length_scale(*, gravity: Array, frequency: Array) -> Array:
    """Return the length scale, g/w^2 with w = 2 pi f [m]."""
    return gravity / np.square(2 * np.pi * frequency)


def curvature_number(*, length_scale: Array, radius: Array) -> Array:
    """Return the curvature number, g/(w^2 R) [1]."""
    return length_scale / radius


def conveying_velocity(*, motion: Motion, velocity_scale: Array) -> Array:
    """Return the mean velocity along the track, over whole cycles of the motion [m s-1]."""
    return motion.velocity * velocity_scale


def conveying_velocity_spread(*, motion: Motion, velocity_scale: Array) -> Array:
    """Return the standard deviation of means of runs from several phases [m s-1]."""
    return motion.spread * velocity_scale


def conveying_velocity_error(*, motion: Motion, velocity_scale: Array) -> Array:
    """Return the method's own estimate of the error of the conveying velocity [m s-1]."""
    return motion.error * velocity_scale


def velocity_across(*, motion: Motion, velocity_scale: Array) -> Array:
    """Return the mean velocity across the track, towards +y, over whole cycles [m s-1]."""
    return motion.across * velocity_scale


def efficiency(*, motion: Motion, drive_number_along: Array) -> Array:
    """Return the conveying velocity over the track's largest velocity along itself; 0 at rest [1].

    `motion.velocity` and `drive_number_along`, p cos(beta) cos(alpha), are both in the scale g/w (w
    = 2 pi f): the quotient is v/(A0 w cos(beta) cos(alpha)). Infinite (regime `unbounded`) for a
    part that moves though the drive along the track is 0, or so small that the quotient is beyond
    the floats.
    """
    v = motion.velocity
    beyond = np.where(np.isnan(v), np.nan, np.copysign(np.inf, v))
    with np.errstate(over="ignore"):
        return np.where(v != 0, ratio(v, drive_number_along, beyond), 0.0)


def efficiency_is_unbounded(*, efficiency: Array) -> Mask:
    """True where the part moves and the drive along the track is 0, or next to nothing."""
    return np.isinf(efficiency)


def landing_speed(*, motion: Motion, velocity_scale: Array) -> Array:
    """Return the largest speed normal to the floor before an impact [m s-1]."""
    return motion.landing_speed * velocity_scale


def hop_height(*, motion: Motion, length_scale: Array) -> Array:
    """Return the largest distance from the floor [m]."""
    return motion.hop_height * length_scale


# --- the energy that a motion takes (theory 13.15)


ENERGY_SOURCE = "theory 13.15"

WORKS = {
    "friction": "what friction takes while contacts slip",
    "impact": "what impacts take, with the friction in them",
    "drive": "the work of the track",
}
"""Fields of `Energy`, and what they are."""


def _power(kind: str) -> Callable[..., Array]:
    """Return the function of the equation for one kind of mean power of a part, per mass.

    `kind` is a field of the record `Energy`, such as friction, impact or drive. The function takes
    the means over a cycle in the scale of the drive, and returns W kg-1.
    """

    def power(*, energy: Energy, gravity: Array, velocity_scale: Array) -> Array:
        power: Array = getattr(energy, kind) * (gravity * velocity_scale)
        return power

    power.__doc__ = f"Return {WORKS[kind]}, mean over the cycle, per mass [W kg-1]."
    return power


def _work(kind: str) -> Callable[..., Array]:
    """Return the function of the equation for one kind of work of a part, per mass and way.

    `kind` is a field of the record `Energy`, such as friction, impact or drive. The function takes
    the means of this work and of the motion, and gravity, and returns J kg-1 m-1.
    """

    def work(*, energy: Energy, motion: Motion, gravity: Array) -> Array:
        return _a_metre(getattr(energy, kind), motion) * gravity

    work.__doc__ = f"""Return {WORKS[kind]}, per mass and metre travelled [J kg-1 m-1].

    Either way along the track. Infinite (regime `unbounded`) where it is done without travel; NaN
    where neither is.
    """
    return work


def _a_metre(energy: Array, motion: Motion) -> Array:
    """Return an energy per distance travelled; infinite or NaN without travel.

    `energy` is a mean power per mass in g^2/w (w = 2 pi f), divided by the mean velocity in g/w:
    the result is in g. Infinite if it is above 0 without travel, NaN if both are 0.
    """
    beyond = np.where(energy > 0, np.inf, np.nan)
    with np.errstate(over="ignore"):
        return ratio(energy, np.abs(motion.velocity), beyond)


def effective_mass_ratio(*, energy: Energy, drive_number: Array) -> Array:
    """Return the mass that the drive feels of a part, over its own, 1 + 2 <u.b'>/p^2 [1].

    The first harmonic of the part's force on the track, in phase with the track's acceleration. 1
    for a part that sticks; NaN under a drive that is no plain sine.
    """
    return 1.0 + ratio(2.0 * energy.swing, np.square(drive_number), 0.0)


def part_drive_power(*, drive_power: Array, mass: Array) -> Array:
    """Return the work of the track on a part, mean over the cycle [W]."""
    return drive_power * mass


def part_friction_power(*, friction_power: Array, mass: Array) -> Array:
    """Return the power of friction on a part while contacts slip, mean over the cycle [W]."""
    return friction_power * mass


def part_impact_power(*, impact_power: Array, mass: Array) -> Array:
    """Return the power that impacts take from a part, mean over the cycle [W]."""
    return impact_power * mass


def part_drive_work(*, drive_work: Array, mass: Array) -> Array:
    """Return the work of the track on a part, per metre travelled [J m-1]."""
    return drive_work * mass


def part_friction_work(*, friction_work: Array, mass: Array) -> Array:
    """Return the work of friction on a part while contacts slip, per metre travelled [J m-1]."""
    return friction_work * mass


def part_impact_work(*, impact_work: Array, mass: Array) -> Array:
    """Return the work of impacts on a part, per metre travelled [J m-1]."""
    return impact_work * mass


def work_is_unbounded(*, energy: Energy, motion: Motion) -> Mask:
    """True where the drive works on a part that does not travel."""
    return np.isinf(_a_metre(energy.drive, motion))


ENERGY_RESULTS = (
    *(Equation(f"{kind}_power", _power(kind), ENERGY_SOURCE) for kind in WORKS),
    *(Equation(f"{kind}_work", _work(kind), ENERGY_SOURCE) for kind in WORKS),
    *(
        Equation(function.__name__, function, ENERGY_SOURCE)
        for function in (
            part_friction_power,
            part_impact_power,
            part_drive_power,
            part_friction_work,
            part_impact_work,
            part_drive_work,
            effective_mass_ratio,
        )
    ),
)
"""What a method tells that tells the energy."""

WORK_UNBOUNDED = Condition(
    "unbounded",
    work_is_unbounded,
    frozenset(f"{whose}{kind}_work" for kind in WORKS for whose in ("", "part_")),
)
