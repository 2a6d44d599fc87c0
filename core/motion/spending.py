"""The energy that a motion takes: per second, per metre travelled, and per part (theory 13.15)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from vibrafeed.core.mechanics.arrays import Array, Mask, ratio
from vibrafeed.core.motion.result import Energy, Motion
from vibrafeed.core.scenes.scene import Condition, Equation

SOURCE = "theory 13.15"

KINDS = {
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

    power.__doc__ = f"Return {KINDS[kind]}, mean over the cycle, per mass [W kg-1]."
    return power


def _work(kind: str) -> Callable[..., Array]:
    """Return the function of the equation for one kind of work of a part, per mass and way.

    `kind` is a field of the record `Energy`, such as friction, impact or drive. The function takes
    the means of this work and of the motion, and gravity, and returns J kg-1 m-1.
    """

    def work(*, energy: Energy, motion: Motion, gravity: Array) -> Array:
        return _a_metre(getattr(energy, kind), motion) * gravity

    work.__doc__ = f"""Return {KINDS[kind]}, per mass and metre travelled [J kg-1 m-1].

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


RESULTS = (
    *(Equation(f"{kind}_power", _power(kind), SOURCE) for kind in KINDS),
    *(Equation(f"{kind}_work", _work(kind), SOURCE) for kind in KINDS),
    *(
        Equation(function.__name__, function, SOURCE)
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

UNBOUNDED = Condition(
    "unbounded",
    work_is_unbounded,
    frozenset(f"{whose}{kind}_work" for kind in KINDS for whose in ("", "part_")),
)
