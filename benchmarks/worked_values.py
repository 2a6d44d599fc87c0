"""Worked values, to which tests and benchmarks are held: the rows of a file of `core.assurance`.

Where they come from stands there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from core.assurance.worked.values import worked_values

GRAVITY = 9.8  # m s-2, of the mean velocities
TABLES = worked_values()


@dataclass(frozen=True)
class MeanVelocity:
    """The mean velocity of a part that starts at rest on the floor; SI units, degrees."""

    name: str
    source: str
    amplitude: float
    frequency: float
    beta: float
    gamma: float
    friction_static: float
    friction_kinetic: float
    restitution: float
    value: float

    @property
    def circular_frequency(self) -> float:
        """2 pi f [rad s-1]."""
        return 2.0 * math.pi * self.frequency

    @property
    def scaled(self) -> float:
        """The mean velocity in g/w, as methods of motion give it."""
        return self.value * self.circular_frequency / GRAVITY

    def groups(self) -> dict[str, float]:
        """Return the groups of `core.motion.groups.Groups`, but for those that are 0 here."""
        w = self.circular_frequency
        drive = self.amplitude * w * w / GRAVITY
        beta, gamma = math.radians(self.beta), math.radians(self.gamma)
        return {
            "drive_number_along": drive * math.cos(beta),
            "drive_number_normal": drive * math.sin(beta),
            "gravity_number_along": math.sin(gamma),
            "gravity_number_normal": math.cos(gamma),
            "friction_static": self.friction_static,
            "friction_kinetic": self.friction_kinetic,
            "restitution": self.restitution,
        }


@dataclass(frozen=True)
class ReferenceSpeed:
    """The mean velocity [mm s-1] at a throw number, for each of some restitutions; degrees."""

    name: str
    source: str
    frequency: float
    beta: float
    gamma: float
    friction: float
    throw_number: float
    restitutions: tuple[float, ...]
    value: float


@dataclass(frozen=True)
class Hop:
    """Length of a hop, as a phase, and landing speed in g/w."""

    source: str
    throw_number: float
    length: float
    landing_speed: float


@dataclass(frozen=True)
class LimitingFriction:
    """Limiting friction of a part on its corner, to half a unit of the last digit."""

    name: str
    source: str
    value: float
    half_unit: float


@dataclass(frozen=True)
class ClosedForm:
    """An output of a scene for given inputs; half a unit of its last digit where it has few."""

    source: str
    scene: str
    variant: str
    output: str
    given: dict[str, Any]
    value: float
    half_unit: float | None = None


MEAN_VELOCITIES = {row["name"]: MeanVelocity(**row) for row in TABLES["mean_velocities"]}
REFERENCE_SPEEDS = {row["name"]: ReferenceSpeed(**row) for row in TABLES["reference_speeds"]}
HOPS = {row["throw_number"]: Hop(**row) for row in TABLES["hops"]}
LIMITING_FRICTION = {row["name"]: LimitingFriction(**row) for row in TABLES["limiting_friction"]}
CLOSED_FORMS = [ClosedForm(**row) for row in TABLES["closed_forms"]]
DRIVE = next(row.value for row in CLOSED_FORMS if row.output == "vibration_acceleration")
"""P of 50 Hz and 0.4 mm [m s-2]."""
