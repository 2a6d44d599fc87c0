"""The numbers that a motion depends on, and the way back to metres (theory 13.8, 13.10).

With length g/w^2 and velocity g/w only the drive's share of gravity, angles, friction, restitution
and the curvature are left. All functions take and return broadcastable float64 arrays.
"""

from functools import partial, reduce
from operator import mul
from typing import Any

import numpy as np

from vibrafeed.core.mechanics import floor
from vibrafeed.core.mechanics.arrays import Array, cosine, ratio, sine
from vibrafeed.core.mechanics.floor import throw
from vibrafeed.core.motion.method import Burst, Energy, Motion, where
from vibrafeed.core.scenes.scene import Constraint, Equation


def product(gives: str, *factors: str, says: str, source: str) -> Equation:
    """Return the equation of a product of quantities; `motion.velocity` is a field of one.

    `says` is what it gives, as one says after "Return".
    """
    paths = [factor.split(".") for factor in factors]
    needs = tuple(name for name, *_ in paths)
    return Equation(gives, partial(_product, paths), source, needs=needs, says=f"Return {says}.")


def _product(paths: list[list[str]], **quantities: Any) -> Array:
    return reduce(mul, (reduce(getattr, path, quantities[name]) for name, *path in paths))


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


def drive_number_in_plane(*, drive_number: Array, beta: Array) -> Array:
    """Return the drive number along the track, p cos(beta) [1]."""
    return drive_number * cosine(beta)


def leaning_gravity_number_normal(*, gamma: Array, delta: Array) -> Array:
    """Return the share of gravity onto the floor, cos(gamma) cos(delta) [1]."""
    return cosine(gamma) * cosine(delta)


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


CONVEYING_VELOCITY = product(
    "conveying_velocity", "motion.velocity", "velocity_scale", source="theory 13.8",
    says="the mean velocity along the track, over whole cycles of the motion [m s-1]",
)  # fmt: skip
CONVEYING_VELOCITY_SPREAD = product(
    "conveying_velocity_spread", "motion.spread", "velocity_scale", source="theory 13.8",
    says="the standard deviation of means of runs from several phases [m s-1]",
)  # fmt: skip
CONVEYING_VELOCITY_ERROR = product(
    "conveying_velocity_error", "motion.error", "velocity_scale", source="theory 13.8",
    says="the method's own estimate of the error of the conveying velocity [m s-1]",
)  # fmt: skip
WALL_FRICTION = product(
    "wall_friction", "friction_kinetic", source="theory 13.1",
    says="the floor's kinetic friction, for a wall of the same material [1]",
)  # fmt: skip
PLANAR_SCALES = (
    Equation("vibration_acceleration", floor.vibration_acceleration, "theory 0.2"),
    Equation("drive_number", drive_number, "theory 13.10"),
    Equation("drive_number_along", drive_number_along, "theory 13.2"),
    Equation("drive_number_normal", drive_number_normal, "theory 13.2"),
    Equation("gravity_number_along", gravity_number_along, "theory 13.2"),
    Equation("gravity_number_normal", gravity_number_normal, "theory 13.2"),
    product(
        "acceleration_scale", "gravity", source="theory 13.8",
        says="the acceleration of gravity, g [m s-2]",
    ),
    Equation("hold_down", hold_down, "theory 13.1"),
    Equation("hold_down_number", hold_down_number, "theory 13.1"),
    Equation("load_number", load_number, "theory 13.1"),
    Equation("throw_number", throw_number, "theory 13.10"),
    Equation("velocity_scale", velocity_scale, "theory 13.8"),
    Equation("length_scale", length_scale, "theory 13.8"),
)  # fmt: skip
DRIVEN = Constraint(
    ("frequency",),
    lambda least, largest: least >= 1e-9 and largest <= 1e12,
    "there is no period to take a mean over, or it is outside the range of double precision",
    "Give a frequency from 1e-9 Hz to 1e12 Hz",
)


# --- a drive that begins and ends (theory 13.9)


def coasting_time(*, burst: Burst, frequency: Array) -> Array:
    """Return the time from the end of a burst until the part rests [s]."""
    return burst.coasting / (2 * np.pi * frequency)


BURST_RESULTS = (
    product(
        "burst_displacement", "burst.travel", "length_scale", source="theory 13.9",
        says="the way of the part along the track in a burst, from rest to rest [m]",
    ),
    Equation("burst_coasting_time", coasting_time, "theory 13.9"),
)  # fmt: skip
WHOLE_PERIODS = Constraint(
    ("burst_periods",),
    lambda least, largest: float(least).is_integer() and float(largest).is_integer(),
    "a burst has whole periods, so that the track ends at rest",
    "Give whole numbers",
)


# --- the energy that a motion takes (theory 13.15)


ENERGY_SOURCE = "theory 13.15"

WORKS = {
    "friction": "energy that friction dissipates while contacts slip",
    "impact": "energy that impacts dissipate, with the friction in them",
    "drive": "the work of the track",
}
"""Fields of `Energy`, and what they are."""


def _power(kind: str, *, energy: Energy, gravity: Array, velocity_scale: Array) -> Array:
    return getattr(energy, kind) * (gravity * velocity_scale)


def _work(kind: str, *, energy: Energy, motion: Motion, gravity: Array) -> Array:
    return _a_metre(getattr(energy, kind), motion) * gravity


def _a_metre(energy: Array, motion: Motion) -> Array:
    without_travel = np.where(energy > 0, np.inf, np.nan)
    with np.errstate(over="ignore"):
        return ratio(energy, np.abs(motion.velocity), without_travel)


def effective_mass_ratio(*, energy: Energy, drive_number: Array) -> Array:
    """Return the mass that the drive feels of a part, over its own, 1 + 2 <u.b'>/p^2 [1].

    The first harmonic of the part's force on the track, in phase with the track's acceleration. 1
    for a part that sticks; NaN under a drive that is no plain sine.
    """
    return 1.0 + ratio(2.0 * energy.swing, np.square(drive_number), 0.0)


ENERGY_RESULTS = (
    *(
        Equation(
            f"{kind}_power", partial(_power, kind), ENERGY_SOURCE,
            says=f"Return {says}, mean over the cycle, per mass [W kg-1].",
        )
        for kind, says in WORKS.items()
    ),
    *(
        # Infinite (regime `unbounded`) where it is done without travel, NaN where neither is.
        Equation(
            f"{kind}_work", partial(_work, kind), ENERGY_SOURCE,
            says=f"Return {says}, per mass and metre travelled [J kg-1 m-1].",
        )
        for kind, says in WORKS.items()
    ),
    *(
        product(f"part_{of}", of, "mass", source=ENERGY_SOURCE, says=says)
        for of, says in {
            "friction_power": "the power of friction on a part while contacts slip, mean over the "
            "cycle [W]",
            "impact_power": "the power that impacts take from a part, mean over the cycle [W]",
            "drive_power": "the work of the track on a part, mean over the cycle [W]",
            "friction_work": "the work of friction on a part while contacts slip, per metre "
            "travelled [J m-1]",
            "impact_work": "the work of impacts on a part, per metre travelled [J m-1]",
            "drive_work": "the work of the track on a part, per metre travelled [J m-1]",
        }.items()
    ),
    Equation("effective_mass_ratio", effective_mass_ratio, ENERGY_SOURCE),
)  # fmt: skip
"""What a method tells that tells the energy."""

WORK_UNBOUNDED = where(
    "unbounded",
    "the drive works on a part that does not travel",
    lambda *, energy, motion: np.isinf(_a_metre(energy.drive, motion)),
    [f"{whose}{kind}_work" for kind in WORKS for whose in ("", "part_")],
)
