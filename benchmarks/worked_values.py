"""Worked values, to which tests and benchmarks are held: rows of `vibrafeed.core.assurance`.

Each row has the keys of its table as attributes. Where the values come from stands there.
"""

from __future__ import annotations

import math
from types import SimpleNamespace

from vibrafeed.core.assurance.worked.values import worked_values

GRAVITY = 9.8  # m s-2, of the mean velocities
TABLES = worked_values()


class MeanVelocity(SimpleNamespace):
    """The mean velocity of a part that starts at rest on the floor; SI units, degrees."""

    @property
    def circular_frequency(self) -> float:
        """The circular frequency, 2 pi f [rad s-1]."""
        return 2.0 * math.pi * self.frequency

    @property
    def scaled(self) -> float:
        """The mean velocity in g/w, the unit of simulation methods."""
        return self.value * self.circular_frequency / GRAVITY

    def groups(self) -> dict[str, float]:
        """Return the groups of `vibrafeed.core.motion.groups.Groups`, without those that are 0."""
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


class Row(SimpleNamespace):
    """A worked value with its source."""


MEAN_VELOCITIES = {row["name"]: MeanVelocity(**row) for row in TABLES["mean_velocities"]}
REFERENCE_SPEEDS = {row["name"]: Row(**row) for row in TABLES["reference_speeds"]}
HOPS = {row["throw_number"]: Row(**row) for row in TABLES["hops"]}
LIMITING_FRICTION = {row["name"]: Row(**row) for row in TABLES["limiting_friction"]}
CLOSED_FORMS = [Row(**{"half_unit": None, **row}) for row in TABLES["closed_forms"]]
DRIVE = next(row.value for row in CLOSED_FORMS if row.output == "vibration_acceleration")
"""P of 50 Hz and 0.4 mm [m s-2]."""
